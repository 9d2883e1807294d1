#!/usr/bin/env python3
"""Draws cubes on their mat: cubes.py RUN.json REPORT.json -o cubes.svg

RUN is of mvtp toio export, REPORT of mvtp toio emulate RUN --report REPORT. The tracks are the true
ones; the cubes stand where they were at half of the time, and their goals are outlined.
"""

import argparse
import json
import math
import pathlib

from drawing import BLUE, GREEN, ORANGE, PURPLE, Sheet

SCALE = 2.2  # pixels per mm
EDGE = 12    # around the mat
CUBE = 32    # mm
TO_MIDDLE = -3.8  # mm from the axle to the middle of the body


def mat_of(run):
    """Width and height of the mat [mm]."""
    low_x, low_y, high_x, high_y = run["mat"]["range"]
    return [(high - low) * run["mat"]["mm_per_dot"] for low, high in ((low_x, high_x), (low_y, high_y))]


def draw(run, tracks):
    width, height = mat_of(run)
    sheet = Sheet(round(width * SCALE + 2 * EDGE), round(height * SCALE + 2 * EDGE), "Cubes on their mat")
    sheet.rect(EDGE, EDGE, width * SCALE, height * SCALE, "#fbf7ea", "#b9b29a")

    def place(pose):
        x = pose[0] + TO_MIDDLE * math.cos(pose[2])
        y = pose[1] + TO_MIDDLE * math.sin(pose[2])
        return EDGE + x * SCALE, EDGE + (height - y) * SCALE

    for track, color in zip(tracks, (BLUE, ORANGE, GREEN, PURPLE)):
        sheet.polyline([place(pose) for pose in track], color, 2, opacity=0.6)
        size = CUBE * SCALE
        for pose, opacity in ((track[-1], 0.2), (track[len(track) // 2], 1.0)):
            x, y = place(pose)
            sheet.car(x, y, -math.degrees(pose[2]), color, size, size, opacity=opacity)
    return sheet.svg()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", type=pathlib.Path)
    parser.add_argument("report", type=pathlib.Path)
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path)
    options = parser.parse_args()
    run, report = (json.loads(path.read_text(encoding="utf-8")) for path in (options.run, options.report))
    tracks = [robot["track_mm"] for robot in report[0]["robots"]]
    options.output.write_text(draw(run, tracks), encoding="utf-8")


if __name__ == "__main__":
    main()
