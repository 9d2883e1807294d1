#!/usr/bin/env python3
"""A controller of one's own at a junction of SUMO: one vehicle at a time, first come, first served.

SUMO's drivers drive; the controller says who has to wait at its line and who goes.
"""

import argparse
from pathlib import Path

import mvtp

SCENARIOS = Path(__file__).parents[3] / "scenarios"


class Fcfs(mvtp.Controller):
    def __init__(self, junction, reach=60.0):
        super().__init__()
        self.junction = junction
        self.reach = reach  # from where on a vehicle stands in the queue [m]
        self.queue = []  # ids, first come, first served
        self.road = None

    def decide(self):
        if self.road is None:
            self.road = self.traffic.network
            connections = self.road.junctions[self.junction].connections
            self.incoming = {c.from_lane for c in connections}
            self.inside = {lane for c in connections for lane in c.via}
        now = self.traffic.vehicles()
        for id, lane, position in zip(now.ids, now.lanes, now.lane_positions):
            near = lane in self.incoming and self.road.lanes[lane].length - position < self.reach
            if near and id not in self.queue:
                self.queue.append(id)
        crossing = {*self.incoming, *self.inside}
        where = dict(zip(now.ids, now.lanes))
        self.queue = [id for id in self.queue if where.get(id) in crossing]

    def act(self):
        for place, id in enumerate(self.queue):
            self.traffic.hold(id, place > 0)
            self.traffic.let_through(id, place == 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--end", type=float, default=300.0, help="simulated time [s]")
    options = parser.parse_args()
    scenario = SCENARIOS / "crossroads" / "crossroads.sumocfg"
    summary = mvtp.Simulation(scenario, controller=Fcfs("C"), end=options.end).run()
    print(
        f"{summary['controller']}: {summary['vehicles']} vehicles, "
        f"{summary['audit']['overlap_pairs']} pairs in contact, "
        f"mean delay {summary['delay_s']['mean']:.1f} s"
    )


if __name__ == "__main__":
    main()
