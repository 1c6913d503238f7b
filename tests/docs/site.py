#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whether links of the site lead somewhere: files, and places in them.

usage: site.py FOLDER    of HTML files
"""
import functools
import pathlib
import re
import sys
import urllib.parse


@functools.cache
def places(file):
    return set(re.findall(r'\b(?:id|name)="([^"]+)"', file.read_text(encoding="utf-8", errors="replace")))


def main():
    folder = pathlib.Path(sys.argv[1])
    pages = sorted(folder.glob("*.html"))
    wrong, links = [], 0
    for page in pages:
        for target in set(re.findall(r'\b(?:href|src|data)="([^"]+)"', page.read_text(encoding="utf-8", errors="replace"))):
            if re.match(r"[a-z]+:|//", target) or target == "#nested-classes":  # Doxygen's own mistake
                continue
            links += 1
            name, _, place = urllib.parse.unquote(target).partition("#")
            there = folder / name if name else page
            if not there.exists():
                wrong.append(f"{page.name}: there is no {target}")
            elif place and there.suffix == ".html" and place not in places(there):
                wrong.append(f"{page.name}: no place {target}")
    print("\n".join(wrong[:50]))
    print(f"{len(pages)} pages, {links} links, {len(wrong)} of them wrong")
    sys.exit(bool(wrong) or not pages)


if __name__ == "__main__":
    main()
