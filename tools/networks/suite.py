#!/usr/bin/env python3
"""Runs `mvtp coordinate` on many networks and says on which it does not hold, and why.

    suite.py [--short] [--own] [--only NAME] [--also DIR] [--mvtp PATH] -o DIR

The networks are generated here (generated.py), or come with the installed SUMO (installed.py), or
lie in folders of the user (--also). A network passes if the program ends well, every vehicle that
should have arrived by then has, no coordinated vehicle overlaps another, leaves the road or
accelerates more than it can, nobody jumps or brakes hard where he is handed back, no person is
touched, and it takes at most 1 GB (verdict.py).

In DIR: table.md and table.csv, networks/ (the scenarios), and runs/CONTROLLER/NAME with what each
run wrote. Runs that are there already are not repeated unless the program or an option changed.
Exit codes: 0 all pass, 1 some do not, 2 bad usage, 130 interrupted.
"""

import argparse
import concurrent.futures
import csv
import dataclasses
import fnmatch
import hashlib
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import generated  # noqa: E402
import installed  # noqa: E402
from verdict import COLUMNS, GRIDLOCK, excuse, judge, time_of  # noqa: E402

SHORT = ("grid-40-1", "roundabout-20", "t-priority", "arms-20", "left-hand-cross", "begin-28800")
SHORT_END = 100  # [s] of simulated time in the short form
FOREIGN_END = 600  # [s] after the begin, where a scenario has no end of its own


@dataclasses.dataclass
class Scenario:
    name: str
    configuration: str
    problem: str = ""  # why it is not run


def collect(options):
    """All scenarios that are asked for, made or copied where needed."""
    wanted = lambda name: not options.only or any(fnmatch.fnmatch(name, o) for o in options.only)
    networks = os.path.join(options.output, "networks")
    scenarios = []
    for network in generated.NETWORKS:
        if not wanted(network.name) or (options.short and network.name not in SHORT):
            continue
        folder = os.path.join(networks, network.name)
        try:
            scenarios.append(Scenario(network.name, generated.make(network, folder)))
        except generated.GenerationFailed as error:
            scenarios.append(Scenario(network.name, "", f"not generated: {error}"))
    found = {}
    home = installed.sumo_home()
    if home and not options.short and not options.generated:
        folder = os.path.join(networks, "sumo")
        os.makedirs(folder, exist_ok=True)
        found |= installed.shipped(home, folder) | installed.completed(home, folder)
        found |= installed.with_our_demand(home, folder)
    for folder in options.also:
        for path in installed.configurations(folder):
            found[os.path.basename(path).partition(".")[0]] = path
    for name, path in found.items():
        if wanted(name):
            missing = installed.missing_files(path)
            problem = f"names missing files: {', '.join(missing)}" if missing else ""
            scenarios.append(Scenario(name, path, problem))
    return scenarios


