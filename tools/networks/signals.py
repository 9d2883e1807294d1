#!/usr/bin/env python3
"""The twin of a SUMO scenario with traffic lights, for mixed traffic and to compare with.

    tools/networks/signals.py X.sumocfg                       lights at all junctions with conflicts
    tools/networks/signals.py X.sumocfg --junctions A,B       at these
    tools/networks/signals.py X.sumocfg --type actuated       SUMO's actuated light, not its fixed-time one

writes X.static.sumocfg and X.static.net.xml beside X.sumocfg (or .actuated.): the same demand on the same lanes, with lights that
netconvert has made. `mvtp compare -c X.sumocfg` finds them by their names.
"""

import argparse
import gzip
import os
import pathlib
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree


class Bad(Exception):
    """What the user has to mend."""


def read(path):
    """An XML file, zipped or not."""
    try:
        with (gzip.open if path.suffix == ".gz" else open)(path, "rb") as file:
            return ElementTree.parse(file)
    except OSError as error:
        raise Bad(f"{path}: {error.strerror}; give a SUMO configuration") from error
    except ElementTree.ParseError as error:
        raise Bad(f"{path}: no XML: {error}") from error


def option(configuration, name):
    """The element of an option in a SUMO configuration; short names count."""
    for element in configuration.iter():
        if element.tag in {"net-file": ("net-file", "net", "n")}.get(name, (name,)):
            return element
    return None


def junctions_with_conflicts(network):
    """Ids of the junctions without a light where two connections have to yield to each other."""
    for junction in network.iter("junction"):
        has_light = junction.get("type", "").startswith(("traffic_light", "rail", "internal"))
        if not has_light and any("1" in request.get("foes", "") for request in junction.iter("request")):
            yield junction.get("id")


def junctions_to_light(network, named):
    """Those that are named, or all with conflicts."""
    known = {j.get("id") for j in network.iter("junction") if j.get("type") != "internal"}
    unknown = [name for name in named if name not in known]
    if unknown:
        raise Bad(f"--junctions {unknown[0]}: no junction of the network; known: {', '.join(sorted(known)[:8])}")
    chosen = named or sorted(junctions_with_conflicts(network))
    if not chosen:
        raise Bad("there is no junction with conflicts that has no light")
    return chosen


def with_lights(network, junctions, kind, out):
    """Has netconvert write the network with lights at these junctions."""
    made = out.with_suffix(".part")  # renamed once it is whole
    command = ["netconvert", "--sumo-net-file", network, "--tls.set", ",".join(junctions),
               "--tls.default-type", kind, "--offset.disable-normalization", "--output-file", made]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        made.unlink(missing_ok=True)
        raise Bad(f"{network}: netconvert: {run.stderr.strip().splitlines()[0]}")
    os.replace(made, out)


def make_twin(scenario, named, kind):
    """Writes the twin; its configuration."""
    configuration = read(scenario)
    net_file = option(configuration, "net-file")
    if net_file is None:
        raise Bad(f"{scenario}: names no net-file")
    os.environ.setdefault("SUMO_HOME", "/usr/share/sumo")  # as the packages of SUMO have it
    network = scenario.parent / os.path.expandvars(net_file.get("value"))
    junctions = junctions_to_light(read(network), named)
    twin = scenario.with_suffix(f".{kind}.sumocfg")
    with_lights(network, junctions, kind, twin.with_suffix(".net.xml"))
    net_file.set("value", twin.with_suffix(".net.xml").name)
    configuration.write(twin, encoding="UTF-8", xml_declaration=True)
    print(f"{twin}: lights at {', '.join(junctions[:8])}{' and others' if len(junctions) > 8 else ''}")


def main():
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", type=pathlib.Path, metavar="X.sumocfg")
    parser.add_argument("--junctions", default="", metavar="A,B", help="where; default: all with conflicts")
    parser.add_argument("--type", default="static", choices=["static", "actuated"], help="of the lights; default: static")
    arguments = parser.parse_args()
    try:
        if shutil.which("netconvert") is None:
            raise Bad("netconvert is missing; install the package sumo")
        named = [name for name in arguments.junctions.split(",") if name]
        make_twin(arguments.scenario, named, arguments.type)
    except Bad as error:
        print(f"signals.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
