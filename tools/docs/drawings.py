#!/usr/bin/env python3
"""Draws the concepts of the docs as SVG: drawings.py -o docs/drawings"""

import argparse
import pathlib

from drawing import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, RED, ROAD, Sheet


def crossroads(sheet, x, y, arm, half):
    """Two roads of two lanes that cross at (x, y): half a road is `half` wide."""
    sheet.rect(x - arm, y - half, 2 * arm, 2 * half, ROAD)
    sheet.rect(x - half, y - arm, 2 * half, 2 * arm, ROAD)
    for sign in (-1, 1):
        near, far = x + sign * half, x + sign * arm
        sheet.line(near, y, far, y, "#ffffff", 2, "10 8")
        sheet.line(x, y + sign * half, x, y + sign * arm, "#ffffff", 2, "10 8")


def stop_lines(sheet, x, y, half):
    for x0, y0, x1, y1 in ((-half, 0, -half, half), (half, -half, half, 0),
                           (-half, -half, 0, -half), (0, half, half, half)):
        sheet.line(x + x0, y + y0, x + x1, y + y1, INK, 4)


def draw_control_zone():
    sheet = Sheet(780, 460, "A control zone")
    crossroads(sheet, 300, 230, 300, 34)
    sheet.rect(110, 40, 380, 380, BLUE, opacity=0.10)
    sheet.path("M110 40 H490 V420 H110 Z", BLUE, 1.5, dash="6 5")
    sheet.rect(266, 196, 68, 68, PURPLE, opacity=0.18)
    stop_lines(sheet, 300, 230, 34)
    sheet.car(60, 247, 0, GREY)
    sheet.car(150, 247, 0)
    sheet.car(208, 247, 0)
    sheet.car(317, 300, -90)
    sheet.car(283, 120, 90)
    sheet.car(420, 213, 180, ORANGE, length=52)
    sheet.line(390, 192, 390, 234, RED, 4)
    sheet.car(550, 247, 0, GREY)
    sheet.text(62, 285, "takeover:", anchor="middle")
    sheet.text(62, 303, "80 m before the line", anchor="middle", size=12)
    sheet.arrow(82, 310, 110, 330, GREY)
    sheet.text(500, 285, "hand-back:")
    sheet.text(500, 303, "at most 60 m behind the junction", size=12)
    sheet.text(500, 110, "control zone", BLUE, weight="bold")
    sheet.text(500, 128, "junctions with less than 50 m", size=12)
    sheet.text(500, 144, "of road between them", size=12)
    sheet.text(396, 164, "gate: a bus too long for", RED, size=12)
    sheet.text(396, 179, "the turn waits, driven by SUMO", RED, size=12)
    sheet.text(344, 60, "stop line", size=12)
    sheet.arrow(342, 62, 290, 190, GREY)
    for i, (color, words) in enumerate(((BLUE, "under control: placed every step"),
                                        (ORANGE, "human-driven: predicted"),
                                        (GREY, "SUMO's driver, outside"))):
        sheet.car(525, 368 + 28 * i, 0, color)
        sheet.text(550, 373 + 28 * i, words, size=12)
    return sheet


def draw_corridor():
    sheet = Sheet(760, 400, "A corridor")
    sheet.rect(0, 250, 760, 104, ROAD)
    sheet.rect(430, 0, 104, 354, ROAD)
    for y in (276, 328):
        sheet.line(0, y, 430, y, "#ffffff", 1.5, "10 8")
    sheet.line(0, 302, 430, 302, "#ffffff", 3)
    sheet.line(482, 0, 482, 250, "#ffffff", 3)
    sheet.line(430, 302, 430, 354, INK, 4)
    swept = "M40 341 H150 C210 341 220 315 290 315 H420 C480 315 508 300 508 240 V40"
    sheet.path(swept, BLUE, 26, opacity=0.22)
    sheet.path(swept, BLUE, 2.5)
    sheet.car(60, 341)
    sheet.car(360, 315, 0, BLUE, opacity=0.55)
    sheet.car(494, 280, -55, BLUE, opacity=0.55)
    sheet.car(508, 70, -90, BLUE, opacity=0.55)
    for x, y, words, tx, ty in ((40, 341, "1  takeover", 20, 385), (205, 326, "2  lane change", 150, 385),
                                (430, 315, "3  stop line", 345, 385),
                                (500, 270, "4  turn, at the lateral limit", 560, 215),
                                (508, 40, "5  hand-back", 560, 45)):
        sheet.circle(x, y, 4, INK)
        sheet.text(tx, ty, words)
    sheet.text(20, 40, "corridor", BLUE, weight="bold", size=16)
    for i, words in enumerate(("the lanes of one route, from takeover to hand-back,",
                               "with the lane changes that it needs;",
                               "line: the path of the rear axle, smooth for this body;",
                               "band: the ground that the body sweeps.",
                               "A body that leaves its side of the road",
                               "or turns too tightly gets none.")):
        sheet.text(20, 66 + 20 * i, words, size=13)
    return sheet


