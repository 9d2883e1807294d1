"""What mvtp export writes, read back with Python's own readers and compared with where it is from.

    round_trip_test.py MVTP SCENARIOS
"""

import csv
import math
import os
import re
import shutil
import subprocess
import sys
import unittest
import xml.etree.ElementTree as ET

from export_case import MILLIMETRE, SCENARIOS, Case, mvtp

FRONT, REAR = 2.5, 0.5  # of the preset "escot" [m]


def content_of(path):
    with open(path, "rb") as file:
        return file.read()


def moved(x, y, yaw, ahead):
    return x + ahead * math.cos(yaw), y + ahead * math.sin(yaw)


def states_of_plan(path):
    """{agent: [(t, x, y, yaw, v, phi)]} of a plan file of mvtp."""
    agents, states = {}, None
    with open(path, encoding="utf-8") as file:
        for line in file:
            if found := re.match(r"  (\w+):$", line):
                states = agents[found[1]] = []
            elif states is not None and (found := re.findall(r"(\w+): ([-+.\deE]+)", line)):
                values = {key: float(value) for key, value in found}
                states.append(tuple(values.get(k, 0.0) for k in ("t", "x", "y", "yaw", "v", "phi")))
    return agents


class Plan(Case):
    """One car drives ahead, one back."""

    @classmethod
    def make(cls):
        with open(cls.path("i.yaml"), "w", encoding="utf-8") as file:
            file.write("agents:\n"
                       "  - {start: [5, 5, 0], goal: [25, 5, 0]}\n"
                       "  - {start: [10, 16, 0], goal: [5, 16, 0]}\n"
                       "map: {dimensions: [30, 20], obstacles: [[15, 15, 1]],\n"
                       "      polygons: [[[20, 12], [22, 12], [22, 14]]]}\n")
        mvtp("solve", "-i", cls.path("i.yaml"), "-q", "-o", cls.path("p.yaml"))
        cls.plan = states_of_plan(cls.path("p.yaml"))
        cls.steps = max(len(states) for states in cls.plan.values())

    def state(self, agent, t):
        """An agent rests at its last state."""
        states = self.plan[agent]
        return states[t] if t < len(states) else (t, *states[-1][1:4], 0.0, 0.0)

    def everybody(self):
        return [(a, t, *self.state(a, t)[1:]) for a in self.plan for t in range(self.steps)]

    def test_commonroad_comes_with_the_plans_day(self):
        os.utime(self.path("p.yaml"), (86400 * 365, 86400 * 365))
        root = ET.parse(self.export("p.yaml", "commonroad")).getroot()
        self.assertEqual(root.get("date"), "1971-01-01")

    def test_somebody_reverses(self):
        self.assertTrue(any(v < 0 for *_, v, _ in self.everybody()))

    def test_csv(self):
        with open(self.export("p.yaml", "csv"), newline="", encoding="utf-8") as file:
            rows = {(r["id"], round(float(r["t"]))): r for r in csv.DictReader(file)}
        self.assertEqual(len(rows), len(self.plan) * self.steps)
        for agent, t, *values in self.everybody():
            row = rows[agent, t]
            self.near([float(row[k]) for k in ("x", "y", "yaw", "v", "steer")], values)

    def test_fcd(self):
        root = ET.parse(self.export("p.yaml", "fcd")).getroot()
        seen = {(v.get("id"), round(float(step.get("time")))): v
                for step in root.iter("timestep") for v in step}
        for agent, t, x, y, yaw, v, _ in self.everybody():
            vehicle = seen[agent, t]
            bumper = moved(x, y, yaw, FRONT)
            self.near([float(vehicle.get("x")), float(vehicle.get("y"))], bumper)
            angle = math.radians(90 - float(vehicle.get("angle")))
            self.near([math.cos(angle), math.sin(angle)], [math.cos(yaw), math.sin(yaw)])
            self.assertAlmostEqual(float(vehicle.get("speed")), abs(v), delta=MILLIMETRE)

    def test_commonroad(self):
        root = ET.parse(self.export("p.yaml", "commonroad", "-i", self.path("i.yaml"))).getroot()
        self.assertEqual([child.tag for child in root],
                         ["location", "scenarioTags", "lanelet", *["staticObstacle"] * 2,
                          *["dynamicObstacle"] * 2, "planningProblem"])
        self.assertEqual((root.tag, root.get("commonRoadVersion")), ("commonRoad", "2020a"))
        ids = [child.get("id") for child in root if child.get("id")]
        self.assertEqual(len(ids), len(set(ids)))
        self.assertTrue(all(int(i) > 0 for i in ids))
        for obstacle, agent in zip(root.iter("dynamicObstacle"), self.plan, strict=True):
            self.assertEqual([child.tag for child in obstacle],
                             ["type", "shape", "initialState", "trajectory"])
            states = [obstacle.find("initialState"), *obstacle.find("trajectory")]
            self.assertEqual(len(states), self.steps)
            for t, state in enumerate(states):
                _, x, y, yaw, v, _ = self.state(agent, t)
                values = [float(state.findtext(path)) for path in (
                    "position/point/x", "position/point/y", "orientation/exact", "velocity/exact")]
                self.near(values, [*moved(x, y, yaw, (FRONT - REAR) / 2), yaw, v])
                self.assertEqual(int(state.findtext("time/exact")), t)

    def test_commonroad_ego(self):
        root = ET.parse(self.export("p.yaml", "commonroad", "--ego", "agent1")).getroot()
        self.assertEqual(len(root.findall("dynamicObstacle")), 1)
        problem = root.find("planningProblem")
        _, x, y, yaw, *_ = self.state("agent1", 0)
        self.near([float(problem.findtext("initialState/position/point/x"))],
                  moved(x, y, yaw, (FRONT - REAR) / 2)[:1])
        _, x, y, yaw, *_ = self.state("agent1", self.steps)
        self.near([float(problem.findtext("goalState/position/rectangle/center/x"))],
                  moved(x, y, yaw, (FRONT - REAR) / 2)[:1])

    def test_commonroad_numbers_are_decimals(self):
        root = ET.parse(self.export("p.yaml", "commonroad")).getroot()
        for tag in ("x", "y", "exact", "length", "width", "intervalStart"):
            for element in root.iter(tag):
                self.assertRegex(element.text, r"^-?\d+(\.\d+)?$")

    def test_openscenario(self):
        root = ET.parse(self.export("p.yaml", "openscenario")).getroot()
        self.assertEqual([child.tag for child in root],
                         ["FileHeader", "CatalogLocations", "RoadNetwork", "Entities", "Storyboard"])
        header = root.find("FileHeader")
        self.assertEqual((header.get("revMajor"), header.get("revMinor")), ("1", "2"))
        self.assertEqual([o.get("name") for o in root.iter("ScenarioObject")], list(self.plan))
        box = root.find(".//BoundingBox")
        self.near([float(box.find("Center").get("x")), float(box.find("Dimensions").get("length"))],
                  [(FRONT - REAR) / 2, FRONT + REAR])
        for group in root.iter("ManeuverGroup"):
            agent = group.find("Actors/EntityRef").get("entityRef")
            self.assertEqual(group.find(".//TrajectoryFollowingMode").get("followingMode"), "position")
            vertices = list(group.iter("Vertex"))
            self.assertEqual(len(vertices), self.steps)
            for t, vertex in enumerate(vertices):
                place = vertex.find("Position/WorldPosition")
                self.near([float(vertex.get("time")), *(float(place.get(k)) for k in "xyh")],
                          [t, *self.state(agent, t)[1:4]])

    def test_part_of_the_time(self):
        with open(self.export("p.yaml", "csv", "--begin", "2", "--end", "4"), newline="",
                  encoding="utf-8") as file:
            self.assertEqual({float(r["t"]) for r in csv.DictReader(file)}, {2.0, 3.0, 4.0})


