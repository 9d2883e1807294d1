#!/usr/bin/env python3
"""A signal learns when to change: an environment as of Gymnasium, and Q-learning in a table.

Every five seconds the agent chooses which green the signal of the crossroads shows next. What it
sees: which green is shown, and on the lanes of which green most vehicles wait.
"""

import argparse
from pathlib import Path

import numpy as np

import mvtp

SCENARIOS = Path(__file__).parents[3] / "scenarios"


class Crossroads:
    """reset() and step() as Gymnasium's; SUMO runs in this process, one episode after the other."""

    yellow = 3.0  # [s]
    period = 5.0  # between two choices [s]

    def __init__(self, scenario, seconds):
        self.scenario = scenario
        self.seconds = seconds
        self.simulation = None

    def reset(self, seed):
        self.close()
        # None: SUMO's drivers drive, and we say between the steps what the signal shows.
        self.simulation = mvtp.Simulation(
            self.scenario, controller=None, seed=seed, end=self.seconds
        )
        traffic = self.simulation.traffic
        [self.signal] = traffic.network.signals
        phases = [phase.lights for phase in traffic.signal_phases(self.signal)]
        self.greens = [lights for lights in phases if "G" in lights and "y" not in lights]
        self.lanes = [self._lanes_of(lights, traffic.network) for lights in self.greens]
        self.shown = 0
        traffic.show(self.signal, self.greens[0])
        return self._look()

    def step(self, green):
        traffic = self.simulation.traffic
        goes_on = True
        if green != self.shown:
            now, then = self.greens[self.shown], self.greens[green]
            ending = ["y" if a in "Gg" and b not in "Gg" else a for a, b in zip(now, then)]
            traffic.show(self.signal, "".join(ending))
            goes_on = self.simulation.advance(self.yellow)
            traffic.show(self.signal, then)
            self.shown = green
        goes_on = goes_on and self.simulation.advance(self.period)
        state = self._look()
        return state, -float(self.waiting.sum()), not goes_on

    def close(self):
        return self.simulation.finish() if self.simulation else None

    def _look(self):
        now = self.simulation.vehicles()
        stands = [lane for lane, speed in zip(now.lanes, now.speeds) if speed < 1.0]
        self.waiting = np.array([sum(lane in lanes for lane in stands) for lanes in self.lanes])
        return self.shown, int(self.waiting.argmax())

    def _lanes_of(self, lights, network):
        connections = [c for j in network.junctions.values() for c in j.connections]
        ours = [c for c in connections if c.signal == self.signal]
        return {c.from_lane for c in ours if lights[c.signal_index] in "Gg"}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--episodes", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=600.0, help="of each episode, simulated")
    options = parser.parse_args()

    scenario = SCENARIOS / "crossroads" / "crossroads-400.static.sumocfg"
    environment = Crossroads(scenario, options.seconds)
    random = np.random.default_rng(0)
    values = {}  # of each choice, by state
    for episode in range(1, options.episodes + 1):
        state, total, ended = environment.reset(seed=episode), 0.0, False
        while not ended:
            value = values.setdefault(state, np.zeros(len(environment.greens)))
            explores = random.random() < 1.0 / episode
            action = int(random.integers(len(value)) if explores else value.argmax())
            after, reward, ended = environment.step(action)
            best = values.setdefault(after, np.zeros_like(value)).max()
            value[action] += 0.3 * (reward + 0.8 * best - value[action])
            state, total = after, total + reward
        delay = environment.close()["delay_s"]["mean"]
        print(f"episode {episode}: reward {total:.0f}, mean delay {delay:.1f} s")


if __name__ == "__main__":
    main()
