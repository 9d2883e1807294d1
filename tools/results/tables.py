#!/usr/bin/env python3
"""The tables of what tools/results.sh has measured: tables.py FOLDER writes results.md and results.csv.

results.csv has one figure per line: product, row, figure, n, mean, sd (empty of a single run).
"""

import collections
import csv
import json
import pathlib
import re
import statistics
import sys


def numbers(rows, figure):
    return [float(row[figure]) for row in rows if row.get(figure)]


class Table:
    """Rows of (label, {heading: (values, how they become one cell)})."""

    def __init__(self, product, labels):
        self.product, self.labels, self.rows = product, labels, []

    def add(self, label, runs, cells):
        self.rows.append((label, len(runs), dict(cells)))

    def headings(self):
        """Those with values in some row."""
        found = dict.fromkeys(h for _, _, cells in self.rows for h in cells)
        return [h for h in found if any(cells.get(h, ([],))[0] for _, _, cells in self.rows)]

    def markdown(self):
        headings = self.headings()
        lines = [f"## {self.product}", "", "| " + " | ".join([*self.labels, "n", *headings]) + " |",
                 "|" + "---|" * (len(self.labels) + 1 + len(headings))]
        for label, n, cells in self.rows:
            shown = [cells[h][1](cells[h][0]) if h in cells and cells[h][0] else "-" for h in headings]
            lines.append("| " + " | ".join([*label, str(n), *shown]) + " |")
        return "\n".join(lines) + "\n"

    def records(self):
        for label, _, cells in self.rows:
            for heading, (values, _) in cells.items():
                if not values:
                    continue
                sd = statistics.stdev(values) if len(values) > 1 else ""
                yield [self.product, " ".join(label), heading, len(values), statistics.fmean(values), sd]


def spread(digits):
    def cell(values):
        sd = f" ± {statistics.stdev(values):.{digits}f}" if len(values) > 1 else ""
        return f"{statistics.fmean(values):.{digits}f}{sd}"
    return cell


def mean(digits):
    return lambda values: f"{statistics.fmean(values):.{digits}f}"


def most(digits):
    return lambda values: f"{max(values):.{digits}f}"


def least(digits):
    return lambda values: f"{min(values):.{digits}f}"


def total(values):
    return f"{sum(values):.0f}"


def read_all(folder, *patterns):
    """The rows of each file, by its stem; those of another pattern come after those of the first."""
    for path in (path for pattern in patterns for path in sorted(folder.glob(pattern))):
        with path.open(newline="", encoding="utf-8") as file:
            yield path.stem, list(csv.DictReader(file))


def grouped(rows, key):
    groups = collections.defaultdict(list)
    for row in rows:
        groups[key(row)].append(row)
    return groups


def by(rows, *columns):
    """((value of each column), the rows that have these) in the order of the first."""
    return grouped(rows, lambda row: tuple(row[column] for column in columns)).items()


def audit_cells(rows):
    return [("overlaps of CAVs", (numbers(rows, "overlap_pairs_coordinated"), total)),
            ("off-road steps of CAVs", (numbers(rows, "off_road_steps_coordinated"), total)),
            ("replan p95 [ms]", (numbers(rows, "replan_p95_ms"), mean(1))),
            ("x real time", (numbers(rows, "real_time_factor"), mean(0)))]


def delay_cells(runs):
    return [("delay [s]", (numbers(runs, "delay_mean_s"), spread(2))),
            ("p95 [s]", (numbers(runs, "delay_p95_s"), mean(1))),
            ("veh/h", (numbers(runs, "throughput_veh_h"), mean(0))),
            ("arrived", (numbers(runs, "completed"), total)),
            ("of", (numbers(runs, "vehicles"), total))]


def motion_cells(runs):
    """How the vehicles drove that were under control."""
    return [("accel [m/s²]", (numbers(runs, "max_accel"), most(2))),
            ("decel [m/s²]", (numbers(runs, "max_decel"), most(2))),
            ("lateral [m/s²]", (numbers(runs, "max_lateral_accel"), most(1))),
            ("curvature × R", (numbers(runs, "max_curvature_ratio"), most(2))),
            ("jump [m]", (numbers(runs, "max_jump_m"), most(3))),
            ("hard braking after", (numbers(runs, "hard_brakings_after_handback"), total))]


def effect_cells(runs):
    """What traffic costs those in it and beside it."""
    return [("stops", (numbers(runs, "stops_per_vehicle"), mean(2))),
            ("CO2 [g]", (numbers(runs, "co2_g"), mean(0))),
            ("PET < 1 s", (numbers(runs, "pet_below_1s"), mean(0)))]


def road_rows(folder, *patterns):
    return [{**row, "scenario": row["scenario"].removesuffix(".sumocfg")}
            for _, rows in read_all(folder, *patterns) for row in rows]


def road_table(folder, product, *patterns):
    table = Table(product, ["scenario", "controller"])
    for _, rows in by(road_rows(folder, *patterns), "scenario"):  # whatever file they are in
        for label, runs in by(rows, "scenario", "controller"):
            table.add(label, runs, [*delay_cells(runs), *effect_cells(runs), *audit_cells(runs)])
    return table


