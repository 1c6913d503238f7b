# SPDX-License-Identifier: BSD-3-Clause
"""Exceptions of this package."""
import re
from typing import Optional


class DataError(ValueError):
    """A file whose content is invalid; the message names the file and the place in it."""

    @property
    def file(self) -> Optional[str]:
        """The file, as far as the message names one."""
        match = re.match(r"(.+?)(?:, line \d+|: )", str(self))
        return match[1] if match else None

    @property
    def line(self) -> Optional[int]:
        """The line in it, from 1; None where the message names none."""
        match = re.search(r", line (\d+)", str(self))
        return int(match[1]) if match else None


class CalibrationFailure(RuntimeError):
    """Data that do not support a calibration; the message names the reason and the remedy."""
