# SPDX-License-Identifier: BSD-3-Clause
"""Functions that are thin over methods."""
import os
from typing import Any, Optional, Union

from ._vernier import Measurements, Model
from .results import Verification


def verify(model: Model, measured: Measurements, **options: Any) -> Verification:
    """Whether a calibration still holds, from fresh poses; the options are those of `Model.verify`."""
    return model.verify(measured, **options)


def export_c(model: Model, path: Optional[Union[str, "os.PathLike[str]"]] = None, *, name: str = "arm") -> str:
    """A calibrated arm as a C header that predicts and corrects; written to a file where one is named."""
    source = model.export_c(name)
    if path is not None:
        with open(path, "w", encoding="utf-8", newline="") as file:
            file.write(source)
    return source
