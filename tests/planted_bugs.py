#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Asks whether the tests still find bugs after a change: plants single-line bugs and counts those that tests kill.

usage: planted_bugs.py draw BEFORE AFTER [--count 30] [--seed 1] > bugs.json
       planted_bugs.py run bugs.json [--build build/dev] [--out result.json]
       planted_bugs.py compare before.json after.json

`draw` takes statements of include/vernier/**.ipp that stand once in both commits, in the file of that path or else of
that name, and plants a bug in each: every kind of bug as often as the others. Headers are left out, since each bug in
one would recompile the tests. More bugs are drawn than asked for, because some do not compile; the order is kept.

`run` works in the Git tree of the current folder, whose build is configured. It plants one bug at a time, builds the
tests of the file's folder, runs them and restores the file, until COUNT bugs have compiled. Tests that fail, abort or
hang kill the bug. It is run in a tree of each commit.

`compare` prints both results, bug by bug, and exits with 1 if fewer bugs are killed after. What cannot be done exits
with 2.
"""
import argparse
import json
import pathlib
import random
import re
import resource
import signal
import subprocess
import sys
import time

SPARE = 3  # bugs drawn for each bug asked for
STATEMENT = re.compile(r"\s+(?:.*;|(?:\} else )?(?:if|for|while) \(.*)$")
LEFT_OUT = re.compile(r"[\"'#]|//|\b(throw|template|using|static_assert|assert|message|friend|operator|VERNIER_\w+)\b")

# What is looked for and what stands there instead, in code that clang-format has laid out.
SWAPPED = [(" + ", " - "), (" += ", " -= "), (" *= ", " /= "), (" < ", " <= "), (" > ", " >= "), (" == ", " != "),
           (" && ", " || "), ("std::sin(", "std::cos("), ("std::max", "std::min"), ("true", "false"),
           (".front()", ".back()"), ("continue;", "break;"), (" * ", " / ")]
DROPPED = ["std::abs", "std::sqrt", ".transpose()"]
KINDS = {f"{one.strip()} to {other.strip()}": (r"(?<=[\w)\]])" * (one[0] == " ") + re.escape(one), other)
         for pair in SWAPPED for one, other in (pair, pair[::-1])}
KINDS |= {f"{name} dropped": (re.escape(name), "") for name in DROPPED}
KINDS |= {
    "sign dropped": (r"([(=,?:] |return |[(\[])-(?=[\w(])", r"\1"),
    "norm squared": (r"\.norm\(\)", ".squaredNorm()"),
    "number doubled": (r"(?<![\w.])(\d+\.\d*(?:e-?\d+)?|\d+e-?\d+)(?![\w.])", r"(2 * \1)"),
    "integer plus 1": (r"(?<![\w.<])(\d+)(?![\w.>])", lambda match: str(int(match[1]) + 1)),
    "index shifted": (r"^(?!\s+(?:const )?\w+ \w+\[)(.*\w)\[(\w+)\]", r"\1[\2 + 1]"),
    "returns nothing": (r"(?<=\breturn )[^{};]+;$", "{};"),
    "condition negated": (r"(?<=\bif )\((?!.* = )(.*)\)(?=( \{| \w+;)?$)", r"(!(\1))"),
    "assignment left out": (r"^(\s+)[\w.()\[\]>-]+ [-+*/]?= .*;$", r"\1{}"),
}


def fail(text):
    print(f"planted_bugs.py: {text}", file=sys.stderr)
    sys.exit(2)


def git(*arguments):
    done = subprocess.run(["git", *arguments], capture_output=True, text=True)
    if done.returncode != 0:
        fail(f"git {' '.join(arguments)}: {done.stderr.strip()}")
    return done.stdout


def statements(commit):
    """Statements by path: what stands once in an .ipp file of a folder with tests."""
    files = git("ls-tree", "-r", "--name-only", commit, "include/vernier", "tests").split()
    tested = {file.split("/")[1] for file in files if re.fullmatch(r"tests/\w+/\w+_test\.cpp", file)}
    lines = {file: git("show", f"{commit}:{file}").splitlines()
             for file in files if file.endswith(".ipp") and file.split("/")[2] in tested}
    return {file: [line for line in of_file if STATEMENT.match(line) and not LEFT_OUT.search(line)
                   and of_file.count(line) == 1] for file, of_file in lines.items()}


def bugs_of(line):
    """All bugs of a line: their kind and the line with the bug."""
    for kind, (pattern, replacement) in KINDS.items():
        for match in re.finditer(pattern, line):
            instead = replacement(match) if callable(replacement) else match.expand(replacement)
            yield kind, line[:match.start()] + instead + line[match.end():]


