"""The generated networks of the suite: what they are, and how SUMO's own tools make them.

Everything follows from this file, the seeds in it and the installed SUMO: no file is copied.
`NETWORKS` lists them; make(network, folder) writes the network, its demand and its *.sumocfg.
"""

import dataclasses
import math
import os
import random
import subprocess
import xml.etree.ElementTree as ET

SPEED = 13.89  # [m/s]

# Share of the traffic and body; lengths up to an articulated lorry of 18 m.
TYPES = {
    "car": (70, 'length="5" width="1.8"'),
    "van": (8, 'vClass="delivery" length="6.5" width="2.16"'),
    "motorcycle": (8, 'vClass="motorcycle" length="2.2" width="0.9"'),
    "bus": (6, 'vClass="bus" length="12" width="2.5" accel="1.2" decel="4"'),
    "truck": (5, 'vClass="truck" length="12" width="2.5" accel="1.3" decel="4"'),
    "lorry": (3, 'vClass="trailer" length="18" width="2.55" accel="1.1" decel="4"'),
}


@dataclasses.dataclass
class Network:
    name: str
    build: object                # writes network.net.xml into a folder
    per_hour: int = 1200         # [vehicles/h]
    types: tuple = ("car",)
    begin: int = 0               # [s]
    step: float | None = 0.1     # [s]; None: SUMO's default, 1 s
    attributes: str = 'departLane="best" departSpeed="max"'
    u_turns: float = 0.0         # share of the trips that go back to where they come from
    people: int = 0              # [people/h] who walk
    seed: int = 1
    duration: int = 300          # [s] of demand
    end: int = 900               # [s] after the begin
    options: str = ""            # further elements of the *.sumocfg


class GenerationFailed(Exception):
    pass


