#!/usr/bin/env python3
"""Runs `mvtp coordinate` on many networks and says on which it does not hold, and why.

    suite.py [--short] [--own] [--only NAME] [--also DIR] [--mvtp PATH] -o DIR

The networks are generated here (generated.py), or come with the installed SUMO (installed.py), or
lie in folders of the user (--also). A network passes if the program ends well, every vehicle that
should have arrived by then has, no coordinated vehicle overlaps another or leaves the road, no
person is touched, and it takes at most 1 GB. check_fcd.py gives a second opinion on the overlaps.

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
import xml.etree.ElementTree as ET

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import check_fcd  # noqa: E402
import generated  # noqa: E402
import installed  # noqa: E402

SHORT = ("grid-40-1", "roundabout-20", "t-priority", "arms-20", "left-hand-cross", "begin-28800")
SHORT_END = 100  # [s] of simulated time in the short form
FOREIGN_END = 600  # [s] after the begin, where a scenario has no end of its own
MEMORY_LIMIT = 1000  # [MB] that a run may take to pass
GRIDLOCK = "gridlock:"
NO_CONFLICTS = "no junction with conflicting"  # what mvtp says of a road without crossings
LATE_SHARE = 0.1  # of the vehicles that should have arrived and have not (3 at least): gridlock

COLUMNS = ["network", "verdict", "reasons", "exit", "status", "vehicles", "completed", "late",
           "late_own", "delay_s", "overlaps_coordinated", "overlaps_all", "checker_pairs",
           "checker_coordinated", "off_road_coordinated", "people_touched", "max_jump_m",
           "accel_violations", "max_lateral_accel", "hard_brakings", "replan_p95_ms",
           "real_time_factor", "outside_loop_s", "wall_s", "memory_mb", "message"]


@dataclasses.dataclass
class Scenario:
    name: str
    configuration: str
    problem: str = ""  # why it is not run


def time_of(configuration):
    """Begin and end of a scenario [s]; an end of None: none given."""
    begin, end = 0.0, None
    for element in ET.parse(configuration).getroot().iter():
        value = element.get("value") or element.get("v")
        if element.tag in ("begin", "b") and value:
            begin = float(value)
        if element.tag in ("end", "e") and value:
            end = float(value)
    return begin, end if end is not None and end > begin else None


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


def no_demand(path):
    with open(path, newline="", encoding="utf-8") as file:
        return next(csv.DictReader(file), None) is None


def late_vehicles(path, end):
    """(vehicles that have not arrived long after they should have, vehicles that should have)."""
    late = due = 0
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            # Twice the free flow and a minute is what a signal may cost.
            if float(row["intended_departure_s"]) + 2 * float(row["free_flow_s"]) + 60 > end:
                continue
            due += 1
            late += row["arrival_s"] == ""
    return late, due


def judge(scenario, folder, measured):
    row = dict.fromkeys(COLUMNS, "")
    row |= {"network": scenario.name, "exit": measured["exit"], "message": measured["message"],
            "wall_s": round(measured["wall"], 1), "memory_mb": round(measured["memory"])}
    reasons = []
    summary = read_summary(os.path.join(folder, "summary.json"))
    if measured["timeout"]:
        reasons.append("timeout")
    elif summary is None:
        name = f"signal {-measured['exit']}" if measured["exit"] < 0 else f"exit {measured['exit']}"
        reasons.append(f"no result ({name})")
    if measured["memory"] > MEMORY_LIMIT:
        reasons.append(f"{measured['memory']:.0f} MB")
    if summary:
        end = time_of(scenario.configuration)[0] + summary["simulated_s"]
        reasons += judge_summary(row, summary, folder, end)
        reasons += second_opinion(row, scenario, folder)
    row["verdict"] = "fail" if reasons else "pass"
    row["reasons"] = "; ".join(reasons)
    if NO_CONFLICTS in measured["message"]:
        row |= {"verdict": "not run", "reasons": "nothing to coordinate: no conflicts"}
    elif summary and no_demand(os.path.join(folder, "vehicles.csv")):
        row |= {"verdict": "not run", "reasons": "nothing to coordinate: no vehicles"}
    return row


def excuse(row):
    """Takes the gridlock off the reasons: the scenario jams under SUMO's own control as well."""
    left = [r for r in row["reasons"].split("; ") if not r.startswith(GRIDLOCK)]
    row["reasons"] = "; ".join(left)
    row["verdict"] = "fail" if left else "pass"


def read_summary(path):
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError):
        return None


def judge_summary(row, summary, folder, end):
    audit = summary["audit"]
    row |= {"status": summary["status"], "vehicles": summary["vehicles"],
            "completed": summary["completed"], "delay_s": round(summary["delay_s"]["mean"], 2),
            "overlaps_coordinated": audit["overlap_pairs_coordinated"],
            "overlaps_all": audit["overlap_pairs"],
            "off_road_coordinated": audit["off_road_steps_coordinated"],
            "people_touched": audit.get("people_touched", 0),
            "max_jump_m": round(summary["max_jump_m"], 3),
            "accel_violations": summary["accel_violations"],
            "max_lateral_accel": round(summary["max_lateral_accel"], 2),
            "hard_brakings": summary["hard_brakings_after_handback"],
            "replan_p95_ms": round(summary["replan_ms"]["p95"], 1),
            "real_time_factor": round(summary["real_time_factor"], 1)}
    if summary["real_time_factor"] > 0:
        in_loop = summary["simulated_s"] / summary["real_time_factor"]
        row["outside_loop_s"] = round(max(0.0, row["wall_s"] - in_loop), 1)
    reasons = []
    if summary["status"] not in ("finished", "end reached"):
        reasons.append(f"status {summary['status']}")
    if summary["vehicles"] == 0:
        reasons.append("no vehicle departed")
    late, due = late_vehicles(os.path.join(folder, "vehicles.csv"), end)
    row["late"] = f"{late}/{due}"
    if late >= 3 and late > LATE_SHARE * due:
        reasons.append(f"{GRIDLOCK} {late} of {due} late")
    for key, what in (("overlaps_coordinated", "overlapping pairs with a coordinated vehicle"),
                      ("off_road_coordinated", "off-road steps of coordinated vehicles"),
                      ("people_touched", "people touched")):
        if row[key]:
            reasons.append(f"{row[key]} {what}")
    return reasons


def second_opinion(row, scenario, folder):
    """What check_fcd.py finds; a reason only if it sees overlaps that the audit does not."""
    fcd = os.path.join(folder, "fcd.xml")
    if not os.path.exists(fcd):
        return []
    try:
        found = check_fcd.result(fcd, scenario.configuration, os.path.join(folder, "vehicles.csv"))
    except check_fcd.BadInput as error:
        return [f"checker: {error}"]
    row["checker_pairs"] = found["overlap_pairs"]
    row["checker_coordinated"] = found["overlap_pairs_ever_coordinated"]
    with open(os.path.join(folder, "checker.json"), "w", encoding="utf-8") as file:
        json.dump(found, file, indent=1)
    # One of 2 mm or less may be on the other side of the tolerance there.
    deep = sum(p["depth_m"] > 0.002 for p in found["pairs"])
    if deep > row["overlaps_all"]:
        return [f"checker sees {deep} overlapping pairs, the audit {row['overlaps_all']}"]
    return []


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
