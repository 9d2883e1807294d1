"""Files of mvtp export against the published schemas of CommonRoad and OpenSCENARIO, as far as it writes them.

    schema_test.py MVTP SCENARIOS

The schemas are in no package, and have licences of their own: what follows from them is in the tables beside this file.
"""

import copy
import os
import shutil
import sys
import unittest
import xml.etree.ElementTree as ET

import commonroad_2020a
import openscenario_1_2
from export_case import SCENARIOS, Case, mvtp
from schema_check import Type, particles

SCHEMAS = {"commonroad": commonroad_2020a, "openscenario": openscenario_1_2}
ODD_NAME = "a<b>&'c'--d é"


class Exports(Case):
    """Adds to Case: exports as trees, with what was said on stderr."""

    def tree(self, source, form, *options):
        output = self.path(f"out.{form}")
        done = mvtp("export", self.path(source), "--to", form, "-o", output, *options)
        return ET.parse(output).getroot(), done.stderr

    def assert_valid(self, source, form, *options):
        root, said = self.tree(source, form, *options)
        self.assertEqual(SCHEMAS[form].faults_in(root), [])
        self.assertEqual(said, "")
        return root


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


class Plans(Exports):
    @classmethod
    def make(cls):
        write(cls.path("i.yaml"), "agents:\n"
              f'  - {{name: "{ODD_NAME}", start: [5, 5, 0], goal: [25, 5, 0]}}\n'
              "  - {name: b, start: [10, 16, 0], goal: [5, 16, 0]}\n"
              "map: {dimensions: [30, 20], obstacles: [[15, 15, 1]],\n"
              "      polygons: [[[20, 12], [22, 12], [22, 14]]]}\n")
        write(cls.path("one.yaml"), "schedule:\n  a:\n    - {x: 5, y: 5, yaw: 0, t: 0}\n")
        mvtp("solve", "-i", cls.path("i.yaml"), "-q", "-o", cls.path("p.yaml"))

    def test_with_and_without_their_map(self):
        for form in SCHEMAS:
            self.assert_valid("p.yaml", form)
            root = self.assert_valid("p.yaml", form, "-i", self.path("i.yaml"))
            self.assertEqual(len(root.findall("staticObstacle")), 2 if form == "commonroad" else 0)

    def test_of_one_robot_that_stays(self):
        for form in SCHEMAS:
            self.assert_valid("one.yaml", form, "--vehicle", "escot")

    def test_with_an_ego_vehicle(self):
        root = self.assert_valid("p.yaml", "commonroad", "--ego", ODD_NAME)
        self.assertEqual(len(root.findall("dynamicObstacle")), 1)

    def test_names_come_through(self):
        root = self.assert_valid("p.yaml", "openscenario")
        self.assertEqual([o.get("name") for o in root.iter("ScenarioObject")], [ODD_NAME, "b"])

    def test_every_slip_in_them_would_be_noticed(self):
        for form, options in ("commonroad", ("-i", self.path("i.yaml"))), ("openscenario", ()):
            schema = SCHEMAS[form]
            slipped = list(mutants(self.assert_valid("p.yaml", form, *options), schema.TYPES))
            self.assertGreater(len(slipped), 150)
            for what, mutant in slipped:
                self.assertNotEqual(schema.faults_in(mutant), [], f"{form}: {what}")


