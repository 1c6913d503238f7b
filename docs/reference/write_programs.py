#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/reference/programs.md: the options of each program, as `--help` prints them.

usage: write_programs.py PROGRAMS           writes the page
       write_programs.py PROGRAMS --check   exits with 1 if the page is another one
"""
import pathlib
import re
import subprocess
import sys

NAMES = ["describe_robot", "plan_poses", "simulate_measurements", "join_measurements", "calibrate", "verify_calibration",
         "correct", "export_robot", "export_c", "iso9283", "compare", "paper_comparison", "make_board", "detect_board"]
HEAD = """# Reference: options and exit codes of the programs

This page is written by `docs/reference/write_programs.py` from what each program prints for `--help`.

| exit code | meaning |
|---|---|
| 0 | done; of `verify_calibration`: still valid |
| 1 | not done, or in part: unusable data, a target that is not met, an invalid calibration |
| 2 | wrong usage: an unknown option, a missing one, a value out of range |

Each failure is one line on standard error. It names the program, and the file, the line or the value.

All programs share a few rules:

- Values in square brackets are defaults. Options with `...` take several values.
- Progress is shown on standard error, if that is a terminal. `--quiet` hides it, and all that is printed for people.
- Colours are for terminals. They repeat what the words say, and `NO_COLOR` turns them off.
- `source <(PROGRAM --completion)` completes options in bash ([install](../how-to/install.md)).
"""


def as_written(page, name):
    """The section of a program that was not built: detect_board needs OpenCV."""
    found = re.search(rf"\n## {name}\n\n```text\n(.*?)\n```\n", page, re.DOTALL)
    return found.group(1) if found else ""


def options(programs, name):
    text = subprocess.run([programs / name, "--help"], check=True, stdout=subprocess.PIPE, text=True).stdout
    text = re.sub(r"\[\d{4}-\d\d-\d\d\]", "[TODAY]", text)  # defaults that differ from day to day, from place to place
    return re.sub(r"(--threads T .*?\[)\d+\]", r"\1PROCESSORS]", text, flags=re.DOTALL)


def main():
    programs = pathlib.Path(sys.argv[1]).resolve()
    page = pathlib.Path(__file__).resolve().parent / "programs.md"
    text = HEAD
    for name in NAMES:
        built = (programs / name).exists()
        lines = options(programs, name).strip() if built else as_written(page.read_text(), name)
        text += f"\n## {name}\n\n```text\n{lines}\n```\n"
    if sys.argv[2:] == ["--check"]:
        if page.read_text() != text:
            sys.exit(f"{page} is not what the programs print: docs/reference/write_programs.py PROGRAMS")
    else:
        page.write_text(text)


if __name__ == "__main__":
    main()
