#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the commands of a page in a folder of their own, and compares with what the page shows.

usage: run_page.py PAGE PROGRAMS [--cpp PROGRAM] [--python PYTHON] [--model FILE] [--fill] [--refill]

A block ```sh is run by bash, where `examples/` is that of the project and the programs are found; in place of a block
```cpp its compiled PROGRAM is run, and a block ```python by PYTHON. A block ```text that follows shows what it prints, to
both streams: words are equal,
numbers within 2 %, times are not compared, and a line `...` stands for any lines. A block without output shown need only
succeed. --fill writes the output into empty blocks, --refill into all blocks without `...`.

A comment `<!-- files: NAME=PATH .. -->` of a page names the files that its commands take for granted. PATH is in the
project; `model` is the --model, which the page writes itself where it has no such comment.
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"```(\w+)\n(.*?)```\n", re.S)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
TIME = re.compile(r"\d+(?:\.\d+)? (?:us|ms|s|min)\b|\d{4}-\d\d-\d\d")
TOLERANCE = 0.02


def agrees(shown, seen):
    """Whether a line that was printed is the line of the page."""
    shown, seen = (" ".join(TIME.sub("TIME", line).split()) for line in (shown, seen))
    if NUMBER.sub("N", shown) != NUMBER.sub("N", seen):
        return False
    pairs = zip(map(float, NUMBER.findall(shown)), map(float, NUMBER.findall(seen)))
    return all(abs(a - b) <= TOLERANCE * max(abs(a), abs(b)) for a, b in pairs)


def difference(shown, seen):
    """The first line of the page that was not printed, with the one in its place; None if all are there."""
    at = 0
    skipping = False
    for line in shown:
        if line == "...":
            skipping = True
            continue
        begin = at
        while skipping and at < len(seen) and not agrees(line, seen[at]):
            at += 1
        if at >= len(seen) or not agrees(line, seen[at]):
            return f"the page has    {line}\nit was printed  {seen[begin] if begin < len(seen) else '(nothing)'}"
        at += 1
        skipping = False
    return None if skipping or at == len(seen) else f"the page lacks  {seen[at]}"


def lines(text):
    return [line.rstrip() for line in text.strip("\n").split("\n")]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--cpp", type=pathlib.Path)
    parser.add_argument("--python", type=pathlib.Path)
    parser.add_argument("--model", type=pathlib.Path)
    parser.add_argument("--fill", action="store_true")
    parser.add_argument("--refill", action="store_true")
    options = parser.parse_args()
    page, programs = options.page.resolve(), options.programs.resolve()
    project = pathlib.Path(__file__).resolve().parents[2]
    text = page.read_text()
    blocks = list(BLOCK.finditer(text))
    languages = {"sh"} | ({"cpp"} if options.cpp else set()) | ({"python"} if options.python else set())
    commands = [block for block in blocks if block[1] in languages]
    if not commands:
        sys.exit(f"{page}: no command to run")
    filled = []
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "examples").symlink_to(project / "examples")
        files = re.search(r"<!-- files: (.*?) -->", text)
        for name, _, path in (item.partition("=") for item in (files[1].split() if files else [])):
            shutil.copy(options.model if path == "model" else project / path, pathlib.Path(folder) / name)
        for k, block in enumerate(blocks):
            if block[1] not in languages:
                continue
            command = block[2] if block[1] == "sh" else str(options.cpp.resolve()) if options.cpp else ""
            if block[1] == "python":
                (pathlib.Path(folder) / "page.py").write_text(block[2])
                command = f"{options.python} page.py"
            line = text.count("\n", 0, block.start()) + 1
            done = subprocess.run(["bash", "-ec", f'PATH="{programs}:$PATH"\n{command}'], cwd=folder, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
            if done.returncode:
                sys.exit(f"{page}:{line}: exit code {done.returncode}\n{done.stdout}")
            answer = blocks[k + 1] if k + 1 < len(blocks) and blocks[k + 1][1] == "text" else None
            if answer is None:
                continue
            if not answer[2].strip() or (options.refill and "..." not in lines(answer[2])):
                filled.append((answer.span(2), done.stdout))
                continue
            wrong = difference(lines(answer[2]), lines(done.stdout))
            if wrong:
                sys.exit(f"{page}:{line}: other output\n{wrong}\n--- all of it\n{done.stdout}")
        model = pathlib.Path(folder) / "model.json"
        if options.model and not files and model.exists():
            shutil.copy(model, options.model)
    if filled and not (options.fill or options.refill):
        sys.exit(f"{page}: a block of output is empty; see --fill")
    for (begin, end), output in reversed(filled):
        text = text[:begin] + output + text[end:]
    if filled:
        page.write_text(text)
    print(f"{page.name}: {len(commands)} blocks of commands")


if __name__ == "__main__":
    main()
