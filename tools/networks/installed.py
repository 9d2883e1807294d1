"""The scenarios that the installed SUMO brings, copied into a folder of the user and made to run.

Nothing of them is part of this project: they are found at run time, below SUMO_HOME.
"""

import glob
import os
import shutil
import xml.etree.ElementTree as ET

import generated

REAL = "tools/sumolib/scenario/scenarios/RealWorld"
PLAIN = "tools/sumolib/scenario/scenarios"

# Scenarios whose own configuration does not load or lacks files: folder, network, demand, other
# files. Detectors are left out: they only write files.
COMPLETED = {
    **{f"RiLSA{n}": (f"{REAL}/RiLSA_example{n}", "net.net.xml", ["routes.rou.xml"],
                     ["vtypes.add.xml", "tls.add.xml" if n == 1 else "tls_add.add.xml"])
       for n in (1, 2, 3, 4)},
    "acosta": (f"{REAL}/acosta", "acosta_buslanes.net.xml", ["acosta.rou.xml"],
               ["acosta_vtypes.add.xml", "acosta_bus_stops.add.xml", "acosta_busses.add.xml",
                "acosta_tls.add.xml"]),
    # Its signal programs do not match its network: those of the network are taken.
    "pasubio": (f"{REAL}/pasubio", "pasubio_buslanes.net.xml", ["pasubio.rou.xml"],
                ["pasubio_vtypes.add.xml", "pasubio_bus_stops.add.xml",
                 "pasubio_busses.add.xml"]),
    "joined": (f"{REAL}/joined", "joined_buslanes.net.xml", ["joined.rou.xml"],
               ["joined_vtypes.add.xml", "joined_bus_stops.add.xml", "joined_busses.add.xml",
                "joined_tls.add.xml"]),
}

# Networks without demand that suits them: they get ours, per hour.
NETWORKS = {
    "RiLSA1-net": ("RiLSA1", 1500),
    "RiLSA1BothTLS": ("RiLSA1BothTLS", 1500),
    "RiLSA1OutTLS": ("RiLSA1OutTLS", 1500),
    "BasicCross": ("BasicCross", 1200),
    "BasicCrossL": ("BasicCrossL", 1200),
    "BasicCorridor": ("BasicCorridor", 1200),
    "BasicRiLSACorridor3": ("BasicRiLSACorridor3", 1800),
    "BasicRiLSANet2x2": ("BasicRiLSANet2x2", 2000),
}


def sumo_home():
    for place in (os.environ.get("SUMO_HOME"), "/usr/share/sumo", "/usr/local/share/sumo"):
        if place and os.path.isdir(os.path.join(place, "tools")):
            return place
    return None


def configurations(folder):
    """Every *.sumocfg and *.sumo.cfg below a folder."""
    found = []
    for root, _, files in os.walk(folder):
        found += [os.path.join(root, f) for f in files
                  if f.endswith((".sumocfg", ".sumo.cfg"))]
    return sorted(found)


def input_files(configuration):
    """The network, route and additional files that a configuration names."""
    folder = os.path.dirname(configuration)
    names = []
    for element in ET.parse(configuration).getroot().iter():
        if element.tag in ("net-file", "net", "route-files", "additional-files"):
            names += (element.get("value") or "").split(",")
    return [os.path.join(folder, n.strip()) for n in names if n.strip()]


def missing_files(configuration):
    return [os.path.basename(f) for f in input_files(configuration) if not os.path.exists(f)]


def copied(source, folder):
    """A scenario's folder as a copy: nothing is ever written beside the original."""
    target = os.path.join(folder, os.path.basename(source))
    if not os.path.isdir(target):
        shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
    return target


def shipped(home, folder):
    """Name and configuration (in a copy) of what SUMO ships ready to run."""
    result = {}
    for top in ("tools/game", REAL):
        source = os.path.join(home, top)
        if not os.path.isdir(source):
            continue
        target = copied(source, folder)
        for path in configurations(target):
            name = os.path.relpath(path, folder).replace(os.sep, "-")
            result[name.removesuffix(".sumocfg").removesuffix(".sumo.cfg")] = path
    return result


def completed(home, folder):
    """Name and configuration (ours) of the scenarios whose own one does not load."""
    result = {}
    for name, (place, net, routes, additional) in COMPLETED.items():
        source = os.path.join(home, place)
        if not os.path.isdir(source):
            continue
        target = copied(source, folder)
        there = lambda names: [n for n in names if os.path.exists(os.path.join(target, n))]
        network = generated.Network(name, None, end=3600)
        result[name] = generated.write_configuration(network, net, there(routes),
                                                     there(additional), target)
    return result


def with_our_demand(home, folder):
    """Name and configuration of SUMO's bare networks under demand under control."""
    result = {}
    for name, (place, per_hour) in NETWORKS.items():
        source = os.path.join(home, PLAIN, place)
        nets = sorted(glob.glob(os.path.join(source, "*.net.xml")))
        if not nets:
            continue
        network = generated.Network(name, None, per_hour=per_hour)
        target = os.path.join(folder, name)
        os.makedirs(target, exist_ok=True)
        shutil.copy(nets[0], os.path.join(target, "network.net.xml"))
        routes = generated.write_demand(network, os.path.join(target, "network.net.xml"), target)
        result[name] = generated.write_configuration(network, "network.net.xml", routes, [], target)
    return result