class Runner:
    """Starts the runs, watches their time and memory, and stops what it started."""

    def __init__(self, options):
        self.options = options
        self.controller = "sumo" if options.own else options.controller
        self.running = set()
        self.lock = threading.Lock()
        self.stopped = False

    def key(self, command, scenario):
        """What a result depends on: a run with the same key is not repeated."""
        program = os.stat(self.options.mvtp)
        content = hashlib.sha256()
        for path in [scenario.configuration, *installed.input_files(scenario.configuration)]:
            with open(path, "rb") as file:
                # SUMO's tools write the time of day into a comment.
                content.update(re.sub(rb"<!--.*?-->", b"", file.read(), flags=re.DOTALL))
        return [command, program.st_size, int(program.st_mtime), self.options.memory,
                content.hexdigest()]

    def end_of(self, scenario):
        """When a run ends at the latest [s]; None: when all have arrived."""
        begin, end = time_of(scenario.configuration)
        if self.options.end is not None:
            return begin + self.options.end if self.options.end > 0 else None
        if self.options.short:
            return begin + SHORT_END
        generated_ends = {n.name: n.begin + n.end for n in generated.NETWORKS}
        return end or generated_ends.get(scenario.name) or begin + FOREIGN_END

    def run(self, scenario):
        """One row of the table."""
        if scenario.problem:
            return {"network": scenario.name, "verdict": "not run", "reasons": scenario.problem}
        row = self.row(scenario, self.controller)
        if GRIDLOCK in row["reasons"] and self.controller != "sumo":
            own = self.row(scenario, "sumo")
            row["late_own"] = own["late"]
            if own["late"] and int(own["late"].split("/")[0]) >= int(row["late"].split("/")[0]):
                excuse(row)
        return row

    def row(self, scenario, controller):
        """The verdict over one run, made or known."""
        folder = os.path.join(self.options.output, "runs", controller, scenario.name)
        end = self.end_of(scenario)
        command = [self.options.mvtp, "coordinate", "-c", scenario.configuration, "--output-dir",
                   folder, "--no-view", "--quiet", "--seed", str(self.options.seed),
                   "--controller", controller, *self.options.mvtp_option]
        command += ["--end", f"{end:g}"] if end is not None else []
        command += ["--", "--precision", "6", *self.options.sumo_option]
        key = self.key(command, scenario)
        record = os.path.join(folder, "result.json")
        if os.path.exists(record) and not self.options.again:
            with open(record, encoding="utf-8") as file:
                known = json.load(file)
            if known.get("key") == key:
                return known["row"]
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(folder)
        measured = self.measure(command)
        row = judge(scenario, folder, measured)
        if self.stopped:
            return row
        with open(record + ".part", "w", encoding="utf-8") as file:
            json.dump({"key": key, "row": row}, file, indent=1)
        os.replace(record + ".part", record)
        fcd = os.path.join(folder, "fcd.xml")
        if row["verdict"] == "pass" and not self.options.keep_fcd and os.path.exists(fcd):
            os.remove(fcd)
        return row

    def measure(self, command):
        """Exit code, what it said, wall time [s] and peak memory [MB] of one run."""
        limit = self.options.memory * 1000000

        def limit_memory():
            resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))

        started = time.monotonic()
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                              start_new_session=True, preexec_fn=limit_memory) as child:
            with self.lock:
                self.running.add(child.pid)
            said = []
            reader = threading.Thread(target=lambda: said.append(child.stderr.read()))
            reader.start()
            timers = [threading.Timer(self.options.timeout + grace, send, (child.pid, sign))
                      for grace, sign in ((0.0, signal.SIGTERM), (10.0, signal.SIGKILL))]
            for timer in timers:
                timer.start()
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            with self.lock:
                self.running.discard(child.pid)
            for timer in timers:
                timer.cancel()
            wall = time.monotonic() - started
            reader.join(timeout=5.0)
        text = (said[0] if said else b"").decode("utf-8", "replace").strip()
        return {"exit": child.returncode, "wall": wall, "memory": usage.ru_maxrss / 1024.0,
                "timeout": wall >= self.options.timeout,
                "message": text.splitlines()[-1] if text else ""}

    def stop(self):
        """Ends what runs: politely, and after five seconds for good."""
        self.stopped = True
        for sign, wait in ((signal.SIGTERM, 5.0), (signal.SIGKILL, 0.0)):
            with self.lock:
                left = set(self.running)
            for pid in left:
                send(pid, sign)
            limit = time.monotonic() + wait
            while self.running and time.monotonic() < limit:
                time.sleep(0.1)


def send(pid, sign):
    try:
        os.killpg(pid, sign)
    except ProcessLookupError:
        pass


