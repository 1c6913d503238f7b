#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whether pages hold together.

usage: pages.py            links lead to files and headings; pictures are shown and small; no run of 12 words stands on two pages
       pages.py PROGRAMS   options on pages are those of the programs
"""
import functools
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
RUN = 12
COMMANDS = re.compile(r"^(?:\w+> |\$ )?(?:\./|build/\S+/)?([a-z_0-9]+) (.*--\w.*)$")


def pages():
    return sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "benchmarks").glob("*.md")])


def without_code(text):
    text = re.sub(r"```.*?```", lambda m: "\n" * m[0].count("\n"), text, flags=re.S)
    text = re.sub(r"^    .*$", "", text, flags=re.M)
    return re.sub(r"`[^`\n]*`", "`code`", text)


@functools.cache
def anchors(page):
    """What `page.md#...` may end with: headings as GitHub names them, and labels of our own."""
    found = set()
    for line in without_code(page.read_text()).split("\n"):
        heading = re.match(r"#+ (.*?)(?: \{#([\w-]+)\})?$", line)
        if heading:
            plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading[1]).lower()
            found.add(re.sub(r"[^\w\- ]", "", plain).replace(" ", "-"))
            found.add(heading[2])
    return found


def wrong_links():
    out = []
    for page in pages():
        for number, line in enumerate(without_code(page.read_text()).split("\n"), 1):
            for target in re.findall(r"\]\(([^)\s]+)\)", line):
                if re.match(r"[a-z]+:", target):
                    continue
                file, _, anchor = target.partition("#")
                there = (page.parent / file).resolve() if file else page
                if not there.exists():
                    out.append(f"{page.relative_to(ROOT)}:{number}: there is no {target}")
                elif anchor and anchor not in anchors(there):
                    out.append(f"{page.relative_to(ROOT)}:{number}: {file or page.name} has no heading #{anchor}")
    return out


def lost_pages():
    """Pages of docs/ to which no page leads."""
    linked = set()
    for page in pages():
        for target in re.findall(r"\]\(([^)\s#]+)[^)]*\)", page.read_text()):
            linked.add((page.parent / target).resolve())
    return [f"{p.relative_to(ROOT)}: no page leads here" for p in (ROOT / "docs").rglob("*.md")
            if p not in linked and p.parent.name != "algorithms"]


def wrong_pictures():
    """Pictures that no page shows, and those of the gallery that are too large."""
    text = "".join(page.read_text() for page in pages())
    found = sorted((ROOT / "docs" / "figures").rglob("*.svg"))
    out = [f"{p.relative_to(ROOT)}: no page shows it" for p in found if p.name not in text]
    return out + [f"{p.relative_to(ROOT)}: more than 60 kB" for p in found
                  if p.parent.name == "gallery" and p.stat().st_size > 60_000]


def repeated_runs():
    """Runs of words that stand on two pages: facts have one place. Developers' pages may define what others use."""
    where, out = {}, []
    for page in pages():
        if page.name in ("CHANGELOG.md", "RESULTS.md") or "algorithms" in page.parts:
            continue
        words = re.findall(r"[\w.%]+", re.sub(r"\]\([^)]*\)", "]", without_code(page.read_text())))
        last = -RUN
        for k in range(len(words) - RUN + 1):
            run = " ".join(words[k:k + RUN]).lower()
            if sum(any(c.isalpha() for c in w) for w in words[k:k + RUN]) < RUN * 2 // 3:
                continue  # a row of figures
            if where.setdefault(run, page) != page and k >= last + RUN:
                out.append(f"{page.relative_to(ROOT)} and {where[run].relative_to(ROOT)}: {run}")
                last = k
    return out


def unknown_options(programs):
    help_of, out = {}, []
    for page in pages():
        if page.name in ("CHANGELOG.md", "programs.md"):
            continue
        text = re.sub(r"\\\n\s*", "", page.read_text())
        lines = [line.strip() for line in text.split("\n") if line.startswith("    ")]
        lines += [line.strip() for block in re.findall(r"```sh\n(.*?)```", text, re.S) for line in block.split("\n")]
        lines += re.findall(r"`([^`\n]*)`", text)
        for line in lines:
            command = COMMANDS.match(line)
            if not command or not (programs / command[1]).is_file():
                continue
            name = command[1]
            if name not in help_of:
                help_of[name] = subprocess.run([programs / name, "--help"], check=True, stdout=subprocess.PIPE,
                                               text=True).stdout
            for option in re.findall(r"(?<!\S)(--[a-z][\w-]*)", re.sub(r"#.*|\|.*", "", command[2])):
                if not re.search(re.escape(option) + r"(?![\w-])", help_of[name]):
                    out.append(f"{page.relative_to(ROOT)}: {name} has no option {option}")
    if not help_of:
        out.append("no command was found")
    return out


def main():
    wrong = unknown_options(pathlib.Path(sys.argv[1])) if len(sys.argv) > 1 else wrong_links() + lost_pages() + wrong_pictures() + repeated_runs()
    print("\n".join(wrong), end="\n" if wrong else "")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
