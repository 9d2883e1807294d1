#!/usr/bin/env python3
"""Looks for overlapping vehicles in a run's fcd.xml, at the steps and between them.

    check_fcd.py RUN/fcd.xml -c X.sumocfg [--vehicles RUN/vehicles.csv] [--json]

A second opinion on summary.json: nothing here is shared with the audit of mvtp. Every pair that
comes near is sampled densely (--sampling, in seconds) between two steps, each vehicle turning about
the one point that carries its first pose into the second. Lengths and widths are those of the
vehicle types in the scenario's files; SUMO writes the middle of the front bumper and the heading.
A vehicle that leaps (sideways by more than 1 m, or along by 1 m more than its speed explains) is
looked at at the step only.

Exit codes: 0 no overlap (with --coordinated: with a coordinated vehicle), 1 overlaps, 2 bad input.
"""

import argparse
import cmath
import csv
import json
import math
import os
import sys
import xml.etree.ElementTree as ET

# Length and width of SUMO 1.15's vehicle classes [m]; everything else is as a passenger car.
CLASS_SIZES = {
    "passenger": (5.0, 1.8), "private": (5.0, 1.8), "taxi": (5.0, 1.8), "hov": (5.0, 1.8),
    "evehicle": (5.0, 1.8), "vip": (5.0, 1.8), "army": (5.0, 1.8), "authority": (5.0, 1.8),
    "custom1": (5.0, 1.8), "custom2": (5.0, 1.8), "ignoring": (5.0, 1.8),
    "pedestrian": (0.215, 0.478), "bicycle": (1.6, 0.65), "moped": (2.1, 0.8),
    "motorcycle": (2.2, 0.9), "truck": (7.1, 2.4), "trailer": (16.5, 2.55), "bus": (12.0, 2.5),
    "coach": (14.0, 2.6), "delivery": (6.5, 2.16), "emergency": (6.5, 2.16), "tram": (22.0, 2.4),
    "rail_urban": (109.5, 3.0), "rail": (135.0, 2.84), "rail_electric": (200.0, 2.95),
    "rail_fast": (200.0, 2.95), "ship": (17.0, 4.0),
}
TOLERANCE = 1e-3  # [m] of overlap that counts, beside what the digits of the file leave open


class BadInput(Exception):
    pass


def configured_files(config):
    """The route and additional files that a sumocfg names."""
    try:
        root = ET.parse(config).getroot()
    except (OSError, ET.ParseError) as error:
        raise BadInput(f"{config}: {error}") from error
    folder = os.path.dirname(config)
    names = []
    for element in root.iter():
        if element.tag in ("route-files", "additional-files", "r", "a", "route", "additional"):
            names += [n.strip() for n in (element.get("value") or element.get("v") or "").split(",")]
    return [os.path.join(folder, n) for n in names if n]


def read_sizes(files):
    """Length and width [m] by vehicle type."""
    sizes = {"DEFAULT_VEHTYPE": CLASS_SIZES["passenger"], "DEFAULT_BIKETYPE": CLASS_SIZES["bicycle"],
             "DEFAULT_TAXITYPE": CLASS_SIZES["passenger"]}
    for name in files:
        if name.endswith(".gz") or not os.path.exists(name):
            continue
        for _, element in ET.iterparse(name):
            if element.tag == "vType":
                base = CLASS_SIZES.get(element.get("vClass", "passenger"), CLASS_SIZES["passenger"])
                sizes[element.get("id")] = (float(element.get("length", base[0])),
                                            float(element.get("width", base[1])))
            if element.tag in ("vehicle", "trip", "flow"):
                element.clear()
    return sizes