def junction_view(sheet, x, title, good):
    """Two cars on crossing paths, each with the ground on which it comes to rest if it brakes now."""
    sheet.text(x, 36, title, GREEN if good else RED, "middle", 15, "bold")
    sheet.rect(x - 170, 170, 340, 44, ROAD)
    sheet.rect(x - 22, 60, 44, 264, ROAD)
    first, second = (x - 120, 286) if good else (x - 75, 236)
    stop_x = 80 if good else 95
    sheet.rect(first, 181, stop_x, 22, BLUE, BLUE, 0.25)
    sheet.car(first, 192, 0, BLUE)
    sheet.rect(x - 11, second - 60, 22, 60, PURPLE, PURPLE, 0.25)
    sheet.car(x, second, -90, PURPLE)
    if not good:
        sheet.circle(x, 192, 17, "none", RED)
        sheet.circle(x, 192, 20, "none", RED)
    sheet.text(x, 352, "both can still brake: kept" if good else "both brake, and touch: never taken",
               anchor="middle", size=13)


def draw_safety():
    sheet = Sheet(760, 400, "Safety: everyone brakes now")
    junction_view(sheet, 190, "safe", True)
    junction_view(sheet, 570, "not safe", False)
    sheet.line(380, 30, 380, 360, GREY, 1)
    sheet.text(380, 388, "shaded: the ground on which a vehicle comes to rest if it brakes fully now",
               GREY, "middle", 12)
    return sheet


def axes(sheet, x, y, width, height, across, up):
    sheet.arrow(x, y, x + width, y)
    sheet.arrow(x, y, x, y - height)
    sheet.text(x + width, y + 20, across, anchor="end", size=13)
    sheet.text(x + 8, y - height + 4, up, size=13)


def draw_liveness():
    sheet = Sheet(760, 400, "Liveness: always part of a complete plan")
    axes(sheet, 60, 340, 660, 310, "time [s]", "place on its path")
    sheet.line(60, 80, 720, 80, GREEN, 1.5, "6 5")
    sheet.text(716, 72, "end of the corridor", GREEN, "end", 13)
    sheet.rect(60, 170, 660, 60, PURPLE, opacity=0.10)
    sheet.text(716, 222, "ground shared with others", PURPLE, "end", 12)
    for i in range(4):
        x = 140 + 90 * i
        sheet.line(x, 334, x, 346, INK)
        sheet.text(x, 362, f"{0.5 * (i + 1):.1f}", anchor="middle", size=12)
    sheet.text(275, 382, "decisions, every half second", anchor="middle", size=12)
    sheet.path("M60 320 C140 280 180 262 260 258 S430 250 480 200 S560 100 600 80", GREY, 2.5,
               dash="7 5")
    sheet.text(606, 104, "the plan so far", GREY, size=13)
    sheet.path("M60 320 C140 280 190 255 230 240", BLUE, 4)
    sheet.path("M230 240 C300 205 360 130 420 80", BLUE, 3)
    sheet.text(300, 128, "complete and cheaper:", BLUE, "end", 13)
    sheet.text(300, 146, "takes its place", BLUE, "end", 13)
    sheet.path("M230 240 C280 210 310 202 340 201 H640", RED, 2.5, dash="3 4")
    sheet.text(646, 190, "ends inside: refused", RED, "end", 13)
    sheet.circle(230, 240, 5, BLUE, BLUE)
    sheet.text(238, 262, "now", BLUE, size=13)
    return sheet


def panel(sheet, x, y, number, title):
    sheet.rect(x, y, 360, 230, "#fafbfc", GREY)
    sheet.text(x + 12, y + 24, f"{number}  {title}", weight="bold")


def four_cars(sheet, x, y, opacity=1.0, apart=False):
    """Robots 1 and 2 that meet, 3 that drives alone, 4 that waits in 3's path."""
    colors = (GREEN, GREEN, BLUE, ORANGE) if apart else (BLUE,) * 4
    for (cx, cy, heading), color, name in zip(((60, 100, 0), (160, 180, -90), (60, 205, 0),
                                               (290, 205, 180)), colors, "1234"):
        sheet.car(x + cx, y + cy, heading, color, label=name, opacity=opacity)


def draw_escot():
    sheet = Sheet(760, 500, "ESCoT, one step")
    corners = ((10, 10), (390, 10), (10, 260), (390, 260))
    titles = ("reference paths", "GroupRobots: who may conflict soon",
              "GetOptTraj: a group is planned together", "PBCR: all others, step by step")
    for i, ((x, y), title) in enumerate(zip(corners, titles)):
        panel(sheet, x, y, i + 1, title)
    draw_reference_paths(sheet, *corners[0])
    draw_groups(sheet, *corners[1])
    draw_joint_plan(sheet, *corners[2])
    draw_pushing(sheet, *corners[3])
    return sheet


