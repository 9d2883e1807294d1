#!/usr/bin/env bash
# Joins a SUMO that this script runs: alone, where the trajectories are those of a SUMO that mvtp starts;
# beside another client, which takes a vehicle off the road; and twice, each for a junction of its own.
#
# MVTP is the program, SOURCE the repository, WORK an empty folder.
set -euo pipefail
cd "$WORK"
fail() { echo "FAILED: $*"; exit 1; }

cat >x.rou.xml <<'EOF'
<routes><vType id="car" length="4.5"/>
<flow id="w" type="car" begin="0" end="30" period="4"><route edges="Wi Eo"/></flow>
<flow id="s" type="car" begin="1" end="30" period="5"><route edges="Si Wo"/></flow></routes>
EOF
cat >x.sumocfg <<EOF
<configuration><net-file value="$SOURCE/networks/crossroads.net.xml"/><route-files value="x.rou.xml"/>
<step-length value="0.1"/></configuration>
EOF
free_port() { python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])'; }
sumo_pid=
trap '[ -z "$sumo_pid" ] || kill "$sumo_pid" 2>/dev/null || true' EXIT
run_sumo() {
  port=$(free_port)
  sumo -c x.sumocfg --remote-port "$port" --seed 5 --random false --no-step-log true --time-to-teleport -1 \
    --collision.action warn --collision.check-junctions true --collision.mingap-factor 0 "$@" >sumo.out 2>&1 &
  sumo_pid=$!
}
positions() { grep -E '<timestep|<vehicle' "$1"; }

"$MVTP" coordinate -c x.sumocfg --seed 5 --quiet --no-view --output-dir own
run_sumo --fcd-output remote.fcd.xml
"$MVTP" coordinate -c x.sumocfg --seed 5 --quiet --no-view --output-dir joined --remote "localhost:$port" ||
  fail "joined alone: exit $?"
wait "$sumo_pid" || fail "SUMO did not end well"
cmp <(positions own/fcd.xml) <(positions remote.fcd.xml) || fail "other trajectories"
[ ! -e joined/fcd.xml ] || fail "an fcd.xml of nobody"
python3 - <<'EOF' || fail "other figures"
import json
own, joined = (json.load(open(d + "/summary.json")) for d in ("own", "joined"))
assert joined["status"] == "finished", joined["status"]
for key in ("vehicles", "completed", "replans"): assert own[key] == joined[key], key
assert abs(own["delay_s"]["mean"] - joined["delay_s"]["mean"]) < 1.0
EOF

# Another client, the second in every step, removes a vehicle that is coordinated.
run_sumo --num-clients 2
cat >other.py <<'EOF'
import sys
sys.path.append("/usr/share/sumo/tools")
import traci
traci.init(int(sys.argv[1]))
traci.setOrder(2)
driven = 0  # steps in which it was somebody else's
while traci.simulation.getMinExpectedNumber() > 0:
    if "w.1" in traci.vehicle.getIDList() and traci.vehicle.getSpeedMode("w.1") == 0:
        driven += 1
        if driven == 30:
            traci.vehicle.remove("w.1")
    traci.simulationStep()
traci.close()
assert driven == 30
EOF
python3 other.py "$port" &
other=$!
code=0
"$MVTP" coordinate -c x.sumocfg --quiet --no-view --output-dir beside --remote "localhost:$port" \
  --order 1 --num-clients 2 >beside.out 2>&1 || code=$?
wait "$other" || fail "the other client"
wait "$sumo_pid" || fail "SUMO did not end well beside another client"
python3 - <<'EOF' || fail "beside another client, exit $code: $(cat beside.out)"
import csv, json
summary = json.load(open("beside/summary.json"))
assert summary["status"] == "finished", summary
assert summary["overlap_pairs_coordinated"] == 0
rows = {row["id"]: row for row in csv.DictReader(open("beside/vehicles.csv"))}
assert rows["w.1"]["coordinated"] == "1"
assert rows["w.2"]["arrival_s"]
EOF

