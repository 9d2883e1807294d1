#!/usr/bin/env python3
"""tools/results.sh in its short form: results_test.py ROOT PROGRAM WORK_FOLDER

Each product has its table; what was measured is not measured again; another build is refused.
"""

import csv
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

ROOT, PROGRAM, WORK = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])


PRODUCTS = ("Roads", "Roads, lateral acceleration at most 3 m/s²",
            "Roads, beyond what a light carries", "How coordinated vehicles drive", "Among human drivers",
            "Faults of V2X, declared and simulated", "Parking lots", "Benchmark maps", "Emulated cubes")


def measure(*arguments, program=PROGRAM):
    return subprocess.run([ROOT / "tools/results.sh", "--short", *arguments], check=False, text=True,
                          env=os.environ | {"MVTP": str(program)}, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)


class Results(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        cls.folder = WORK / "figures"
        cls.first = measure(cls.folder)
        assert cls.first.returncode == 0, cls.first.stderr

    def test_every_product_has_a_table_of_one_build(self):
        text = (self.folder / "results.md").read_text(encoding="utf-8")
        self.assertEqual(text.count("All by one build: mvtp "), 1)
        for heading in PRODUCTS:
            self.assertIn(f"\n## {heading}\n", text)
        for row in ("| crossroads | escot | 1 |", "| crossroads | static | 1 |", "| rilsa | escot | 1 |",
                    "| crossroads.static | escot | 0.5 | 1 |", "| crossroads | 3 m/s² | 1 |",
                    "| crossroads-800 | max-wave | 1 |", "| crossroads-400 | loss=0.3 | 1 |",
                    "| parking-120 | `escot` | 1 |", "| parking-120 | `pbcr` | 1 |", "| typical_", "| calm | 1 |",
                    "| cubes that stop, no release graph | 1 |"):
            self.assertIn(row, text)

    def test_every_figure_is_a_line_of_the_csv(self):
        with (self.folder / "results.csv").open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({row["product"] for row in rows},
                         set(PRODUCTS))
        delay = [row for row in rows if row["row"] == "crossroads escot" and row["figure"] == "delay [s]"]
        self.assertEqual(len(delay), 2)
        self.assertGreaterEqual(float(delay[0]["mean"]), 0.0)

    def test_goes_on_where_it_was_interrupted(self):
        before = (self.folder / "roads-crossroads.csv").stat().st_mtime_ns
        (self.folder / "done/cubes-calm").unlink()
        (self.folder / "done/maps-crowd").unlink()
        rows = (self.folder / "maps-crowd.csv").read_text(encoding="utf-8").splitlines(keepends=True)
        (self.folder / "maps-crowd.csv").write_text("".join(rows[:-1]), encoding="utf-8")
        again = measure(self.folder)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual([line for line in again.stderr.splitlines() if line.startswith("results: ")],
                         ["results: maps-crowd", "results: cubes-calm"])
        self.assertIn("bench: 1 of 1 runs", again.stderr)
        self.assertEqual((self.folder / "roads-crossroads.csv").stat().st_mtime_ns, before)

    def test_refuses_to_mix_builds(self):
        folder = WORK / "mixed"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "version").write_text("mvtp 0.1, commit 0000000\n", encoding="utf-8")
        outcome = measure(folder)
        self.assertEqual(outcome.returncode, 2)
        self.assertRegex(outcome.stderr, r"was begun by mvtp 0.1, commit 0000000, this is .*; choose another folder\n$")

    def test_measures_only_what_was_asked_for(self):
        outcome = measure("--only", "cubes", WORK / "cubes")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        text = (WORK / "cubes/results.md").read_text(encoding="utf-8")
        self.assertEqual([line for line in text.splitlines() if line.startswith("## ")], ["## Emulated cubes"])
        outcome = measure("--only", "cubes,moon", WORK / "moon")
        self.assertEqual((outcome.returncode, outcome.stderr),
                         (2, "results.sh: --only: moon: not one of roads, saturation, mixed, faults, lots, maps, cubes\n"))
        self.assertFalse((WORK / "moon").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
