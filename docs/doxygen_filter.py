#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prepares a page for Doxygen: labels of headings, which GitHub makes by itself and would show if a page had them.

usage: doxygen_filter.py PAGE    prints the page

A page gets the label page_<folder>_<name>, a heading <that>-<words of the heading>, and links lead to these. Labels that a
page has already stay. Pictures go by their names, and a link to a file that is no page becomes its text.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LABEL = re.compile(r" \{#([\w-]+)\}$")


def label_of(page):
    return "page_" + re.sub(r"\W", "_", str(page.relative_to(ROOT).with_suffix("")))


def slug(heading):
    plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
    return re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")


def labels(page):
    """GitHub's name of each heading of a page, in order, and Doxygen's. Equal names are numbered."""
    out, inside, first = {}, False, True
    for line in page.read_text(encoding="utf-8").split("\n"):
        inside ^= line.startswith("```")
        heading = None if inside else re.match(r"#+ (.*)$", line)
        if not heading:
            continue
        own = LABEL.search(heading[1])
        name = plain = slug(LABEL.sub("", heading[1]))
        count = 0
        while name in out:
            count += 1
            name = f"{plain}-{count}"
        out[name] = own[1] if own else label_of(page) if first else f"{label_of(page)}-{name}"
        first = False
    return out


def main():
    page = pathlib.Path(sys.argv[1]).resolve()
    inside, text = False, []
    own = iter(labels(page).values())

    def link(match):
        picture, words, target = match.groups()
        file, _, anchor = target.partition("#")
        there = (page.parent / file).resolve() if file else page
        if picture:
            return f"![{words}]({there.name})"
        if there.suffix != ".md":
            return words
        return f"[{words}](@ref {labels(there).get(anchor, anchor)})" if anchor else match[0]

    for line in page.read_text(encoding="utf-8").split("\n"):
        inside ^= line.startswith("```")
        heading = None if inside else re.match(r"#+ (.*)$", line)
        if heading:
            label = next(own)
            line += "" if LABEL.search(line) else f" {{#{label}}}"
        elif not inside and not line.startswith("    "):
            line = re.sub(r"(!?)\[([^\]]*)\]\(([^)\s:]+)\)", link, line)
        text.append(line)
    sys.stdout.write("\n".join(text))


if __name__ == "__main__":
    main()
