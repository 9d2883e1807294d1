"""Tests of tools/networks/signals.py: the twin of a scenario has its lanes, its demand, and lights."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ET

ROOT = pathlib.Path(__file__).resolve().parents[3]


def lanes(network):
    """Id, speed and shape of all lanes on roads."""
    return {lane.get("id"): (lane.get("speed"), lane.get("shape"))
            for edge in network.iter("edge") if edge.get("function") != "internal"
            for lane in edge.iter("lane")}


def connections(network):
    """Which lane leads onto which."""
    return {(c.get("from"), c.get("fromLane"), c.get("to"), c.get("toLane")) for c in network.iter("connection")
            if not c.get("from").startswith(":")}


class Signals(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        for name in ("scenarios/crossroads", "networks"):
            shutil.copytree(ROOT / name, self.folder / name)
        self.scenario = self.folder / "scenarios/crossroads/crossroads-400.sumocfg"
        for twin in self.scenario.parent.glob("*.static.*"):
            twin.unlink()

    def run_on(self, scenario, *arguments):
        """What the command printed to stderr, and its exit code."""
        run = subprocess.run([sys.executable, ROOT / "tools/networks/signals.py", scenario, *arguments],
                             capture_output=True, text=True, check=False)
        return run.returncode, run.stderr

    def files(self):
        return sorted(p.name for p in self.scenario.parent.iterdir())

    def test_same_lanes_and_demand_with_a_light(self):
        self.assertEqual(self.run_on(self.scenario), (0, ""))
        twin = ET.parse(self.scenario.with_suffix(".static.sumocfg"))
        network = ET.parse(self.scenario.with_suffix(".static.net.xml"))
        plain = ET.parse(self.folder / "networks/crossroads.net.xml")
        self.assertEqual(twin.find("input/net-file").get("value"), "crossroads-400.static.net.xml")
        self.assertEqual(twin.find("input/route-files").get("value"), "demand-400.rou.xml")
        self.assertEqual(lanes(network), lanes(plain))
        self.assertEqual(connections(network), connections(plain))
        light = {j.get("type") for j in network.iter("junction") if j.get("id") == "C"}
        self.assertEqual(light, {"traffic_light"})

    def test_sumo_runs_it(self):
        self.assertEqual(self.run_on(self.scenario, "--type", "actuated", "--junctions", "C"), (0, ""))
        run = subprocess.run(["sumo", "-c", self.scenario.with_suffix(".actuated.sumocfg"), "--end", "5"],
                             capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)

    def test_says_what_is_wrong_and_writes_nothing(self):
        before = self.files()
        broken = self.scenario.with_name("broken.sumocfg")
        for arguments, message in (((self.scenario, "--junctions", "C,D"), "--junctions D: no junction"),
                                   ((self.scenario.with_name("none.sumocfg"),), "No such file"),
                                   ((ROOT / "README.md",), "no XML"),
                                   ((broken,), "netconvert")):
            broken.write_text("<configuration><net-file value='../../networks/broken.net.xml'/></configuration>")
            (self.folder / "networks/broken.net.xml").write_text(
                "<net><junction id='J' type='priority'><request foes='01'/></junction></net>")
            code, error = self.run_on(*arguments)
            broken.unlink()
            self.assertEqual((code, error.count("\n")), (2, 1), error)
            self.assertIn(message, error)
            self.assertEqual(self.files(), before)

    def test_nothing_to_do(self):
        self.run_on(self.scenario)
        code, error = self.run_on(self.scenario.with_suffix(".static.sumocfg"))
        self.assertEqual(code, 2)
        self.assertIn("no junction with conflicts that has no light", error)

    def test_variables_in_the_name_of_the_network(self):
        text = self.scenario.read_text().replace("../../networks/crossroads.net.xml", "${NETS}/crossroads.net.xml")
        self.scenario.write_text(text)
        os.environ["NETS"] = str(self.folder / "networks")
        self.assertEqual(self.run_on(self.scenario), (0, ""))


if __name__ == "__main__":
    unittest.main()
