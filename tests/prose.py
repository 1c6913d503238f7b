#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whether pages and comments read easily: lengths of sentences, and habits that a pattern finds.

usage: prose.py                 all pages and headers of the project
       prose.py FILE.md...      these pages
       prose.py --headers       the comments of all headers

Pages have at most 17 words a sentence on average and at most 5 % of sentences above 30; comments of headers 20 and 8 %.
Code blocks, headings, indented lines and table cells of up to 12 words do not count, and a list of code is one word.
Ceres' tutorial has 15.4 words and 3 %, GTSAM's README 13.7 and 2 %.
"""
import pathlib
import re
import sys

LONG, CELL = 30, 12
PAGES, HEADERS = (17, 5), (20, 8)  # words on average, % of sentences above LONG
NOT_PAGES = {"CHANGELOG.md", "RESULTS.md"}  # a list of changes, and what programs print
DEVELOPERS = {"CONTRIBUTING.md", "architecture.md", "algorithms", "benchmarks"}  # pages whose habits are not looked at

# What is wrong with the beginning of a sentence, or with a phrase, and the better way.
HABITS = [
    (r"^(?:What|Left out|Held) (?:is|are) ", "begin with the subject"),
    (r"^What ", "name the thing instead of a clause with `what`"),
    (r"^In bold ", "begin with the subject"),
    (r"^Likewise\b|^As above\b|^The same, ", "each sentence stands alone"),
    (r"\bwhat (?:is left|the model lacks|learners find|the poses cannot)\b", "name the residual or the parameters"),
    (r"\b(?:believed|leans on|told apart|takes the drift off|errs by)\b", "the field's word: constrained, confounded, error"),
    (r"\bin a case where\b|\bin case of\b", "`if`"),
    (r"\bp [=<>] ?\d[\d.e-]*[^|]*\bp [=<>] ?\d", "p-values belong in a table of docs/comparison.md"),
]


def prose_of_page(text):
    """A page as plain text: one paragraph, list item or long table cell per block."""
    text = re.sub(r"```.*?```", "", text, flags=re.S)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.S)
    kept = []
    for line in text.split("\n"):
        line = re.sub(r"`[^`]*`(?:, `[^`]*`)+", "`list`", line)
        if line.startswith("|"):
            kept += ["", *(cell + "." for cell in line.strip("|").split("|") if len(cell.split()) > CELL), ""]
        skip = line.startswith(("    ", "|", "#", "!")) or not line.strip()
        kept.append("" if skip else line)
    return "\n".join(kept)


def prose_of_header(text):
    """The comments that Doxygen shows: blocks of ///, one paragraph per run and per tag."""
    kept, inside = [], False
    for line in text.split("\n"):
        comment = re.match(r"\s*///(?!<) ?(.*)", line)
        trailing = re.search(r"///< (.*)", line)
        if trailing:
            kept += ["", trailing[1], ""]
            inside = False
        elif comment:
            body = re.sub(r"^@(?:param|tparam) +\S+ *", "\n", comment[1])
            body = re.sub(r"^@(?:return|throws +\S+|pre|post|note|brief|complexity) *", "\n", body)
            kept.append("" if body.startswith(("@", "    ")) else body)
            inside = True
        elif inside:
            kept.append("")
            inside = False
    return "\n".join(kept)


def sentences(text):
    text = re.sub(r"`[^`]*`", "CODE", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    out = []
    for paragraph in re.split(r"\n\s*\n|\n(?=\s*(?:[-*]|\d+\.) )", text):
        paragraph = re.sub(r"\s+", " ", paragraph).strip(" -*")
        out += [s for s in re.split(r"(?<=[.!?])\s+(?=[A-Z*\"(])", paragraph) if len(s.split()) > 3]
    return out


def measure(found):
    """Words a sentence, and % of sentences above LONG."""
    lengths = [len(s.split()) for s in found] or [0]
    return sum(lengths) / len(lengths), 100 * sum(n > LONG for n in lengths) / len(lengths)


def report(path, root, limits):
    """Prints what is wrong with a page; whether something is."""
    found = sentences(prose_of_page(path.read_text(encoding="utf-8")))
    name = path.resolve().relative_to(root) if path.resolve().is_relative_to(root) else path
    mean, share = measure(found)
    read = not DEVELOPERS.intersection(path.parts)
    habits = [(s, why) for s in found for pattern, why in HABITS if read and re.search(pattern, s)]
    bad = mean > limits[0] or share > limits[1]
    if bad:
        print(f"{name}: {len(found)} sentences, {mean:.1f} words each, {share:.0f} % above {LONG}; at most {limits[0]} and "
              f"{limits[1]} %")
        for s in sorted(found, key=lambda s: -len(s.split()))[:3]:
            print(f"    {len(s.split())} words: {s[:160]}")
    for s, why in habits:
        print(f"{name}: {why}: {s[:120]}")
    return bad or bool(habits)


def pages(root):
    found = [*root.glob("*.md"), *(root / "docs").rglob("*.md"), *(root / "benchmarks").glob("*.md")]
    return sorted(p for p in found if p.name not in NOT_PAGES)


def headers(root):
    return sorted((root / "include").rglob("*.hpp"))


def main():
    root = pathlib.Path(__file__).resolve().parent.parent
    arguments = sys.argv[1:]
    failed = False
    chosen = [pathlib.Path(a) for a in arguments if a != "--headers"] or pages(root)
    if "--headers" not in arguments:
        total = []
        for page in chosen:
            total += sentences(prose_of_page(page.read_text(encoding="utf-8")))
            failed |= report(page, root, PAGES)
        mean, share = measure(total)
        print(f"{len(chosen)} pages: {len(total)} sentences, {mean:.1f} words each, {share:.1f} % above {LONG}")
    if not arguments or "--headers" in arguments:
        of_file = {h: sentences(prose_of_header(h.read_text(encoding="utf-8"))) for h in headers(root)}
        total = [s for found in of_file.values() for s in found]
        mean, share = measure(total)
        print(f"{len(of_file)} headers: {len(total)} sentences, {mean:.1f} words each, {share:.1f} % above {LONG}")
        if "--headers" in arguments:
            worst = sorted(of_file, key=lambda h: -sum(len(s.split()) > LONG for s in of_file[h]))[:20]
            for h in worst:
                mean, share = measure(of_file[h])
                print(f"    {h.relative_to(root)}: {len(of_file[h])} sentences, {mean:.1f} words, {share:.0f} % above {LONG}")
        failed |= mean > HEADERS[0] or share > HEADERS[1]
    sys.exit(failed)


if __name__ == "__main__":
    main()