def steps(path):
    """Yields (time, {id: (front bumper, heading, speed, type)}, digits behind the point)."""
    digits = 2
    for _, element in ET.iterparse(path):
        if element.tag != "timestep":
            continue
        vehicles = {}
        for v in element.iter("vehicle"):
            x, y = v.get("x"), v.get("y")
            digits = len(x.partition(".")[2])
            heading = cmath.exp(1j * math.radians(90.0 - float(v.get("angle"))))
            vehicles[v.get("id")] = (complex(float(x), float(y)), heading, float(v.get("speed")),
                                     v.get("type"))
        yield float(element.get("time")), vehicles, digits
        element.clear()


class Motion:
    """One vehicle during one step: it turns about a fixed centre, or goes straight."""

    def __init__(self, before, now, size):
        self.length, self.width = size
        self.start, self.start_heading = before
        self.end, self.end_heading = now
        self.turn = cmath.phase(self.end_heading / self.start_heading)
        self.centre = None
        if abs(self.turn) > 1e-7:
            full = self.end_heading / self.start_heading
            self.centre = (self.end - full * self.start) / (1.0 - full)
        middle_before = self.start - self.start_heading * self.length / 2
        middle_now = self.end - self.end_heading * self.length / 2
        # Middle half way, and a circle that holds every point of the body during the step.
        self.middle = (middle_before + middle_now) / 2
        self.radius = (math.hypot(self.length, self.width) / 2 + abs(middle_now - middle_before)
                       + abs(self.turn) * self.length / 2)

    def at(self, share):
        """Middle of the body and its heading."""
        part = cmath.exp(1j * self.turn * share)
        heading = self.start_heading * part
        if self.centre is None:
            front = self.start + (self.end - self.start) * share
        else:
            front = self.centre + (self.start - self.centre) * part
        return front - heading * self.length / 2, heading


def depth(a, size_a, b, size_b):
    """How deep two rectangles overlap [m]; negative or 0: not at all (a lower bound then)."""
    between = b[0] - a[0]
    alike = abs((a[1].conjugate() * b[1]).real)
    crossed = abs((a[1].conjugate() * b[1]).imag)
    least = math.inf
    for own, other, axis in ((size_a, size_b, a[1]), (size_b, size_a, b[1])):
        seen = between * axis.conjugate()
        reach = (own[0] + other[0] * alike + other[1] * crossed) / 2
        aside = (own[1] + other[1] * alike + other[0] * crossed) / 2
        least = min(least, reach - abs(seen.real), aside - abs(seen.imag))
    return least


def deepest(a, b, samples):
    """(depth, share of the step) at the deepest of the samples; 0 samples: at the step only."""
    size_a, size_b = (a.length, a.width), (b.length, b.width)

    def look(share):
        return depth(a.at(share), size_a, b.at(share), size_b), share

    if not samples:
        return look(1.0)
    best = max(look(k / samples) for k in range(samples + 1))
    # A short clip lies between two samples: close in on it.
    width = 1.0 / samples
    while best[0] > -0.2 and width > 1e-5:
        width /= 2
        best = max(best, look(max(0.0, best[1] - width)), look(min(1.0, best[1] + width)))
    return best


def leaps(before, now, dt):
    """A lane change within one step or a teleport: no motion that could be looked at."""
    turn = now[1] / before[1]
    motion = (now[0] - before[0]) / (before[1] * cmath.exp(0.5j * cmath.phase(turn)))
    return abs(motion.imag) > 1.0 or abs(motion.real) > max(before[2], now[2]) * dt + 1.0


def near_pairs(motions):
    """Pairs whose circles meet, found from west to east."""
    order = sorted(motions, key=lambda i: motions[i].middle.real - motions[i].radius)
    for n, i in enumerate(order):
        a = motions[i]
        for j in order[n + 1:]:
            b = motions[j]
            if b.middle.real - b.radius > a.middle.real + a.radius:
                break
            if abs(a.middle - b.middle) <= a.radius + b.radius:
                yield i, j


