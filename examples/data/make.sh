#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Makes the data of this folder: 300 poses of a simulated ABB IRB 120 whose links, gears, encoders and joints err, and 30 more.
# usage: make.sh FOLDER_OF_PROGRAMS   (for example build/release/examples)
set -e
programs=$(cd "$1" && pwd)
cd "$(dirname "$0")"
"$programs"/plan_poses --robot abb_irb120 --count 285 --orientations --candidates 2000 --tracker 2500,0,500 \
  --box 100,600,-500,500,100,800 --out poses.csv
"$programs"/simulate_measurements --robot abb_irb120 --poses poses.csv --out measured.csv
"$programs"/plan_poses --robot abb_irb120 --count 26 --orientations --candidates 500 --seed 2 --tracker 2500,0,500 \
  --box 100,600,-500,500,100,800 --out poses.csv
"$programs"/simulate_measurements --robot abb_irb120 --poses poses.csv --out fresh.csv
rm poses.csv poses_*.svg
