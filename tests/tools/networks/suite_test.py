"""Tests of tools/networks/: the generated networks are the same each time, verdicts have reasons."""

import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ET

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)),
                                *[".."] * 3, "tools", "networks"))
import generated  # noqa: E402
import suite  # noqa: E402
import verdict  # noqa: E402

GOOD = {"status": "finished", "vehicles": 2, "completed": 2, "delay_s": {"mean": 1.0},
        "audit": {"overlap_pairs": 0, "overlap_pairs_coordinated": 0,
                  "off_road_steps_coordinated": 0, "people_touched": 0},
        "max_jump_m": 0.0, "accel_violations": 0, "max_lateral_accel": 1.0,
        "hard_brakings_after_handback": 0, "replan_ms": {"p95": 1.0}, "real_time_factor": 50.0,
        "simulated_s": 300.0}


class Generated(unittest.TestCase):
    def test_forty_networks_with_names_of_their_own(self):
        names = [n.name for n in generated.NETWORKS]
        self.assertGreaterEqual(len(names), 40)
        self.assertEqual(len(names), len(set(names)))
        self.assertLessEqual(set(suite.SHORT), set(names))

    def test_same_demand_each_time(self):
        network = next(n for n in generated.NETWORKS if n.name == "mixed-cross")
        demands = []
        for _ in range(2):
            with tempfile.TemporaryDirectory() as folder:
                generated.make(network, folder)
                root = ET.parse(os.path.join(folder, "demand.rou.xml")).getroot()
                demands.append([(v.attrib, v.find("route").attrib) for v in root.iter("vehicle")])
        self.assertGreater(len(demands[0]), 50)
        self.assertEqual(demands[0], demands[1])

    def test_u_turns_are_asked_for(self):
        network = next(n for n in generated.NETWORKS if n.name == "u-turns")
        with tempfile.TemporaryDirectory() as folder:
            generated.make(network, folder)
            root = ET.parse(os.path.join(folder, "demand.rou.xml")).getroot()
            routes = [r.get("edges").split() for r in root.iter("route")]
        back = [r for r in routes if r[0].split("-") == r[-1].split("-")[::-1]]
        self.assertGreater(len(back), 10)


class Judge(unittest.TestCase):
    def judge(self, summary, vehicles=(), measured=None):
        with tempfile.TemporaryDirectory() as folder:
            if summary is not None:
                with open(os.path.join(folder, "summary.json"), "w", encoding="utf-8") as file:
                    json.dump(summary, file)
            with open(os.path.join(folder, "vehicles.csv"), "w", newline="",
                      encoding="utf-8") as file:
                writer = csv.writer(file)
                writer.writerow(["id", "intended_departure_s", "arrival_s", "free_flow_s"])
                writer.writerows(vehicles)
            configuration = os.path.join(folder, "x.sumocfg")
            with open(configuration, "w", encoding="utf-8") as file:
                file.write('<configuration><time><begin value="0"/></time></configuration>')
            run = {"exit": 0, "message": "", "wall": 10.0, "memory": 100.0, "timeout": False}
            return verdict.judge(suite.Scenario("x", configuration), folder,
                               run | (measured or {}))

    def test_a_good_run_passes(self):
        row = self.judge(GOOD, [("a", 0, 50, 40), ("b", 10, 60, 40)])
        self.assertEqual((row["verdict"], row["reasons"]), ("pass", ""))

    def test_late_vehicles_are_a_gridlock(self):
        row = self.judge(GOOD, [("a", 0, "", 40)] * 3 + [("b", 10, 60, 40), ("c", 250, "", 40)])
        self.assertEqual(row["late"], "3/4")  # c could not have arrived yet
        self.assertIn("gridlock", row["reasons"])
        verdict.excuse(row)
        self.assertEqual((row["verdict"], row["reasons"]), ("pass", ""))

    def test_nothing_to_coordinate_is_not_run(self):
        self.assertEqual(self.judge(GOOD, [])["verdict"], "not run")
        said = {"exit": 2, "message": "mvtp: x: the network has no junction with conflicting connections"}
        self.assertEqual(self.judge(None, measured=said)["verdict"], "not run")

    def test_each_fault_is_named(self):
        for key, what in (("overlap_pairs_coordinated", "overlapping"),
                          ("off_road_steps_coordinated", "off-road"),
                          ("people_touched", "people")):
            row = self.judge(GOOD | {"audit": GOOD["audit"] | {key: 3}}, [("a", 0, 50, 40)])
            self.assertEqual(row["verdict"], "fail")
            self.assertIn(f"3 {what}", row["reasons"])
        for key, value, what in (("accel_violations", 2, "2 accelerations"),
                                 ("hard_brakings_after_handback", 1, "1 hard brakings"),
                                 ("max_jump_m", 0.0612, "a jump of 0.061 m")):
            row = self.judge(GOOD | {key: value}, [("a", 0, 50, 40)])
            self.assertEqual((row["verdict"], row["reasons"][:len(what)]), ("fail", what))

    def test_crash_timeout_and_memory(self):
        self.assertIn("signal 6", self.judge(None, measured={"exit": -6})["reasons"])
        self.assertIn("timeout", self.judge(None, measured={"timeout": True})["reasons"])
        self.assertIn("2000 MB", self.judge(GOOD, [("a", 0, 50, 40)], {"memory": 2000.0})["reasons"])
        self.assertIn("no vehicle", self.judge(GOOD | {"vehicles": 0}, [("a", 0, "", 40)])["reasons"])


