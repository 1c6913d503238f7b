#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the gallery: what each program draws, from the data of examples/data and simulated ones.

usage: gallery.py PROGRAMS   writes docs/figures/gallery/*.svg; takes a minute or two
"""
import pathlib
import random
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT / "examples" / "data"
GALLERY = ROOT / "docs" / "figures" / "gallery"
LARGEST = 60_000  # bytes of a picture

COMMANDS = f"""
describe_robot --robot abb_irb120 --joints 10,20,30,0,45,0 --out arm
plan_poses --robot abb_irb120 --count 16 --candidates 70 --orientations --out plan.csv
calibrate --robot abb_irb120 --data {DATA}/measured.csv --test-every 5 --save model.json --out calibrated
correct --model model.json --targets {DATA}/targets.csv --out path.csv
correct --model model.json --targets {DATA}/targets.csv --all-branches --out branches.csv
iso9283 --data visits.csv --commanded poses.csv --out iso
compare --methods none,geometry,elm,pso:elm,geometry+elm --robot abb_irb120 --poses 50,100,200,400 --seeds 1,2,3,4,5 --evaluations 2000 --noise-mm 0.03 --out compared
paper_comparison --quick --test 30 --fresh 10 --out paper
"""

PICTURES = {
    "describe_robot_arm": "arm/arm.svg",
    "plan_poses_joints": "plan_joints.svg",
    "plan_poses_error": "plan_error.svg",
    "plan_poses_top": "plan_top.svg",
    "calibrate_stages": "calibrated/stages.svg",
    "calibrate_distribution": "calibrated/distribution.svg",
    "calibrate_poses": "calibrated/poses.svg",
    "calibrate_errors_along_joint": "calibrated/errors_along_joint_2.svg",
    "calibrate_transmission": "calibrated/transmission_2.svg",
    "calibrate_spectrum": "calibrated/spectrum_2.svg",
    "calibrate_joint_ranges": "calibrated/joint_ranges.svg",
    "correct_path": "path.svg",
    "correct_branches": "branches.svg",
    "iso9283_visits": "iso_p1.svg",
    "compare_learning": "compared/learning_abb_irb120.svg",
    "compare_errors": "compared/errors_abb_irb120.svg",
    "compare_ranks": "compared/ranks.svg",
    "paper_comparison_errors": "paper/errors_test.svg",
    "paper_comparison_distribution": "paper/distribution_test.svg",
    "paper_comparison_convergence": "paper/convergence.svg",
}


def smaller(svg):
    """The same picture in fewer bytes: no empty groups, short colours, and attributes that repeat as classes."""
    svg = re.sub(r"rgb\(\s*(\d+),\s*(\d+),\s*(\d+)\)", lambda m: "#%02x%02x%02x" % tuple(map(int, m.groups())), svg)
    while True:
        fewer = re.sub(r"<g [^>]*>\s*</g>\s*", "", svg)
        if fewer == svg:
            break
        svg = fewer
    groups = re.findall(r'<g ((?:[a-z-]+="[^"]*"\s*)+)>', svg)
    names = {}
    for attributes in dict.fromkeys(groups):
        pairs = re.findall(r'([a-z-]+)="([^"]*)"', attributes)
        if groups.count(attributes) > 3 and all(key not in ("transform", "id") for key, _ in pairs):
            names[attributes] = (f"g{len(names)}", "".join(f"{k}:{v};" for k, v in pairs))
    for attributes, (name, _) in names.items():
        svg = svg.replace(f"<g {attributes}>", f'<g class="{name}">')
    style = "".join(f".{name}{{{rules}}}" for name, rules in names.values())
    return re.sub(r"\s*\n\s*", "\n", svg).replace("<defs>", f"<style>{style}</style>\n<defs>", 1)


def write_visits(folder):
    """Thirty visits of five poses whose scatter is 15 um along each axis."""
    draw = random.Random(1)
    commanded = ["pose,x_mm,y_mm,z_mm"]
    visits = ["pose,cycle,x_mm,y_mm,z_mm"]
    for pose in range(1, 6):
        at = [400 + 40 * pose, 10 * pose, 500 - 30 * pose]
        commanded.append(",".join(map(str, [pose, *at])))
        for cycle in range(1, 31):
            visits.append(",".join(map(str, [pose, cycle, *(f"{x + 0.1 + draw.gauss(0, 0.015):.4f}" for x in at)])))
    (folder / "poses.csv").write_text("\n".join(commanded) + "\n")
    (folder / "visits.csv").write_text("\n".join(visits) + "\n")


def main():
    programs = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_visits(folder)
        for command in COMMANDS.strip().split("\n"):
            program, _, arguments = command.partition(" ")
            subprocess.run([programs / program, *arguments.split(" ")], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        GALLERY.mkdir(exist_ok=True)
        for picture, file in PICTURES.items():
            svg = smaller((folder / file).read_text())
            if len(svg) > LARGEST:
                sys.exit(f"{picture}: {len(svg)} bytes are too many")
            (GALLERY / f"{picture}.svg").write_text(svg)
    print(f"{len(PICTURES)} pictures in {GALLERY.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
