#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whether each source file names its licence in one line, as https://spdx.dev/ids has it.

usage: spdx.py            names the files that lack it, and exits with 1 if there are any
       spdx.py --insert   writes it where it lacks

Text that the library gives away is left out: C, JavaScript and CSS in include/ are copied byte for byte into files of
users. Pages, data, pictures and files of other formats have no comments of their own, or none that readers should see.
"""
import pathlib
import subprocess
import sys

LICENCE = "SPDX-License-Identifier: BSD-3-Clause"
COMMENTS = {**dict.fromkeys([".hpp", ".ipp", ".cpp", ".inl"], "//"),
            **dict.fromkeys([".py", ".sh", ".cmake", ".yml", ".supp", "CMakeLists.txt", ".clang-format", ".clang-tidy",
                             ".gitignore", "dev", "run"], "#")}


def main():
    root = pathlib.Path(__file__).resolve().parent.parent
    files = subprocess.run(["git", "-C", str(root), "ls-files", "--cached", "--others", "--exclude-standard"],
                           check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
    missing = 0
    for name in files:
        path = root / name
        comment = COMMENTS.get(path.name, COMMENTS.get(path.suffix))
        if comment is None or not path.is_file() or "corpus" in path.parts:
            continue
        lines = path.read_text().split("\n")
        if any(LICENCE in line for line in lines[:2]):
            continue
        if sys.argv[1:] == ["--insert"]:
            lines.insert(1 if lines[0].startswith("#!") else 0, f"{comment} {LICENCE}")
            path.write_text("\n".join(lines))
            continue
        print(f"{name}:1: no line `{comment} {LICENCE}`")
        missing += 1
    if missing:
        sys.exit("repair with: tests/spdx.py --insert")


main()