class Runs(Exports):
    """Forty seconds of crossroads with people; and the same where somebody was away for a while."""

    @classmethod
    def make(cls):
        mvtp("coordinate", "-c", os.path.join(SCENARIOS, "crossroads", "crossroads-people.sumocfg"),
             "--end", "40", "--quiet", "--output-dir", cls.path("run"), codes=(0, 1))
        fcd = ET.parse(cls.path("run/fcd.xml"))
        cls.steps = list(copy.deepcopy(fcd.getroot()))
        cls.ids = list(dict.fromkeys(id for step in cls.steps for id in vehicles_in(step)))
        shutil.copytree(cls.path("run"), cls.path("parked"))
        for step in fcd.getroot():
            for vehicle in step.findall(f"vehicle[@id='{cls.ids[0]}']"):
                if 20 <= float(step.get("time")) < 25:
                    step.remove(vehicle)
        fcd.write(cls.path("parked/fcd.xml"))

    def test_openscenario(self):
        root = self.assert_valid("run", "openscenario")
        self.assertEqual([o.get("name") for o in root.iter("ScenarioObject")], self.ids)

    def test_commonroad_breaks_one_rule_and_says_so(self):
        root, said = self.tree("run", "commonroad")
        faults = commonroad_2020a.faults_in(root)
        for fault in faults:
            self.assertRegex(fault, r'^commonRoad/dynamicObstacle/initialState/time/exact: is "\d+", not zero$')
        self.assertEqual(len(root.findall("dynamicObstacle")), len(self.ids))
        self.assertGreater(len(faults), 1)
        self.assertRegex(said, rf"^mvtp: export: {len(faults)} of {len(self.ids)} obstacles enter after time step 0, "
                               r"which CommonRoad's schema forbids .*; --obstacle-start-at-zero leaves them out\n$")

    def test_commonroad_of_those_who_are_there(self):
        root = self.assert_valid("run", "commonroad", "--obstacle-start-at-zero")
        self.assertEqual(len(root.findall("dynamicObstacle")), 1)
        root = self.assert_valid("run", "commonroad", "--obstacle-start-at-zero", "--begin", "30")
        there = next(step for step in self.steps if step.get("time") == "30.00").findall("vehicle")
        self.assertEqual(len(root.findall("dynamicObstacle")), len(there))

    def test_commonroad_with_each_vehicle_as_ego(self):
        for ego in self.ids:
            root = self.assert_valid("run", "commonroad", "--obstacle-start-at-zero", "--ego", ego)
            there = next(ids for ids in map(vehicles_in, self.steps) if ego in ids)
            self.assertEqual(len(root.findall("dynamicObstacle")), len(there) - 1)

    def test_who_was_away_is_several(self):
        again = self.ids[0] + "+2"
        root = self.assert_valid("parked", "openscenario")
        self.assertIn(again, [o.get("name") for o in root.iter("ScenarioObject")])
        root, _ = self.tree("parked", "commonroad")
        self.assertEqual(len(root.findall("dynamicObstacle")), len(self.ids) + 1)
        self.assert_valid("parked", "commonroad", "--obstacle-start-at-zero", "--ego", again)


def vehicles_in(step):
    return [vehicle.get("id") for vehicle in step.findall("vehicle")]


def mutants(root, types):
    """[(what is wrong, the document with it)], for one element of each type."""
    seen = set()

    def walk(element, kind):
        if kind in seen:
            return
        seen.add(kind)
        for what, slip in slips(element, kind, types):
            with_slip = copy.deepcopy(root)
            slip(list(with_slip.iter())[list(root.iter()).index(element)])
            yield f"{element.tag}: {what}", with_slip
        kinds = {name: of for name, of, _ in particles(types[kind].content)} if in_table(kind) else {}
        for child in element:
            yield from walk(child, kinds[child.tag])

    def in_table(kind):
        return isinstance(types.get(kind), Type)

    yield from walk(root, root.tag)


def slips(element, kind, types):
    """[(what, function that does it to an element)]"""
    yield "an attribute too many", lambda e: e.set("colour", "red")
    yield "a child too many", lambda e: ET.SubElement(e, "Colour")
    if not isinstance(types.get(kind), Type):
        if kind != "string":
            yield "another text", lambda e: setattr(e, "text", "?")
        return
    yield "a text", lambda e: setattr(e, "text", "?")
    for name, of in types[kind].attributes.items():
        if not name.endswith("?"):
            yield f"no {name}", lambda e, name=name: e.attrib.pop(name)
        if of != "string":
            yield f"another {name}", lambda e, name=name.rstrip("?"): e.set(name, "?")
    for i, child in enumerate(element):
        rest = [other.tag for other in element if other is not child]
        often = {name: times for name, _, times in particles(types[kind].content)}[child.tag]
        if often in ("", "+") and child.tag not in rest:
            yield f"no {child.tag}", lambda e, i=i: e.remove(e[i])
        if "&" not in types[kind].content and i > 0 and element[i - 1].tag != child.tag:
            yield f"{child.tag} too early", lambda e, i=i: e.insert(i - 1, pop(e, i))


def pop(element, i):
    child = element[i]
    element.remove(child)
    return child


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