def check(fcd, sizes, sampling):
    """All overlapping pairs: {(id, id): [first time, deepest, time of that, steps]}."""
    pairs, unknown = {}, set()
    previous, last_time = {}, None
    for time, vehicles, digits in steps(fcd):
        dt = time - last_time if last_time is not None else 0.0
        samples = max(4, math.ceil(dt / sampling)) if dt > 0 else 0
        tolerance = TOLERANCE + 1.5 * 10.0 ** -digits
        motions, still = {}, set()
        for vehicle, (front, heading, speed, kind) in vehicles.items():
            size = sizes.get(kind) or sizes.get((kind or "").partition("@")[0])
            if size is None:
                unknown.add(kind)
                size = CLASS_SIZES["passenger"]
            before = previous.get(vehicle)
            now = (front, heading, speed)
            if before is None or leaps(before, now, dt):
                still.add(vehicle)
                before = now
            motions[vehicle] = Motion(before[:2], now[:2], size)
        for i, j in near_pairs(motions):
            between = 0 if i in still or j in still else samples
            found, share = deepest(motions[i], motions[j], between)
            if found <= tolerance:
                continue
            when = time - (1.0 - share) * dt
            entry = pairs.setdefault(tuple(sorted((i, j))), [when, found, when, 0])
            entry[3] += 1
            if found > entry[1]:
                entry[1:3] = [found, when]
        previous = {v: s[:3] for v, s in vehicles.items()}
        last_time = time
    return pairs, unknown


def coordinated_vehicles(path):
    with open(path, newline="", encoding="utf-8") as file:
        return {row["id"] for row in csv.DictReader(file) if row["coordinated"] == "1"}


def result(fcd, config, vehicles=None, sampling=0.002):
    """What the command prints with --json."""
    sizes = read_sizes(configured_files(config))
    ours = coordinated_vehicles(vehicles) if vehicles else set()
    try:
        pairs, unknown = check(fcd, sizes, sampling)
    except (OSError, ET.ParseError, TypeError, ValueError) as error:
        raise BadInput(f"{fcd}: {error}") from error
    listed = [{"pair": list(pair), "first_s": round(first, 3), "depth_m": round(deep, 4),
               "deepest_s": round(when, 3), "steps": count,
               "coordinated": pair[0] in ours or pair[1] in ours}
              for pair, (first, deep, when, count) in sorted(pairs.items(), key=lambda p: p[1][0])]
    return {"overlap_pairs": len(listed),
            "overlap_pairs_ever_coordinated": sum(p["coordinated"] for p in listed),
            "unknown_types": sorted(str(u) for u in unknown), "pairs": listed}


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("fcd", help="trajectories, SUMO's fcd.xml")
    parser.add_argument("-c", "--configuration", required=True, help="the scenario's *.sumocfg")
    parser.add_argument("--vehicles", help="the run's vehicles.csv: who was coordinated")
    parser.add_argument("--sampling", type=float, default=0.002, help="[s] (0.002)")
    parser.add_argument("--coordinated", action="store_true",
                        help="fail for pairs with a once coordinated vehicle only")
    parser.add_argument("--json", action="store_true", help="print JSON")
    options = parser.parse_args()
    try:
        found = result(options.fcd, options.configuration, options.vehicles, options.sampling)
    except BadInput as error:
        print(f"check_fcd.py: {error}", file=sys.stderr)
        return 2
    if options.json:
        print(json.dumps(found, indent=1))
    else:
        for p in found["pairs"]:
            print(f"{p['first_s']:10.3f} s  {' '.join(p['pair'])}: {p['depth_m']:.3f} m at "
                  f"{p['deepest_s']:.3f} s, {p['steps']} steps"
                  f"{', coordinated' if p['coordinated'] else ''}")
        print(f"{found['overlap_pairs']} pairs overlap, {found['overlap_pairs_ever_coordinated']} "
              "with a once coordinated vehicle")
    key = "overlap_pairs_ever_coordinated" if options.coordinated else "overlap_pairs"
    return 1 if found[key] else 0


if __name__ == "__main__":
    sys.exit(main())
