"""Tests of tools/networks/check_fcd.py on trajectories with known overlaps."""

import cmath
import math
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)),
                                *[".."] * 3, "tools", "networks"))
import check_fcd  # noqa: E402

CAR = (5.0, 1.8)


class Folder:
    """A run's files: a scenario with one type, and trajectories."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory()
        self.write("types.add.xml", '<a><vType id="car" length="5" width="1.8"/>'
                   '<vType id="bus" vClass="bus"/></a>')
        self.write("x.sumocfg", '<configuration><input><additional-files value="types.add.xml"/>'
                   "</input></configuration>")

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def check(self, steps, coordinated=(), sampling=0.002):
        """steps: per 0.1 s a list of (id, type, x, y, angle, speed)."""
        text = "<fcd-export>"
        for k, vehicles in enumerate(steps):
            text += f'<timestep time="{0.1 * k:.2f}">'
            for name, kind, x, y, angle, speed in vehicles:
                text += (f'<vehicle id="{name}" type="{kind}" x="{x:.6f}" y="{y:.6f}" '
                         f'angle="{angle:.6f}" speed="{speed:.6f}"/>')
            text += "</timestep>"
        self.write("fcd.xml", text + "</fcd-export>")
        self.write("vehicles.csv", "id,coordinated\n" +
                   "".join(f"{c},1\n" for c in coordinated))
        return check_fcd.result(self.path("fcd.xml"), self.path("x.sumocfg"),
                                self.path("vehicles.csv"), sampling)


class CheckFcd(unittest.TestCase):
    def setUp(self):
        self.run_folder = Folder()
        self.addCleanup(self.run_folder.folder.cleanup)

    def check(self, *arguments, **named):
        return self.run_folder.check(*arguments, **named)

    def test_cars_in_line_do_not_overlap(self):
        found = self.check([[("a", "car", 0, 0, 90, 0), ("b", "car", 5.1, 0, 90, 0)]] * 3)
        self.assertEqual(found["overlap_pairs"], 0)

    def test_overlap_at_a_step(self):
        found = self.check([[("a", "car", 0, 0, 90, 0), ("b", "car", 4.8, 0, 90, 0)]] * 3, ["b"])
        self.assertEqual(found["overlap_pairs"], 1)
        self.assertEqual(found["overlap_pairs_ever_coordinated"], 1)
        self.assertAlmostEqual(found["pairs"][0]["depth_m"], 0.2, 4)
        self.assertEqual(found["pairs"][0]["steps"], 3)

    def test_corners_clipped_between_two_steps(self):
        # Two cars cross at 13.9 m/s; at both steps 0.505 m apart, half way 0.19 m inside each other.
        half = (5.0 + 1.8) / 2
        def at(t):
            return [("a", "car", half - 0.885 + 1.39 * t + 2.5, 0, 90, 13.9),
                    ("b", "car", 0, -(half + 0.505 - 1.39 * t) + 2.5, 0, 13.9)]
        self.assertEqual(self.check([at(0)])["overlap_pairs"], 0)
        self.assertEqual(self.check([at(1)])["overlap_pairs"], 0)
        found = self.check([at(0), at(1)])
        self.assertEqual(found["overlap_pairs"], 1)
        self.assertAlmostEqual(found["pairs"][0]["depth_m"], 0.19, 2)
        self.assertAlmostEqual(found["pairs"][0]["deepest_s"], 0.05, 2)

    def test_a_clip_shorter_than_the_sampling(self):
        half = (5.0 + 1.8) / 2
        def at(t):
            return [("a", "car", half - 0.524 + 1.39 * t + 2.5, 0, 90, 13.9),
                    ("b", "car", 0, -(half + 0.504 - 1.39 * t) + 2.5, 0, 13.9)]
        found = self.check([at(0), at(1)], sampling=0.1)
        self.assertEqual(found["overlap_pairs"], 1)
        self.assertAlmostEqual(found["pairs"][0]["depth_m"], 0.01, 3)

    def test_a_lane_change_within_a_step_is_no_motion(self):
        steps = [[("a", "car", 0, -3.2, 90, 10), ("b", "car", 1, 0, 90, 10)],
                 [("a", "car", 1, 3.2, 90, 10), ("b", "car", 2, 0, 90, 10)]]
        self.assertEqual(self.check(steps)["overlap_pairs"], 0)

    def test_a_bus_is_as_large_as_its_class(self):
        found = self.check([[("a", "bus", 20, 0, 90, 0), ("b", "car", 8.5, 0, 90, 0)]])
        self.assertEqual(found["overlap_pairs"], 1)
        self.assertAlmostEqual(found["pairs"][0]["depth_m"], 0.5, 4)

    def test_truncated_file_is_bad_input(self):
        self.run_folder.write("fcd.xml", "<fcd-export><timestep")
        with self.assertRaises(check_fcd.BadInput):
            check_fcd.result(self.run_folder.path("fcd.xml"), self.run_folder.path("x.sumocfg"))


class Motion(unittest.TestCase):
    def test_ends_are_exact_and_the_path_is_an_arc(self):
        before = (3 + 4j, cmath.exp(0.3j))
        centre = 3 + 4j + cmath.exp(0.3j) * 10j
        turn = cmath.exp(0.2j)
        now = (centre + (before[0] - centre) * turn, before[1] * turn)
        motion = check_fcd.Motion(before, now, CAR)
        for share in (0.0, 0.3, 1.0):
            middle, heading = motion.at(share)
            front = middle + heading * 2.5
            self.assertAlmostEqual(abs(front - centre), 10.0, 9)
            self.assertAlmostEqual(cmath.phase(heading), 0.3 + 0.2 * share, 9)

    def test_depth_of_turned_boxes(self):
        # A corner points at a side: diagonal half length against half width.
        a = (0j, 1 + 0j)
        reach = (5.0 + 1.8) / 2 / math.sqrt(2)
        b = (complex(0, 0.9 + reach - 0.05), cmath.exp(0.25j * math.pi))
        self.assertAlmostEqual(check_fcd.depth(a, CAR, b, CAR), 0.05, 9)


if __name__ == "__main__":
    unittest.main()