STUB = """#!/usr/bin/env python3
import json, os, sys, time
folder = sys.argv[sys.argv.index("--output-dir") + 1]
with open(os.environ["STUB_CALLS"], "a") as file:
    file.write("called\\n")
if os.environ.get("STUB_HANGS"):
    time.sleep(60)
open(os.path.join(folder, "vehicles.csv"), "w").write(
    "id,intended_departure_s,arrival_s,free_flow_s\\na,0,50,40\\n")
open(os.path.join(folder, "summary.json"), "w").write(os.environ["STUB_SUMMARY"])
"""


class Command(unittest.TestCase):
    """The whole command, with a program that only pretends."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.calls = os.path.join(self.folder, "calls")
        self.stub = os.path.join(self.folder, "mvtp")
        with open(self.stub, "w", encoding="utf-8") as file:
            file.write(STUB)
        os.chmod(self.stub, 0o755)

    def suite(self, *arguments, **environment):
        command = [sys.executable, suite.__file__, "--mvtp", self.stub, "--only", "t-priority",
                   "--generated", "-o", os.path.join(self.folder, "out"), *arguments]
        done = subprocess.run(command, env=os.environ | {
            "STUB_CALLS": self.calls, "STUB_SUMMARY": json.dumps(GOOD)} | environment,
            capture_output=True, text=True, check=False)
        with open(self.calls, encoding="utf-8") as file:
            return done.returncode, len(file.readlines())

    def row(self):
        with open(os.path.join(self.folder, "out", "table.csv"), encoding="utf-8") as file:
            return next(csv.DictReader(file))

    def test_a_run_that_is_there_is_not_repeated(self):
        self.assertEqual(self.suite(), (0, 1))
        self.assertEqual(self.suite(), (0, 1))
        self.assertEqual(self.suite("--seed", "2"), (0, 2))
        self.assertEqual(self.suite("--seed", "2", "--again"), (0, 3))
        os.utime(self.stub, (1, 1))  # another program
        self.assertEqual(self.suite("--seed", "2"), (0, 4))
        self.assertEqual(self.row()["verdict"], "pass")

    def test_a_failure_is_exit_1_and_a_run_that_hangs_is_ended(self):
        self.assertEqual(self.suite("--timeout", "5", STUB_HANGS="1"), (1, 1))
        self.assertEqual(self.row()["reasons"], "timeout")


if __name__ == "__main__":
    unittest.main()