# Two coordinators, each with one of two junctions 500 m apart. Some vehicles pass A, some B, some both.
cat >two.nod.xml <<'EOF'
<nodes><node id="W" x="-300" y="0"/><node id="E" x="800" y="0"/>
<node id="A" x="0" y="0" type="priority"/><node id="AN" x="0" y="300"/><node id="AS" x="0" y="-300"/>
<node id="B" x="500" y="0" type="priority"/><node id="BN" x="500" y="300"/><node id="BS" x="500" y="-300"/></nodes>
EOF
{
  echo '<edges>'
  for road in "W A" "A B" "B E" "A AN" "A AS" "B BN" "B BS"; do
    read -r from to <<<"$road"
    echo "<edge id=\"$from-$to\" from=\"$from\" to=\"$to\" speed=\"13.89\"/>"
    echo "<edge id=\"$to-$from\" from=\"$to\" to=\"$from\" speed=\"13.89\"/>"
  done
  echo '</edges>'
} >two.edg.xml
netconvert -n two.nod.xml -e two.edg.xml --no-turnarounds true -o two.net.xml >netconvert.out 2>&1 ||
  fail "netconvert: $(cat netconvert.out)"
cat >x.rou.xml <<'EOF'
<routes><vType id="car" length="4.5"/>
<flow id="east" type="car" begin="0" end="30" period="4"><route edges="W-A A-B B-E"/></flow>
<flow id="west" type="car" begin="0" end="30" period="5"><route edges="E-B B-A A-AS"/></flow>
<flow id="a" type="car" begin="0" end="30" period="5"><route edges="AS-A A-AN"/></flow>
<flow id="b" type="car" begin="0" end="30" period="5"><route edges="BN-B B-BS"/></flow></routes>
EOF
cat >x.sumocfg <<'EOF'
<configuration><net-file value="two.net.xml"/><route-files value="x.rou.xml"/><step-length value="0.1"/></configuration>
EOF
run_sumo --num-clients 2
# coordinator JUNCTION ORDER: its files and what it says are named by the junction.
coordinator() {
  "$MVTP" coordinate -c x.sumocfg --junction "$1" --quiet --no-view --output-dir "at-$1" \
    --remote "localhost:$port" --order "$2" --num-clients 2 >"at-$1.out" 2>&1
}
coordinator A 1 &
first=$!
coordinator B 2 &
second=$!
wait "$first" || fail "the coordinator of A: exit $?: $(cat at-A.out)"
wait "$second" || fail "the coordinator of B: exit $?: $(cat at-B.out)"
wait "$sumo_pid" || fail "SUMO did not end well beside two coordinators"
python3 - <<'EOF' || fail "two coordinators"
import csv, json
OWN = {"A": {"east", "west", "a"}, "B": {"east", "west", "b"}}
for junction, flows in OWN.items():
    summary = json.load(open(f"at-{junction}/summary.json"))
    assert summary["status"] == "finished", summary["status"]
    assert summary["vehicles"] == summary["completed"] == 26, summary["completed"]
    assert [zone["junctions"] for zone in summary["zones"]] == [[junction]], summary["zones"]
    assert summary["audit"]["overlap_pairs"] == 0
    assert summary["overlap_pairs_coordinated"] == 0
    for row in csv.DictReader(open(f"at-{junction}/vehicles.csv")):
        assert row["coordinated"] == str(int(row["id"].split(".")[0] in flows)), (junction, row["id"])
EOF

# Bad input is said in one line.
refuse() {
  local words=$1 code=0
  shift
  "$MVTP" coordinate -c x.sumocfg "$@" >out.txt 2>err.txt || code=$?
  [ "$code" = 2 ] && [ "$(wc -l <err.txt)" = 1 ] && grep -q "$words" err.txt ||
    fail "$*: exit $code: $(cat err.txt)"
}
refuse "HOST:PORT" --remote nowhere
refuse "HOST:PORT" --remote localhost:0
refuse "num-clients" --remote localhost:8813 --order 2
refuse "gui" --remote localhost:8813 --gui
refuse "scale" --remote localhost:8813 -- --scale 2