def draw(options):
    before, after = statements(options.before), statements(options.after)
    of_kind = {kind: [] for kind in KINDS}
    for path, lines in sorted(after.items()):
        found = [path] if path in before else [old for old in before if old.split("/")[-1] == path.split("/")[-1]]
        if len(found) != 1:
            continue
        for line in [line for line in lines if line in before[found[0]]]:
            for kind, bug in bugs_of(line):
                of_kind[kind].append({"files": [path, found[0]], "kind": kind, "line": line, "bug": bug})
    rng = random.Random(options.seed)
    kinds, bugs = [], []
    while len(bugs) < SPARE * options.count and any(of_kind.values()):
        kinds = kinds or rng.sample(sorted(of_kind), len(of_kind))  # each kind once, in another order each time
        if drawn := of_kind[kinds.pop()]:
            bug = drawn.pop(rng.randrange(len(drawn)))
            if bug["line"] not in [other["line"] for other in bugs]:
                bugs.append(bug)
    if len(bugs) < options.count:
        fail(f"{options.count} bugs were asked for, {len(bugs)} could be drawn")
    commits = [git("rev-parse", commit).strip() for commit in (options.before, options.after)]
    print(json.dumps({"commits": commits, "seed": options.seed, "count": options.count, "bugs": bugs}, indent=1))


def located(bug):
    """The file of a bug in this tree and the number of its line."""
    for file in map(pathlib.Path, bug["files"]):
        if file.exists() and (lines := file.read_text().splitlines()).count(bug["line"]) == 1:
            return file, lines.index(bug["line"]) + 1
    fail(f"{bug['files'][0]}: this line does not stand there once: {bug['line'].strip()}")


def build(options, folder):
    return subprocess.run(["cmake", "--build", options.build, "-t", f"{folder}_test"], capture_output=True, text=True)


def test(options, folder, timeout=None):
    """Runs the tests of a folder up to the first failure: whether they pass, the case that failed, the seconds."""
    program = pathlib.Path(options.build, "tests", f"{folder}_test").resolve()
    began = time.monotonic()
    try:
        done = subprocess.run([program, "--gtest_fail_fast"], cwd=program.parent, capture_output=True, text=True,
                              errors="replace", timeout=timeout)
    except subprocess.TimeoutExpired:
        return False, f"hangs for {timeout:.0f} s", timeout
    cases = re.findall(r"^\[(?: RUN      |  FAILED  )\] ([^\s,]+\.[^\s,]+)", done.stdout, re.M)
    return done.returncode == 0, cases[-1] if done.returncode != 0 and cases else "", time.monotonic() - began


def run(options):
    drawn = json.loads(pathlib.Path(options.bugs).read_text())
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(2))  # as an interruption: the file is restored
    resource.setrlimit(resource.RLIMIT_DATA, (8 << 30, 8 << 30))  # per process: a loop without end may allocate
    results, seconds = [], {}
    for bug, (file, number) in zip(drawn["bugs"], list(map(located, drawn["bugs"]))):
        folder = file.parts[2]
        if folder not in seconds:  # its tests must pass without a bug
            if (done := build(options, folder)).returncode != 0:
                fail(f"{folder}_test does not build without a bug:\n{done.stdout[-2000:]}")
            passed, case, seconds[folder] = test(options, folder)
            if not passed:
                fail(f"{folder}_test fails without a bug: {case}")
        text = file.read_text()
        fate, case = "does not compile", ""
        try:
            file.write_text(text.replace(f"\n{bug['line']}\n", f"\n{bug['bug']}\n"))
            if build(options, folder).returncode == 0:
                passed, case, _ = test(options, folder, 30 + 5 * seconds[folder])
                fate = "survived" if passed else "killed"
        finally:
            file.write_text(text)
        results.append(bug | {"place": f"{file}:{number}", "fate": fate, "case": case})
        print(f"{file}:{number}: {bug['line'].strip()}  ->  {bug['bug'].strip()}: {fate} {case}".rstrip(), flush=True)
        fates = [result["fate"] for result in results]
        if len(fates) - fates.count("does not compile") == drawn["count"]:
            break
    else:
        fail(f"fewer than {drawn['count']} of {len(results)} bugs compile")
    print(", ".join(f"{fates.count(fate)} {fate}" for fate in ("killed", "survived", "does not compile")))
    if options.out:
        pathlib.Path(options.out).write_text(json.dumps(results, indent=1) + "\n")


def compare(options):
    results = [json.loads(pathlib.Path(path).read_text()) for path in (options.before, options.after)]
    before, after = ([result for result in side if result["fate"] != "does not compile"] for side in results)
    if [bug["bug"] for bug in before] != [bug["bug"] for bug in after]:
        fail("the results are those of different bugs")
    for old, new in zip(before, after):
        print(f"{old['fate']:<8} {new['fate']:<8} {new['place']}: {new['line'].strip()}  ->  {new['bug'].strip()}")
    killed = [sum(bug["fate"] == "killed" for bug in side) for side in (before, after)]
    print(f"of {len(before)} bugs {killed[0]} are killed before and {killed[1]} after")
    sys.exit(killed[1] < killed[0])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for command, arguments in (draw, ("before", "after")), (run, ("bugs",)), (compare, ("before", "after")):
        of_command = commands.add_parser(command.__name__)
        of_command.set_defaults(command=command)
        for argument in arguments:
            of_command.add_argument(argument)
        if command is draw:
            of_command.add_argument("--count", type=int, default=30)
            of_command.add_argument("--seed", type=int, default=1)
        elif command is run:
            of_command.add_argument("--build", default="build/dev")
            of_command.add_argument("--out")
    options = parser.parse_args()
    options.command(options)


if __name__ == "__main__":
    main()