def run_tool(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = (done.stderr or done.stdout).strip().splitlines()
        raise GenerationFailed(f"{command[0]}: {lines[0] if lines else 'failed'}")


def netgenerate(*arguments):
    def build(folder):
        run_tool("netgenerate", *arguments, "--default.speed", SPEED, "--no-warnings",
                 "-o", os.path.join(folder, "network.net.xml"))
    return build


def grid(length, lanes, kind, size=3, extra=()):
    """Blocks of `length` [m], or (west-east, south-north)."""
    east, north = length if isinstance(length, tuple) else (length, length)
    return netgenerate("--grid", "--grid.x-number", size, "--grid.y-number", size,
                       "--grid.x-length", east, "--grid.y-length", north,
                       "--grid.attach-length", 150, "--default.lanenumber", lanes,
                       "--default-junction-type", kind, "--no-turnarounds", *extra)


class Plain:
    """Nodes and edges for netconvert."""

    def __init__(self, *options):
        self.options = options
        self.nodes, self.edges, self.connections = [], [], []

    def node(self, name, x, y, kind="priority"):
        self.nodes.append(f'<node id="{name}" x="{x:.3f}" y="{y:.3f}" type="{kind}"/>')

    def edge(self, start, end, lanes=1, speed=SPEED, priority=1, shape=()):
        points = " ".join(f"{x:.3f},{y:.3f}" for x, y in shape)
        bent = f' shape="{points}"' if points else ""
        self.edges.append(f'<edge id="{start}-{end}" from="{start}" to="{end}" numLanes="{lanes}" '
                          f'speed="{speed}" priority="{priority}"{bent}/>')

    def road(self, a, b, lanes=1, priority=1):
        self.edge(a, b, lanes, priority=priority)
        self.edge(b, a, lanes, priority=priority)

    def __call__(self, folder):
        command = ["netconvert", "--no-warnings", *self.options]
        for name, items in (("node", self.nodes), ("edge", self.edges),
                            ("connection", self.connections)):
            path = os.path.join(folder, f"{name}s.xml")
            write(path, f"<{name}s>\n  " + "\n  ".join(items) + f"\n</{name}s>\n")
            command += [f"--{name}-files", path]
        run_tool(*command, "-o", os.path.join(folder, "network.net.xml"))


def star(arms, kind, lanes=1, near=None, far=200.0, major=(), options=("--no-turnarounds",)):
    """One junction with arms at the angles `arms` [degrees]; near: length of the pieces that touch
    the junction, before the rest [m]. `major` arms have the right of way."""
    net = Plain(*options)
    net.node("C", 0, 0, kind)
    for k, angle in enumerate(arms):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        # A piece is measured from the edge of the junction, about 8 m from its middle.
        previous = "C"
        rank = 3 if k in major else 1
        if near:
            distance = near + 5.0 + 3.2 * lanes
            net.node(f"M{k}", distance * c, distance * s)
            net.road("C", f"M{k}", lanes, rank)
            previous = f"M{k}"
        net.node(f"A{k}", far * c, far * s)
        net.road(previous, f"A{k}", lanes, rank)
    return net


CROSS = (0, 90, 180, 270)
TEE = (0, 180, 270)
FIVE = (5, 75, 150, 220, 290)


def roundabout(radius, arms, lanes=1):
    net = Plain("--no-turnarounds", "--roundabouts.guess", "true")
    on_ring = lambda angle: (radius * math.cos(angle), radius * math.sin(angle))
    angles = [2 * math.pi * k / arms for k in range(arms)]
    for k, angle in enumerate(angles):
        net.node(f"R{k}", *on_ring(angle))
        net.node(f"A{k}", (radius + 180) * math.cos(angle), (radius + 180) * math.sin(angle))
        net.road(f"A{k}", f"R{k}", lanes)
        step = 2 * math.pi / arms
        net.edge(f"R{k}", f"R{(k + 1) % arms}", lanes, speed=8.33, priority=3,
                 shape=[on_ring(angle + step * i / 8) for i in range(9)])
    return net


def slip_lanes(lanes=1):
    """Four arms; who turns right leaves 45 m before the junction and passes beside it."""
    net = Plain("--no-turnarounds")
    net.node("C", 0, 0, "traffic_light")
    for k, angle in enumerate(CROSS):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        net.node(f"M{k}", 45 * c, 45 * s)
        net.node(f"A{k}", 220 * c, 220 * s)
        net.road("C", f"M{k}", lanes, 2)
        net.road(f"M{k}", f"A{k}", lanes, 2)
    for k in range(4):  # from arm k, inwards, to the right: arm k + 1
        net.edge(f"M{k}", f"M{(k + 1) % 4}", speed=8.33)
    return net


def motorway():
    """On-ramp, a lane to merge in, then an off-ramp."""
    net = Plain("--no-turnarounds")
    for name, x, y in (("A", 0, 0), ("B", 300, 0), ("C", 500, 0), ("D", 700, 0), ("E", 900, 0),
                       ("F", 1200, 0), ("R", 100, -80), ("S", 1100, -80)):
        net.node(name, x, y, "zipper" if name == "C" else "priority")
    net.edge("A", "B", 2, 22.2, 5)
    net.edge("R", "B", 1, 13.89, 1, [(100, -80), (220, -30), (300, -5)])
    net.edge("B", "C", 3, 22.2, 5)
    net.edge("C", "D", 2, 22.2, 5)
    net.edge("D", "E", 3, 22.2, 5)
    net.edge("E", "F", 2, 22.2, 5)
    net.edge("E", "S", 1, 13.89, 1, [(900, -5), (980, -30), (1100, -80)])
    return net


def staggered(gap, lanes):
    """Two T junctions `gap` [m] apart on a main road, side roads on opposite sides."""
    net = Plain("--no-turnarounds")
    for name, x, y in (("W", -200, 0), ("P", 0, 0), ("Q", gap, 0), ("E", gap + 200, 0),
                       ("N", 0, 180), ("S", gap, -180)):
        net.node(name, x, y)
    for a, b, rank in (("W", "P", 3), ("P", "Q", 3), ("Q", "E", 3), ("P", "N", 1), ("Q", "S", 1)):
        net.road(a, b, lanes, rank)
    return net


def spider(arms, circles, radius, extra=()):
    return netgenerate("--spider", "--spider.arm-number", arms, "--spider.circle-number", circles,
                       "--spider.space-radius", radius, "--no-turnarounds.except-deadend", *extra)


def random_net(seed, iterations, extra=()):
    return netgenerate("--rand", "--rand.iterations", iterations, "--seed", seed,
                       "--rand.min-distance", 60, "--rand.max-distance", 200,
                       "--no-turnarounds.except-deadend", *extra)


MIXED = tuple(TYPES)
WITH_BUSES = ("car", "bus")

NETWORKS = [
    Network("grid-40-1", grid(40, 1, "priority"), 700),
    Network("grid-40-2", grid(40, 2, "priority"), 1000),
    Network("grid-70-rbl", grid(70, 1, "right_before_left"), 900),
    Network("grid-100-2", grid(100, 2, "priority"), 1200),
    Network("grid-100-2-dense", grid(100, 2, "priority"), 2400),
    Network("grid-150-3-light", grid(150, 3, "traffic_light"), 1800),
    Network("grid-200-2-light", grid(200, 2, "traffic_light", size=4), 2000),
    Network("grid-300-3", grid(300, 3, "priority"), 1800),
    Network("grid-200-allway", grid(200, 1, "allway_stop"), 900),
    Network("grid-60x200", grid((60, 200), 2, "priority"), 1200, MIXED),
    Network("grid-100-left-hand", grid(100, 2, "priority", extra=("--lefthand",)), 1200),
    Network("spider-5", spider(5, 3, 80), 800),
    Network("spider-8-open", spider(8, 3, 100, ("--spider.omit-center", "--default.lanenumber", 2)),
            1200),
    Network("spider-6-small", spider(6, 2, 45), 500),
    Network("random-1", random_net(1, 30), 700),
    Network("random-2-lanes", random_net(2, 40, ("--random-lanenumber",)), 900),
    Network("random-3-lights", random_net(3, 60, ("--tls.guess", "--default.lanenumber", "2")), 1100,
            MIXED),
    Network("roundabout-14", roundabout(14, 4), 700, WITH_BUSES),
    Network("roundabout-20", roundabout(20, 4), 900, WITH_BUSES),
    Network("roundabout-32-2", roundabout(32, 5, 2), 1400, WITH_BUSES),
    Network("t-priority", star(TEE, "priority", major=(0, 1)), 900),
    Network("t-priority-stop", star(TEE, "priority_stop", major=(0, 1)), 800),
    Network("t-right-before-left", star(TEE, "right_before_left"), 800),
    Network("t-allway-stop", star(TEE, "allway_stop", 2), 1000),
    Network("t-light", star(TEE, "traffic_light", 2), 1200, MIXED),
    Network("five-priority", star(FIVE, "priority", 1, major=(0, 2)), 1000),
    Network("five-light", star(FIVE, "traffic_light", 2), 1800),
    Network("five-unregulated", star(FIVE, "unregulated"), 700),
    Network("slip-lanes", slip_lanes(), 1400),
    Network("arms-9", star(CROSS, "priority", near=9, major=(0, 2)), 900),
    Network("arms-20", star(CROSS, "traffic_light", 2, near=20), 1200),
    Network("arms-35", star(CROSS, "priority", near=35, major=(0, 2)), 1000, MIXED),
    Network("arms-60", star(CROSS, "right_before_left", 2, near=60), 1200),
    Network("staggered-25", staggered(25, 1), 900),
    Network("left-hand-cross", star(CROSS, "traffic_light", 2,
                                    options=("--no-turnarounds", "--lefthand")), 1600, MIXED),
    Network("u-turns", star(CROSS, "priority", 2, options=()), 1000, u_turns=0.3),
    Network("motorway", motorway(), 1800, MIXED),
    Network("mixed-cross", star(CROSS, "priority", 2, major=(0, 2)), 1600, MIXED),
    Network("depart-anywhere", grid(150, 2, "priority", size=2), 1000, MIXED,
            attributes='departLane="random" departPos="random" departSpeed="avg"'),
    Network("begin-28800", star(CROSS, "traffic_light", 2), 1600, begin=28800),
    Network("step-1", grid(150, 1, "priority", size=2), 900, step=None),
    Network("step-0.25", star(CROSS, "priority", 2, major=(0, 2)), 1400, step=0.25),
    Network("step-0.05", star(TEE, "priority", 1, major=(0, 1)), 900, step=0.05),
    Network("people", star(CROSS, "traffic_light", 1,
                           options=("--no-turnarounds", "--sidewalks.guess", "--crossings.guess")),
            900, people=300),
]


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def edges_for_trips(net_file):
    """(where trips start, where they end, where people walk): the fringe, else every edge."""
    root = ET.parse(net_file).getroot()
    edges = [e for e in root.findall("edge") if e.get("function") is None]
    drives = {e.get("id") for e in edges
              if any("pedestrian" != lane.get("allow") for lane in e.findall("lane"))}
    walks = [e.get("id") for e in edges
             if any("pedestrian" in (lane.get("allow") or "") for lane in e.findall("lane"))]
    into, out_of, ends = set(), set(), {}
    for edge in edges:
        ends[edge.get("id")] = (edge.get("from"), edge.get("to"))
    for c in root.findall("connection"):
        back = ends.get(c.get("from"), (0, 0)) == ends.get(c.get("to"), (1, 1))[::-1]
        if c.get("from") in drives and c.get("to") in drives and not back:
            out_of.add(c.get("from"))
            into.add(c.get("to"))
    starts = [e for e in sorted(drives) if e not in into and e in out_of]
    targets = [e for e in sorted(drives) if e not in out_of and e in into]
    if len(starts) < 2 or len(targets) < 2:
        starts = targets = sorted(drives & into & out_of)
    return starts, targets, walks, ends


def write_demand(network, net_file, folder):
    """Trips with exponential gaps between random ends, routed by duarouter."""
    rng = random.Random(network.seed)
    starts, targets, walks, ends = edges_for_trips(net_file)
    if not starts or not targets:
        raise GenerationFailed("the network has no edges to start and to end on")
    weights = [TYPES[t][0] for t in network.types]
    lines = [f'<vType id="{t}" {TYPES[t][1]}/>' for t in network.types]
    time, count = float(network.begin), 0
    while True:
        time -= math.log(1.0 - rng.random()) * 3600.0 / network.per_hour
        if time >= network.begin + network.duration:
            break
        start = starts[int(rng.random() * len(starts))]
        back = [t for t in targets if ends[t] == ends[start][::-1]]
        if back and rng.random() < network.u_turns:
            target = back[0]
        else:
            others = [t for t in targets if t != start and t not in back]
            target = others[int(rng.random() * len(others))]
        kind = rng.choices(network.types, weights)[0]
        lines.append(f'<trip id="v{count}" type="{kind}" depart="{time:.2f}" from="{start}" '
                     f'to="{target}" {network.attributes}/>')
        count += 1
    trips = os.path.join(folder, "trips.xml")
    write(trips, "<routes>\n  " + "\n  ".join(lines) + "\n</routes>\n")
    run_tool("duarouter", "-n", net_file, "--route-files", trips, "--begin", network.begin,
             "-o", os.path.join(folder, "demand.rou.xml"), "--ignore-errors", "--no-warnings",
             "--no-step-log", "--xml-validation", "never", "--seed", network.seed)
    return write_people(network, walks, rng, folder)


def write_people(network, walks, rng, folder):
    if not network.people:
        return ["demand.rou.xml"]
    lines, time, count = [], float(network.begin), 0
    while True:
        time -= math.log(1.0 - rng.random()) * 3600.0 / network.people
        if time >= network.begin + network.duration:
            break
        start, target = rng.sample(walks, 2)
        lines.append(f'<person id="p{count}" depart="{time:.2f}"><walk from="{start}" '
                     f'to="{target}"/></person>')
        count += 1
    write(os.path.join(folder, "people.rou.xml"),
          "<routes>\n  " + "\n  ".join(lines) + "\n</routes>\n")
    return ["demand.rou.xml", "people.rou.xml"]


def write_configuration(network, net_file, routes, additional, folder):
    step = f'<step-length value="{network.step}"/>' if network.step else ""
    extra = f'<additional-files value="{",".join(additional)}"/>' if additional else ""
    path = os.path.join(folder, f"{network.name}.sumocfg")
    write(path, f"""<configuration>
  <input>
    <net-file value="{net_file}"/>
    <route-files value="{','.join(routes)}"/>
    {extra}
  </input>
  <time><begin value="{network.begin}"/>{step}</time>
  <processing><time-to-teleport value="-1"/></processing>
  {network.options}
</configuration>
""")
    return path


def make(network, folder):
    """Writes the network, its demand and its configuration; returns the configuration's path."""
    os.makedirs(folder, exist_ok=True)
    network.build(folder)
    routes = write_demand(network, os.path.join(folder, "network.net.xml"), folder)
    return write_configuration(network, "network.net.xml", routes, [], folder)