class Run(Case):
    """A quarter of a minute of the crossroads in SUMO."""

    @classmethod
    def make(cls):
        mvtp("coordinate", "-c", os.path.join(SCENARIOS, "crossroads", "crossroads.sumocfg"),
             "--end", "15", "--quiet", "--output-dir", cls.path("run"), codes=(0, 1))
        cls.vehicles = {}
        for step in ET.parse(cls.path("run/fcd.xml")).getroot():
            for vehicle in step:
                cls.vehicles[vehicle.get("id"), step.get("time")] = vehicle

    def test_it_has_vehicles(self):
        self.assertGreater(len(self.vehicles), 100)

    def test_csv_is_where_sumo_had_the_bumpers(self):
        with open(self.export("run", "csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(self.vehicles))
        for row in rows:
            sumo = self.vehicles[row["id"], f"{float(row['t']):.2f}"]
            bumper = moved(float(row["x"]), float(row["y"]), float(row["yaw"]), 3.6)  # 0.8 x 4.5 m
            self.near(bumper, [float(sumo.get("x")), float(sumo.get("y"))])
            self.assertAlmostEqual(float(row["v"]), float(sumo.get("speed")), delta=MILLIMETRE)

    def test_fcd_is_what_sumo_wrote(self):
        count = 0
        for step in ET.parse(self.export("run", "fcd")).getroot():
            for vehicle in step:
                sumo = self.vehicles[vehicle.get("id"), f"{float(step.get('time')):.2f}"]
                for key in ("x", "y", "angle", "speed"):
                    self.assertAlmostEqual(float(vehicle.get(key)), float(sumo.get(key)), delta=MILLIMETRE)
                self.assertEqual(vehicle.get("type"), sumo.get("type"))
                count += 1
        self.assertEqual(count, len(self.vehicles))

    def test_fcd_is_valid_by_sumos_schema(self):
        home = os.environ.get("SUMO_HOME") or "/usr/share/sumo"
        schema = os.path.join(home, "data", "xsd", "fcd_file.xsd")
        if not os.path.exists(schema):
            self.skipTest("SUMO's schemas are not installed")
        done = subprocess.run(["xmllint", "--noout", "--nonet", "--schema", schema,
                               self.export("run", "fcd")],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_openscenario_has_the_roads_beside_it(self):
        root = ET.parse(self.export("run", "openscenario")).getroot()
        road_file = root.find("RoadNetwork/LogicFile").get("filepath")
        self.assertEqual(road_file, "out.xodr")
        roads = ET.parse(self.path(road_file)).getroot()
        self.assertEqual(roads.tag, "OpenDRIVE")
        self.assertGreater(len(roads.findall("road")), 4)
        # Who comes later is added then, and is not there before.
        ids = {i for i, _ in self.vehicles}
        added = {e.get("entityRef") for e in root.iter("EntityAction") if e.find("AddEntityAction") is not None}
        placed = {e.get("entityRef") for e in root.iter("Private")}
        self.assertEqual(added | placed, ids)
        self.assertEqual(added & placed, set())

    def test_commonroad_has_lanelets_as_wide_as_the_lanes(self):
        root = ET.parse(self.export("run", "commonroad")).getroot()
        self.assertGreater(len(root.findall("lanelet")), 8)
        for lanelet in root.iter("lanelet"):
            left, right = (
                [(float(p.findtext("x")), float(p.findtext("y"))) for p in lanelet.find(bound)]
                for bound in ("leftBound", "rightBound"))
            for a, b in zip(left, right, strict=True):
                self.assertAlmostEqual(math.dist(a, b), 3.2, delta=0.01)

    def refused(self, regex, source, *arguments):
        """One line, exit code 2, and every file as it was."""
        def files():
            return {(folder, name): content_of(os.path.join(folder, name))
                    for folder, _, names in os.walk(self.folder) for name in names}
        before = files()
        done = mvtp("export", self.path(source), *arguments, codes=(2,))
        self.assertRegex(done.stderr, rf"^mvtp: {regex}\n$")
        self.assertEqual(done.stdout, "")
        self.assertEqual(files(), before)

    def test_a_run_is_not_overwritten_by_its_export(self):
        for name in "fcd.xml", "view.html":
            for form in "csv", "openscenario":
                self.refused(f".*{name}: is an input too .*", "run", "--to", form, "-o", self.path(f"run/{name}"))

    def test_no_roads_are_left_without_their_scenario(self):
        shutil.copytree(self.path("run"), self.path("odd\x01name"))
        scenario = self.path("roads.xosc")
        self.refused('"odd.name": has a control character, .*', "odd\x01name", "--to", "openscenario", "-o", scenario)
        self.refused("/dev/null: is no file that roads could go beside; .*", "run", "--to", "openscenario",
                     "-o", "/dev/null")
        self.refused("nowhere.net.xml: netconvert cannot .*", "run", "--to", "openscenario", "-o", scenario,
                     "--network", "nowhere.net.xml")

    def test_nobody_is_there(self):
        for form in ("commonroad", "openscenario"):
            for time in ("--begin", "16"), ("--begin", "9", "--end", "8"):
                self.refused(".*run: has no vehicle in that time; .*", "run", "--to", form,
                             "-o", self.path("nobody.xml"), *time)

    def test_a_folder_has_its_name_however_it_is_called(self):
        for name in "run", "run/", "run/.", "run/../run":
            root = ET.parse(self.export(name, "commonroad")).getroot()
            self.assertEqual((root.get("benchmarkID"), root.get("source")), ("ZAM_run-1_1_T-1", "run"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
