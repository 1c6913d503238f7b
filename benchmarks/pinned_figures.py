#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Pins the figures of the programs before a change of the code, and compares them after it.

usage: pinned_figures.py record PROGRAMS FOLDER      PROGRAMS: where calibrate, correct, ... were built
       pinned_figures.py compare BEFORE AFTER [RELATIVE]

`record` calibrates the measured arms in $VERNIER_DATA_DIR and a simulated one, corrects 1,000 targets and a program of
each language, repeats the paper's experiment (short), and writes what it finds to FOLDER: numbers as JSON and CSV, the
corrected programs, and the files of models. `compare` prints the largest relative difference of each file, and exits
with 1 where one exceeds RELATIVE (default 0: the same bits). Words must be equal; times are left out. Where RELATIVE
is given, numbers below 1e-9 count as zero, and digests of models and their packed covariance are left out.
"""
import csv
import json
import math
import os
import pathlib
import re
import subprocess
import sys

ARMS = {"ur10": "ur10_random_poses.csv", "ur5": "ur5_grid.csv", "barrett_wam": "wam_grid.csv"}
PROGRAMS = {"rapid": "mod", "krl": "src", "urscript": "script", "fanuc": "ls"}
TIMES = re.compile(r"seconds|_us$|_ms$|_s$|date|sha256")
PACKED = re.compile(r"[0-9a-f]{24,}|[A-Za-z0-9+/=]{100,}")


def run(programs, name, *arguments):
    command = [str(programs / name), *map(str, arguments)]
    print("+", " ".join(command), flush=True)
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        print(done.stdout[-2000:])
    return done.returncode


def record(programs, out):
    programs, out = pathlib.Path(programs), pathlib.Path(out)
    root = pathlib.Path(__file__).resolve().parent.parent
    out.mkdir(parents=True, exist_ok=True)
    figures = out / "figures"
    run(programs, "paper_comparison", "--quick", "--out", figures, "--json", out / "paper.json", "--write-poses",
        out / "simulated.csv")
    run(programs, "calibrate", "--robot", "abb_irb120", "--data", out / "simulated.csv", "--test-every", 5, "--date",
        "2000-01-01", "--out", figures, "--json", out / "irb120.json", "--save", out / "irb120.model.json")
    folder = os.environ.get("VERNIER_DATA_DIR", "")
    for robot, file in ARMS.items():
        if not folder or not pathlib.Path(folder, file).exists():
            print(f"{file} is not in VERNIER_DATA_DIR: left out")
            continue
        data = pathlib.Path(folder, file)
        run(programs, "calibrate", "--robot", robot, "--data", data, "--test-every", 5, "--date", "2000-01-01", "--out",
            figures, "--json", out / f"{robot}.json", "--save", out / f"{robot}.model.json")
        if robot == "ur10":
            joints = [row[:6] for row in csv.reader(open(data))][:1001]
            with open(out / "targets.csv", "w") as targets:
                targets.write("\n".join(",".join(row) for row in joints) + "\n")
            run(programs, "correct", "--model", out / "ur10.model.json", "--targets", out / "targets.csv", "--out",
                out / "commands.csv")
    for language, ending in PROGRAMS.items():
        for sample in sorted((root / "tests/fuzz/corpus" / language).glob("valid*." + ending)):
            noflip = ["--noflip", "negative"] if language == "fanuc" else []
            run(programs, "correct", "--model", out / "irb120.model.json", "--program", sample, "--out",
                out / sample.name, "--date", "2000-01-01", "--controller", "nominal", "--tool", "0,0,100,0,0,0",
                "--workobject", "0,0,0,0,0,0", "--allow-uncorrected", *noflip)


def numbers_of(path):
    """Every value of a file with its place."""
    text = path.read_text(encoding="latin-1")
    if path.suffix == ".json":
        found = []

        def visit(place, node):
            if isinstance(node, dict):
                for key, value in node.items():
                    if not TIMES.search(key):
                        visit(f"{place}.{key}", value)
            elif isinstance(node, list):
                for k, value in enumerate(node):
                    visit(f"{place}[{k}]", value)
            else:
                found.append((place, node))

        visit("", json.loads(text))
        return found
    return [(f"word {k}", word) for k, word in enumerate(re.split(r"[\s,;\[\]{}():]+", text))]


def difference(a, b, zero):
    """Relative difference of two values, infinite where words differ; below `zero` values are equal."""
    try:
        x, y = float(a), float(b)
    except (TypeError, ValueError):
        return 0 if a == b else math.inf
    if x == y or (math.isnan(x) and math.isnan(y)) or max(abs(x), abs(y)) < zero:
        return 0
    return abs(x - y) / max(abs(x), abs(y))


def compare(before, after, relative=0.0):
    before, after = pathlib.Path(before), pathlib.Path(after)
    failed = False
    for file in sorted(f for f in before.iterdir() if f.is_file()):
        if not (after / file.name).exists():
            print(f"{file.name}: is missing")
            failed = True
            continue
        old, new = numbers_of(file), numbers_of(after / file.name)
        worst, place = 0, ""
        if len(old) != len(new):
            worst, place = math.inf, f"{len(old)} values, {len(new)} after"
        zero = 1e-9 if relative > 0 else 0
        for (at, a), (_, b) in zip(old, new):
            if relative > 0 and isinstance(a, str) and PACKED.search(a):
                continue
            if difference(a, b, zero) > worst:
                worst, place = difference(a, b, zero), f"{at}: {str(a)[:40]} -> {str(b)[:40]}"
        failed |= worst > relative
        print(f"{file.name}: {len(old)} values, largest difference {worst:.2g}{'  ' + place if place else ''}")
    return failed


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "record":
        record(*sys.argv[2:])
    elif len(sys.argv) in (4, 5) and sys.argv[1] == "compare":
        sys.exit(compare(sys.argv[2], sys.argv[3], *map(float, sys.argv[4:])))
    else:
        sys.exit(__doc__)
