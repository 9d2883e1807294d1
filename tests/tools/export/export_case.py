"""What the tests of mvtp export share. Their arguments are MVTP, the program, and SCENARIOS, the folder."""

import os
import subprocess
import sys
import tempfile
import unittest

MVTP, SCENARIOS = sys.argv[1:3]
MILLIMETRE = 1e-3


def mvtp(*arguments, codes=(0,)):
    done = subprocess.run([MVTP, *arguments], capture_output=True, text=True, check=False)
    if done.returncode not in codes:
        raise AssertionError(f"{arguments}: exit {done.returncode}: {done.stderr}")
    return done


class Case(unittest.TestCase):
    folder = None

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = cls.temporary.name
        cls.make()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def export(cls, source, form, *options):
        output = cls.path(f"out.{form}")
        mvtp("export", cls.path(source), "--to", form, "-o", output, *options)
        return output

    def near(self, a, b, tolerance=MILLIMETRE):
        for first, second in zip(a, b, strict=True):
            self.assertAlmostEqual(first, second, delta=tolerance)
