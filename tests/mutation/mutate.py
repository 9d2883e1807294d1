#!/usr/bin/env python3
"""Breaks single lines of a folder, and looks whether its tests notice.

    tests/mutation/mutate.py planner/motion

draws 30 lines of logic below planner/motion, breaks each in one place (a comparison, a sum, a
constant, a condition, a statement), builds the folder's tests and runs them. The table says for
each mutant which test killed it, that it survived, or that it did not compile. Begun again it goes on
where it was; the sources of the first time are kept, so that lines stay what they were.
"""

import argparse
import csv
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import time

import mutants

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Of each folder the test programs that are there for it; --target names others.
TARGETS = {
    "planner/problem": ["planner_problem_tests"],
    "planner/geometry": ["planner_motion_tests"],
    "planner/motion": ["planner_motion_tests"],
    "planner/search": ["planner_search_tests", "planner_solver_tests"],
    "planner/escot": ["planner_solver_tests"],
    "planner/anytime": ["planner_solver_tests"],
    "planner/road": ["planner_road_tests", "planner_reservation_tests"],
    "planner/lot": ["planner_lot_tests"],
    "coordinator": ["coordinator_measures_tests", "coordinator_greens_tests", "coordinator_controllers_tests",
                    "coordinator_tests", "coordinator_mixed_tests"],
}
FIELDS = ["file", "line", "kind", "code", "old", "new", "result"]
OPTIONS = ["-DCMAKE_BUILD_TYPE=RelWithDebInfo", "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1",
           "-DMVTP_WITH_SUMO=OFF", "-DMVTP_WITH_BLUETOOTH=OFF", "-DMVTP_BUILD_PYTHON=OFF"]
MEMORY = 8 << 30  # of a test program [bytes]


def copy_sources(tree, folder):
    """The files below a folder that git knows or has not been told to ignore, as they are now."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", folder]
    names = subprocess.run(command, cwd=ROOT, check=True, capture_output=True).stdout
    for name in names.decode().split("\0"):
        if name and (ROOT / name).is_file() and not name.startswith(("networks/", "docs/")):
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, tree / name)


class Bench:
    """A copy of the sources with a build tree of its own."""

    def __init__(self, work, targets, jobs):
        self.tree = work / "tree"
        self.build_folder = work / "build"
        self.targets = targets
        self.jobs = jobs
        self.limit = 600.0  # of all tests [s], until they ran once

    def set_up(self):
        """Builds and runs the tests of what is not broken. Returns an error, or None."""
        if not self.tree.exists():
            copy_sources(self.tree, ".")
        configure = ["cmake", "-S", str(self.tree), "-B", str(self.build_folder), "-G", "Ninja", *OPTIONS]
        subprocess.run(configure, check=True, capture_output=True)
        if not self.build():
            return "the sources do not build; see " + str(self.build_folder / "build.log")
        begin = time.monotonic()
        killer = self.killer()
        self.limit = 10.0 + 5.0 * (time.monotonic() - begin)
        return killer and "a test fails on the sources as they are: " + killer

    def build(self):
        command = ["cmake", "--build", str(self.build_folder), "-j", str(self.jobs), "--target", *self.targets]
        with open(self.build_folder / "build.log", "w", encoding="utf-8") as log:
            return subprocess.run(command, stdout=log, stderr=log).returncode == 0

    def killer(self):
        """The test that fails first; None if all pass."""
        for target in self.targets:
            program = self.build_folder / "tests" / target
            try:
                run = subprocess.run([str(program), "--gtest_fail_fast"], capture_output=True, text=True,
                                     errors="replace", timeout=self.limit, cwd=self.build_folder,
                                     preexec_fn=limit_memory)
            except subprocess.TimeoutExpired as expired:
                return "time limit in " + last_begun((expired.stdout or b"").decode(errors="replace"))
            if run.returncode != 0:
                failed = re.search(r"\[  FAILED  \] (\S+?),? ", run.stdout)
                return failed[1] if failed else "crash in " + last_begun(run.stdout)
        return None

    def judge(self, mutant):
        before = mutants.apply(self.tree, mutant)
        try:
            if not self.build():
                return "did not compile"
            killer = self.killer()
            return "killed by " + killer if killer else "survived"
        finally:
            (self.tree / mutant.file).write_text(before, encoding="utf-8")


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def last_begun(output):
    begun = re.findall(r"\[ RUN      \] (\S+)", output)
    return begun[-1] if begun else "the test program"


def row_of(tree, mutant, result):
    line = (tree / mutant.file).read_text(encoding="utf-8").split("\n")[mutant.line - 1]
    return {"file": mutant.file, "line": str(mutant.line), "kind": mutant.kind, "code": line.strip(),
            "old": mutant.old, "new": mutant.new, "result": result}


def read_table(path):
    if not path.exists():
        return []
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def write_table(path, rows):
    with open(path, "w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, FIELDS, lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


def summary(rows):
    results = [row["result"] for row in rows]
    compiled = [r for r in results if r != "did not compile"]
    killed = [r for r in compiled if r != "survived"]
    share = 100.0 * len(killed) / max(1, len(compiled))
    return (f"{len(rows)} mutants: {len(rows) - len(compiled)} did not compile, {len(killed)} of the other "
            f"{len(compiled)} killed ({share:.0f} %)")


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", help="whose lines are broken")
    parser.add_argument("--number", type=int, default=30, help="of mutants [30]")
    parser.add_argument("--seed", type=int, default=1, help="of the draw [1]")
    parser.add_argument("--target", action="append", help="test program to run, repeatable [the folder's own]")
    parser.add_argument("--jobs", type=int, default=2, help="compilers at once [2]")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build" / "mutation",
                        help="folder of the copy and its build tree [build/mutation]")
    parser.add_argument("--table", type=pathlib.Path, help="CSV file [WORK/FOLDER-SEED.csv]")
    parser.add_argument("--fresh", action="store_true", help="copy the sources and begin the table anew")
    parser.add_argument("--again", action="store_true",
                        help="copy the tests anew, and judge those that survived once more")
    options = parser.parse_args()
    options.folder = options.folder.strip("/")
    options.target = options.target or TARGETS.get(options.folder)
    if not options.target:
        parser.error(f"which tests are there for {options.folder}? Say so by --target")
    options.table = options.table or options.work / f"{options.folder.replace('/', '-')}-{options.seed}.csv"
    return options


def main():
    options = parse()
    if options.fresh:
        shutil.rmtree(options.work / "tree", ignore_errors=True)
        options.table.unlink(missing_ok=True)
    bench = Bench(options.work, options.target, options.jobs)
    if options.again and bench.tree.exists():
        copy_sources(bench.tree, "tests")
    error = bench.set_up()
    if error:
        sys.exit("mutate.py: " + error)
    rows = read_table(options.table)
    if options.again:
        rows = [row for row in rows if row["result"] != "survived"]
    known = {(r["file"], r["line"], r["old"], r["new"]) for r in rows}
    for mutant in mutants.draw(bench.tree, options.folder, options.number, options.seed):
        if (mutant.file, str(mutant.line), mutant.old, mutant.new) in known:
            continue
        rows.append(row_of(bench.tree, mutant, ""))
        rows[-1]["result"] = bench.judge(mutant)
        write_table(options.table, rows)
        row = rows[-1]
        print(f"{row['file']}:{row['line']}: {row['old']} -> {row['new']}: {row['result']}", flush=True)
    print(summary(rows))


if __name__ == "__main__":
    main()