def draw_reference_paths(sheet, x, y):
    for data in (f"M{x + 60} {y + 100} H{x + 340}", f"M{x + 160} {y + 180} V{y + 45}",
                 f"M{x + 60} {y + 205} H{x + 340}"):
        sheet.path(data, GREY, 2, dash="5 5")
    four_cars(sheet, x, y)
    sheet.text(x + 186, y + 150, "each robot's shortest path,", size=12)
    sheet.text(x + 186, y + 166, "as if it were alone", size=12)


def draw_groups(sheet, x, y):
    sheet.path(f"M{x + 25} {y + 75} H{x + 185} V{y + 190} H{x + 135} V{y + 125} H{x + 25} Z", GREEN,
               2, GREEN + "22", "6 4")
    four_cars(sheet, x, y, apart=True)
    sheet.text(x + 196, y + 100, "the paths of 1 and 2", size=12)
    sheet.text(x + 196, y + 116, "meet soon: a group", size=12)


def draw_joint_plan(sheet, x, y):
    sheet.path(f"M{x + 60} {y + 100} H{x + 250}", GREEN, 3)
    sheet.path(f"M{x + 160} {y + 180} V{y + 140}", GREEN, 3)
    sheet.line(x + 142, y + 138, x + 178, y + 138, RED, 3)
    four_cars(sheet, x, y, apart=True)
    sheet.text(x + 190, y + 140, "ECCR: 1 first, 2 waits", size=12)
    sheet.text(x + 190, y + 156, "a step; conflicts are", size=12)
    sheet.text(x + 190, y + 172, "resolved in a tree", size=12)


def draw_pushing(sheet, x, y):
    four_cars(sheet, x, y, apart=True)
    sheet.arrow(x + 82, y + 205, x + 180, y + 205, BLUE, 2.5)
    sheet.path(f"M{x + 290} {y + 205} Q{x + 320} {y + 205} {x + 330} {y + 175}", ORANGE, 2.5,
               dash="4 3")
    sheet.text(x + 196, y + 100, "3 wants 4's place: 4", size=12)
    sheet.text(x + 196, y + 116, "inherits its priority", size=12)
    sheet.text(x + 196, y + 132, "and backs away; if not,", size=12)
    sheet.text(x + 196, y + 148, "3 tries its next motion", size=12)


def draw_tube():
    sheet = Sheet(760, 420, "A prediction tube")
    axes(sheet, 60, 350, 670, 320, "time", "place on the human driver's path")
    sheet.rect(60, 140, 660, 70, PURPLE, opacity=0.12)
    sheet.text(716, 132, "shared ground", PURPLE, "end", 12)
    earliest = "M60 320 C140 290 200 250 250 205 S340 90 370 50"
    latest = "M60 320 C200 300 320 280 400 240 C480 200 560 110 600 50"
    sheet.path(earliest + " L600 50 C560 110 480 200 400 240 C320 280 200 300 60 320 Z", "none", 0,
               ORANGE + "44")
    sheet.path(earliest, ORANGE, 2.5)
    sheet.path(latest, ORANGE, 2.5)
    sheet.text(236, 118, "earliest motion", ORANGE, "end", 13)
    sheet.text(590, 120, "latest motion", ORANGE, size=13)
    for x, width in ((120, 60), (600, 70)):
        sheet.rect(x, 140, width, 70, BLUE, BLUE, 0.45)
    sheet.arrow(180, 232, 240, 232, BLUE)
    sheet.text(140, 238, "1 s", BLUE, size=13)
    sheet.text(92, 262, "passes ahead of the tube", BLUE, size=13)
    sheet.arrow(556, 232, 600, 232, BLUE)
    sheet.text(606, 238, "0.5 s", BLUE, size=13)
    sheet.text(560, 262, "or behind it", BLUE, size=13)
    sheet.circle(60, 320, 5, ORANGE, ORANGE)
    sheet.text(70, 340, "seen now", ORANGE, size=13)
    sheet.text(390, 392, "the band: all places where the driver may be, at each time", GREY, "middle", 13)
    return sheet


DRAWINGS = {"control-zone": draw_control_zone, "corridor": draw_corridor, "safety": draw_safety,
            "liveness": draw_liveness, "escot": draw_escot, "tube": draw_tube}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output-dir", required=True, type=pathlib.Path)
    folder = parser.parse_args().output_dir
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in DRAWINGS.items():
        (folder / f"{name}.svg").write_text(draw().svg(), encoding="utf-8")


if __name__ == "__main__":
    main()