def write_tables(folder, controller, rows):
    suffix = "" if controller == "escot" else f"-{controller}"
    with open(os.path.join(folder, f"table{suffix}.csv"), "w", newline="",
              encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, restval="")
        writer.writeheader()
        writer.writerows(rows)
    shown = [c for c in COLUMNS if c != "message"]
    with open(os.path.join(folder, f"table{suffix}.md"), "w", encoding="utf-8") as file:
        file.write("| " + " | ".join(shown) + " |\n|" + "---|" * len(shown) + "\n")
        for row in rows:
            cells = [str(row.get(c, "")).replace("|", "/") for c in shown]
            file.write("| " + " | ".join(cells) + " |\n")
        verdicts = [r["verdict"] for r in rows]
        file.write(f"\n{verdicts.count('pass')} pass, {verdicts.count('fail')} fail, "
                   f"{verdicts.count('not run')} not run.\n")


def find_mvtp(given):
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
    built = os.path.join(root, "build", "release", "bin", "mvtp")
    path = given or (built if os.path.exists(built) else shutil.which("mvtp"))
    return os.path.abspath(path) if path and os.path.exists(path) else None


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("-o", "--output", required=True, metavar="DIR")
    parser.add_argument("--short", action="store_true",
                        help=f"{len(SHORT)} small networks, {SHORT_END} s each")
    parser.add_argument("--only", action="append", default=[], metavar="NAME",
                        help="this network, or those that match, e.g. 'grid-*'; repeatable")
    parser.add_argument("--generated", action="store_true", help="leave SUMO's own scenarios out")
    parser.add_argument("--also", action="append", default=[], metavar="DIR",
                        help="run the scenarios below this folder, too; repeatable")
    parser.add_argument("--own", action="store_true", help="SUMO's own control, for comparison")
    parser.add_argument("--controller", default="escot")
    parser.add_argument("--mvtp", help="the program (default: the release build, else from PATH)")
    parser.add_argument("--mvtp-option", action="append", default=[], metavar="OPTION",
                        help="given to mvtp as it is, e.g. --mvtp-option=--tries=5; repeatable")
    parser.add_argument("--sumo-option", action="append", default=[], metavar="OPTION",
                        help="given to SUMO as it is, e.g. --sumo-option=--scale=1.5; repeatable")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--end", type=float, help="simulated time after the begin [s] "
                        f"(default: the scenario's, else {FOREIGN_END}; 0: until all have arrived)")
    parser.add_argument("--timeout", type=float, default=600.0, help="per run [s] (600)")
    parser.add_argument("--memory", type=int, default=3000, metavar="MB",
                        help="a run that wants more is refused it (3000)")
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time (1)")
    parser.add_argument("--again", action="store_true", help="repeat the runs that are there")
    parser.add_argument("--keep-fcd", action="store_true", help="keep fcd.xml of runs that pass, too")
    parser.add_argument("--list", action="store_true", help="list the scenarios and stop")
    options = parser.parse_args()
    options.mvtp = find_mvtp(options.mvtp)
    if not options.mvtp:
        parser.error("no mvtp found; build it or give --mvtp PATH")
    options.output = os.path.abspath(options.output)
    return options


def main():
    options = parse_options()
    scenarios = collect(options)
    if not scenarios:
        print("suite.py: no network has such a name; --list shows all", file=sys.stderr)
        return 2
    if options.list:
        for s in scenarios:
            print(f"{s.name:40} {s.problem or s.configuration}")
        return 0
    runner = Runner(options)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    rows = {}
    pool = concurrent.futures.ThreadPoolExecutor(options.jobs)
    futures = {pool.submit(runner.run, s): s.name for s in scenarios}
    try:
        for future in concurrent.futures.as_completed(futures):
            row = future.result()
            rows[row["network"]] = row
            print(f"{len(rows)}/{len(scenarios)} {row['network']}: {row['verdict']} "
                  f"{row['reasons']}", file=sys.stderr, flush=True)
            write_tables(options.output, runner.controller,
                         [rows[s.name] for s in scenarios if s.name in rows])
    except KeyboardInterrupt:
        runner.stop()
        pool.shutdown(cancel_futures=True)
        return 130
    pool.shutdown()
    return 1 if any(r["verdict"] == "fail" for r in rows.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
