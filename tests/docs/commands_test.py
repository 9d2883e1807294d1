#!/usr/bin/env python3
"""Runs the commands of the docs: commands_test.py ROOT BIN_FOLDER WORK_FOLDER [PAGE ...]

Every block marked sh is run, those of a page one after another in one folder that looks like the
source tree, and then every block marked python. In a comment before its block a page may give a
shorter form of commands that take long:

    <!-- tested as
    mvtp solve -i scenarios/circle/circle2.yaml -o plan.yaml
    -->

Each command shown must then be in it with all its options. Commands that nobody runs are named in
not_run.txt, with the reason; so are blocks of Python, by their first line. The options of mvtp that
these commands, or a line of text, name must be there.

MVTP_PYTHON is the interpreter for blocks of Python, MVTP_PYTHON_TREE where it finds mvtp; without
them these blocks are not run.
"""

import fnmatch
import functools
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

BLOCK = re.compile(r"(?:<!-- tested as\n(?P<short>.*?)-->\s*)?^```sh\n(?P<shown>.*?)^```",
                   re.DOTALL | re.MULTILINE)
PYTHON = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)
INLINE = re.compile(r"`(mvtp [a-z][^`]*)`")
LINKED = ("docs", "networks", "planner", "scenarios", "tools")


def read_not_run(path):
    entries = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            where, reason = line.split(" -- ")
            assert reason, f"not_run.txt: no reason given: {line}"
            page, command = where.split(": ", 1)
            entries.append((page, command))
    return entries


def commands_of(text):
    """The lines of a script, those that go on joined, without comments."""
    lines = (re.sub(r"(^|\s+)# .*$", "", line) for line in text.replace("\\\n", " ").splitlines())
    return [line for line in lines if line.strip()]


def words(command):
    try:
        return shlex.split(command.replace("$mvtp ", "mvtp "))
    except ValueError:  # a part of a command over several lines
        return command.split()


def covers(tested, shown):
    """Is `tested` the same command with at least the options of `shown`?"""
    a, b = words(tested), words(shown)
    options = {word for word in b if re.match(r"--?[a-z]", word)}
    return a[:2] == b[:2] and options <= set(a)


class Page:
    def __init__(self, root, name, not_run):
        self.name = name
        self.not_run = [command for page, command in not_run if fnmatch.fnmatch(name, page)]
        self.used = set()
        text = (root / name).read_text(encoding="utf-8")
        self.unseen = []  # commands that are shown and not run
        self.script = [line for block in BLOCK.finditer(text) for line in self.lines_of(block)]
        self.python = "".join(block for block in PYTHON.findall(text) if self.is_run(block.splitlines()[0]))
        if not name.startswith("docs/experiments/"):  # those name commits of their own
            self.unseen += INLINE.findall(re.sub(r"^```.*?^```", "", text, flags=re.S | re.M))

    def is_run(self, command):
        for pattern in self.not_run:
            if fnmatch.fnmatchcase(command.strip(), pattern.replace("[", "[[]")):
                self.used.add(pattern)
                self.unseen.append(command.strip())
                return False
        return True

    def lines_of(self, block):
        shown = [command for command in commands_of(block["shown"]) if self.is_run(command)]
        if block["short"] is None:
            return shown
        tested = commands_of(block["short"])
        for command in shown:
            assert any(covers(line, command) for line in tested), \
                f"{self.name}: \"tested as\" lacks this command, or one of its options: {command}"
        return tested


def make_folder(root, programs, folder):
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "build/release").mkdir(parents=True)
    (folder / "build/release/bin").symlink_to(programs)
    for name in LINKED:
        (folder / name).symlink_to(root / name)


def run_in(folder, what, words, environment):
    done = subprocess.run(words, cwd=folder, env=os.environ | environment, text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        print(f"{what}: exit code {done.returncode}\n{done.stdout[-3000:]}")
    return done.returncode == 0


def run(page, root, programs, folder):
    make_folder(root, programs, folder)
    path = {"PATH": f"{programs}:{os.environ['PATH']}"}
    script = "set -e -o pipefail\n" + "\n".join(page.script) + "\n"
    good = run_in(folder, page.name, ["bash", "-x", "-c", script], path)
    python = os.environ.get("MVTP_PYTHON")
    if not page.python or not python:
        return good
    return good & run_in(folder, f"{page.name}: Python", [python, "-B", "-c", page.python],
                         path | {"PYTHONPATH": os.environ["MVTP_PYTHON_TREE"]})


@functools.cache
def help_of(programs, *command):
    done = subprocess.run([programs / "mvtp", *command, "--help"], text=True, capture_output=True,
                          check=False)
    return set(re.findall(r"--?[a-z][a-z0-9-]*", done.stdout)) if done.returncode == 0 else None


def options_that_are_none(page, programs):
    for shown in page.unseen:
        line = words(re.sub(r" -- .*| [|&;].*", "", shown))
        if line[:1] != ["mvtp"] or len(line) < 2:
            continue
        command = line[1:3] if line[1] == "toio" else line[1:2]
        known = help_of(programs, *command)
        if known is None:
            yield f"{page.name}: `{shown}`: there is no such command"
        for word in line[2:] if known else []:
            option = word.split("=")[0]
            if re.fullmatch(r"--?[a-z][a-z0-9-]*", option) and option not in known:
                yield f"{page.name}: `{shown}`: mvtp {' '.join(command)} has no {option}"


def pages_of(root):
    for folder in ("", "docs/**/", "planner/**/", "coordinator/**/", "tools/**/", "scenarios/**/", "tests/**/"):
        yield from (str(path.relative_to(root)) for path in sorted(root.glob(folder + "*.md")))


def main():
    root, programs, work = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    not_run = read_not_run(root / "tests/docs/not_run.txt")
    pages = [Page(root, name, not_run) for name in dict.fromkeys(sys.argv[4:] or pages_of(root))]
    good = True
    for page in pages:
        if page.script or page.python:
            lines = len(page.script) + page.python.count("\n")
            print(f"{page.name}: {lines} lines", flush=True)
            good &= run(page, root, programs, work / page.name.replace("/", "-"))
        for fault in options_that_are_none(page, programs):
            print(fault)
            good = False
    unused = {command for _, command in not_run} - {c for page in pages for c in page.used}
    if unused and not sys.argv[4:]:
        print(f"not_run.txt: no page has these: {sorted(unused)}")
        good = False
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
