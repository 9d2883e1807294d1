"""The verdict over one run: one row of the table, with the reasons why it does not pass.

check_fcd.py gives a second opinion on the overlaps.
"""

import csv
import json
import os
import xml.etree.ElementTree as ET

import check_fcd

MEMORY_LIMIT = 1000  # [MB] that a run may take to pass
JUMP_LIMIT = 0.05  # [m] of a vehicle at its takeover or hand-back
GRIDLOCK = "gridlock:"
NO_CONFLICTS = "no junction with conflicting"  # what mvtp says of a road without crossings
LATE_SHARE = 0.1  # of the vehicles that should have arrived and have not (3 at least): gridlock

COLUMNS = ["network", "verdict", "reasons", "exit", "status", "vehicles", "completed", "late",
           "late_own", "delay_s", "overlaps_coordinated", "overlaps_all", "checker_pairs",
           "checker_coordinated", "off_road_coordinated", "people_touched", "max_jump_m",
           "accel_violations", "max_lateral_accel", "hard_brakings", "replan_p95_ms",
           "real_time_factor", "outside_loop_s", "wall_s", "memory_mb", "message"]


def time_of(configuration):
    """Begin and end of a scenario [s]; an end of None: none given."""
    begin, end = 0.0, None
    for element in ET.parse(configuration).getroot().iter():
        value = element.get("value") or element.get("v")
        if element.tag in ("begin", "b") and value:
            begin = float(value)
        if element.tag in ("end", "e") and value:
            end = float(value)
    return begin, end if end is not None and end > begin else None


def no_demand(path):
    with open(path, newline="", encoding="utf-8") as file:
        return next(csv.DictReader(file), None) is None


def late_vehicles(path, end):
    """(vehicles that have not arrived long after they should have, vehicles that should have)."""
    late = due = 0
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            # Twice the free flow and a minute is what a signal may cost.
            if float(row["intended_departure_s"]) + 2 * float(row["free_flow_s"]) + 60 > end:
                continue
            due += 1
            late += row["arrival_s"] == ""
    return late, due


def judge(scenario, folder, measured):
    row = dict.fromkeys(COLUMNS, "")
    row |= {"network": scenario.name, "exit": measured["exit"], "message": measured["message"],
            "wall_s": round(measured["wall"], 1), "memory_mb": round(measured["memory"])}
    reasons = []
    summary = read_summary(os.path.join(folder, "summary.json"))
    if measured["timeout"]:
        reasons.append("timeout")
    elif summary is None:
        name = f"signal {-measured['exit']}" if measured["exit"] < 0 else f"exit {measured['exit']}"
        reasons.append(f"no result ({name})")
    if measured["memory"] > MEMORY_LIMIT:
        reasons.append(f"{measured['memory']:.0f} MB")
    if summary:
        end = time_of(scenario.configuration)[0] + summary["simulated_s"]
        reasons += judge_summary(row, summary, folder, end)
        reasons += second_opinion(row, scenario, folder)
    row["verdict"] = "fail" if reasons else "pass"
    row["reasons"] = "; ".join(reasons)
    if NO_CONFLICTS in measured["message"]:
        row |= {"verdict": "not run", "reasons": "nothing to coordinate: no conflicts"}
    elif summary and no_demand(os.path.join(folder, "vehicles.csv")):
        row |= {"verdict": "not run", "reasons": "nothing to coordinate: no vehicles"}
    return row


def excuse(row):
    """Takes the gridlock off the reasons: the scenario jams under SUMO's own control as well."""
    left = [r for r in row["reasons"].split("; ") if not r.startswith(GRIDLOCK)]
    row["reasons"] = "; ".join(left)
    row["verdict"] = "fail" if left else "pass"


def read_summary(path):
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError):
        return None


def judge_summary(row, summary, folder, end):
    audit = summary["audit"]
    row |= {"status": summary["status"], "vehicles": summary["vehicles"],
            "completed": summary["completed"], "delay_s": round(summary["delay_s"]["mean"], 2),
            "overlaps_coordinated": audit["overlap_pairs_coordinated"],
            "overlaps_all": audit["overlap_pairs"],
            "off_road_coordinated": audit["off_road_steps_coordinated"],
            "people_touched": audit.get("people_touched", 0),
            "max_jump_m": round(summary["max_jump_m"], 3),
            "accel_violations": summary["accel_violations"],
            "max_lateral_accel": round(summary["max_lateral_accel"], 2),
            "hard_brakings": summary["hard_brakings_after_handback"],
            "replan_p95_ms": round(summary["replan_ms"]["p95"], 1),
            "real_time_factor": round(summary["real_time_factor"], 1)}
    if summary["real_time_factor"] > 0:
        in_loop = summary["simulated_s"] / summary["real_time_factor"]
        row["outside_loop_s"] = round(max(0.0, row["wall_s"] - in_loop), 1)
    reasons = []
    if summary["status"] not in ("finished", "end reached"):
        reasons.append(f"status {summary['status']}")
    if summary["vehicles"] == 0:
        reasons.append("no vehicle departed")
    late, due = late_vehicles(os.path.join(folder, "vehicles.csv"), end)
    row["late"] = f"{late}/{due}"
    if late >= 3 and late > LATE_SHARE * due:
        reasons.append(f"{GRIDLOCK} {late} of {due} late")
    for key, what in (("overlaps_coordinated", "overlapping pairs with a coordinated vehicle"),
                      ("off_road_coordinated", "off-road steps of coordinated vehicles"),
                      ("people_touched", "people touched"),
                      ("accel_violations", "accelerations beyond the vehicle's"),
                      ("hard_brakings", "hard brakings after a hand-back")):
        if row[key]:
            reasons.append(f"{row[key]} {what}")
    if summary["max_jump_m"] > JUMP_LIMIT:
        reasons.append(f"a jump of {row['max_jump_m']} m")
    return reasons


def second_opinion(row, scenario, folder):
    """What check_fcd.py finds; a reason only if it sees overlaps that the audit does not."""
    fcd = os.path.join(folder, "fcd.xml")
    if not os.path.exists(fcd):
        return []
    try:
        found = check_fcd.result(fcd, scenario.configuration, os.path.join(folder, "vehicles.csv"))
    except check_fcd.BadInput as error:
        return [f"checker: {error}"]
    row["checker_pairs"] = found["overlap_pairs"]
    row["checker_coordinated"] = found["overlap_pairs_ever_coordinated"]
    with open(os.path.join(folder, "checker.json"), "w", encoding="utf-8") as file:
        json.dump(found, file, indent=1)
    # One of 2 mm or less may be on the other side of the tolerance there.
    deep = sum(p["depth_m"] > 0.002 for p in found["pairs"])
    if deep > row["overlaps_all"]:
        return [f"checker sees {deep} overlapping pairs, the audit {row['overlaps_all']}"]
    return []