def motion_table(folder):
    table = Table("How coordinated vehicles drive", ["scenario", "limit in bends"])
    for limit, pattern in (("lanes'", "roads-*.csv"), ("3 m/s²", "lateral-*.csv")):
        for (scenario, controller), runs in by(road_rows(folder, pattern), "scenario", "controller"):
            if controller == "escot":
                table.add([scenario, limit], runs, motion_cells(runs))
    return table


def mixed_table(folder):
    table = Table("Among human drivers", ["scenario", "controller", "penetration"])
    for label, runs in by(road_rows(folder, "mixed-*.csv"), "scenario", "controller", "penetration"):
        table.add(label, runs, [
            *delay_cells(runs),
            ("automated [s]", (numbers(runs, "delay_controlled_s"), mean(2))),
            ("human [s]", (numbers(runs, "delay_human_s"), mean(2))),
            ("people wait [s]", (numbers(runs, "people_wait_s"), mean(1))),
            ("people touched", (numbers(runs, "people_touched"), total)), *audit_cells(runs)])
    return table


def fault_table(folder):
    table = Table("Faults of V2X, declared and simulated", ["scenario", "faults"])
    for name, runs in read_all(folder, "faults@*.csv"):
        table.add(name.split("@")[1:], runs, [
            *delay_cells(runs), ("least clearance [m]", (numbers(runs, "min_clearance_m"), least(2))),
            ("jerk [m/s³]", (numbers(runs, "jerk_m_s3"), mean(2))), *audit_cells(runs)])
    return table


def lot_table(folder):
    table = Table("Parking lots", ["scenario", "controller"])
    runs = [{**row, "scenario": re.sub(r"^lots-(.*)-\d+$", r"\1", name)}
            for name, rows in read_all(folder, "lots-*.csv") for row in rows]
    for (scenario, control), group in by(runs, "scenario", "control"):
        table.add([scenario, f"`{control}`"], group, [
            ("gate to parked [s]", (numbers(group, "gate_to_parked_mean_s"), spread(1))),
            ("alone [s]", (numbers(group, "gate_to_parked_alone_s"), mean(1))),
            ("slot to exit [s]", (numbers(group, "slot_to_exit_mean_s"), spread(1))),
            ("alone, out [s]", (numbers(group, "slot_to_exit_alone_s"), mean(1))),
            ("longest queue", (numbers(group, "at_gate_max"), most(0))), *audit_cells(group)])
    return table


def cell_of(instance):
    return re.sub(r"_ex\d+$", "", pathlib.Path(instance).stem)


def map_table(folder):
    table = Table("Benchmark maps", ["instances", "algorithm"])
    for _, rows in read_all(folder, "maps-*.csv"):
        for (cell, algorithm), runs in grouped(rows, lambda r: (cell_of(r["instance"]), r["algorithm"])).items():
            valid = [run for run in runs if run["valid"] == "true"]
            ratios = [float(r["makespan_s"]) / float(r["lower_bound_s"]) for r in valid]
            table.add([cell, algorithm], runs, [
                ("valid", ([float(run["valid"] == "true") for run in runs], total)),
                ("makespan [steps]", (numbers(valid, "makespan_steps"), mean(1))),
                ("makespan / bound", (ratios, mean(3))),
                ("first plan, slowest [s]", (numbers(valid, "first_solution_s"), most(2))),
                ("run, slowest [s]", (numbers(valid, "runtime_s"), most(2))),
                ("memory [MB]", (numbers(runs, "peak_rss_mb"), most(0)))])
    return table


def cube_table(folder):
    table = Table("Emulated cubes", ["runs"])
    for path in sorted(folder.glob("cubes-*.json")):
        runs = json.loads(path.read_text(encoding="utf-8"))
        beside = [max(robot["lateral_mm"] for robot in run["robots"]) for run in runs]
        label = path.stem.removeprefix("cubes-").replace("stalls", "cubes that stop")
        label = label.replace("-ungated", ", no release graph")
        table.add([label], runs, [
            ("touching", ([float(bool(run["touching"])) for run in runs], total)),
            ("all arrived", ([float(run["finished"]) for run in runs], total)),
            ("duration [s]", ([run["duration_s"] for run in runs], mean(2))),
            ("beside the path [mm]", (beside, most(1)))])
    return table


def main():
    folder = pathlib.Path(sys.argv[1])
    tables = [road_table(folder, "Roads", "roads-*.csv", "rivals-*.csv"),
              road_table(folder, "Roads, lateral acceleration at most 3 m/s²", "lateral-*.csv"),
              road_table(folder, "Roads, beyond what a light carries", "saturation-*.csv"),
              motion_table(folder), mixed_table(folder), fault_table(folder), lot_table(folder), map_table(folder), cube_table(folder)]
    version = (folder / "version").read_text(encoding="utf-8").strip()
    text = f"# Figures\nAll by one build: {version}. `tools/results.sh` measured them; n runs each, ± one standard deviation.\n"
    (folder / "results.md").write_text("\n".join([text, *(t.markdown() for t in tables if t.rows)]), encoding="utf-8")
    with (folder / "results.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["product", "row", "figure", "n", "mean", "sd"])
        for table in tables:
            writer.writerows(table.records())
    print(folder / "results.md")


if __name__ == "__main__":
    main()
