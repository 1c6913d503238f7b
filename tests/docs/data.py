#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whether examples/data has what the program measures at these joints.

usage: data.py PROGRAMS
"""
import csv
import pathlib
import subprocess
import sys
import tempfile

DATA = pathlib.Path(__file__).resolve().parents[2] / "examples" / "data"
NEAR = 1e-6  # of numbers of up to thousands [mm], which other compilers round otherwise


def rows(path):
    with open(path, newline="") as file:
        return list(csv.reader(file))


def main():
    with tempfile.TemporaryDirectory() as folder:
        for name in ("measured.csv", "fresh.csv"):
            again = pathlib.Path(folder) / name
            subprocess.run([pathlib.Path(sys.argv[1]) / "simulate_measurements", "--robot", "abb_irb120", "--poses", DATA / name,
                            "--out", again], check=True, stdout=subprocess.DEVNULL)
            old, new = rows(DATA / name), rows(again)
            if old[0] != new[0] or len(old) != len(new) or len(old) < 20:
                sys.exit(f"{name}: other columns or rows; make it again by examples/data/make.sh")
            for number, (a, b) in enumerate(zip(old[1:], new[1:]), 2):
                if any(abs(float(x) - float(y)) > NEAR for x, y in zip(a, b)):
                    sys.exit(f"{name}, line {number}: other numbers; make it again by examples/data/make.sh")


if __name__ == "__main__":
    main()
