#!/usr/bin/env bash
# Makes the networks, the demand and the configurations of the layouts.
#
#   four-arm-Q.sumocfg       one lane per arm, Q = 200, 360, 600, 800 veh/h per approach
#   four-arm2-720.sumocfg    two lanes per arm: right and straight on from the right one, left from the left one
#   t-junction-468.sumocfg   three arms of one lane
#   roundabout-360.sumocfg   a ring of 10 m with four arms of one lane
#   NAME.static.sumocfg, NAME.actuated.sumocfg  the same at netconvert's lights; not for the roundabout
#
# Each approach sends as many vehicles to each other arm, as a Poisson process of 600 s, another one for
# each seed, at a random speed of departure. The run ends after 600 s.
set -euo pipefail
cd "$(dirname "$0")"

# network NAME OPTIONS...
network() {
  local name=$1
  shift
  netconvert --edge-files "$name.edg.xml" --no-turnarounds --offset.disable-normalization "$@" --output-file "$name.net.xml"
}

# with_lights NAME OPTIONS...: the network without a light and its two twins
with_lights() {
  local name=$1 kind
  network "$@"
  for kind in static actuated; do
    netconvert --sumo-net-file "$name.net.xml" --tls.set C --tls.default-type "$kind" --output-file "$name-$kind.net.xml"
  done
}

with_lights four-arm --node-files four-arm.nod.xml
with_lights four-arm2 --node-files four-arm.nod.xml --connection-files four-arm2.con.xml
with_lights t-junction --node-files t-junction.nod.xml
network roundabout --node-files roundabout.nod.xml

# flow FROM TO VEHICLES_PER_SECOND EDGES
flow() {
  cat <<FLOW
    <flow id="$1-$2" type="car" begin="0" end="600" period="exp($3)" departLane="best"
          departSpeed="random"><route edges="$4"/></flow>
FLOW
}

# The ring from one arm to another, counterclockwise.
ring() {
  local at=$1 path=""
  local -A next=([E]=N [N]=W [W]=S [S]=E)
  while [[ $at != "$2" ]]; do
    path+="$at${next[$at]} "
    at=${next[$at]}
  done
  echo "$path"
}

# demand ARMS VEHICLES_PER_HOUR [ring]
demand() {
  local from to rate between=""
  rate=$(awk "BEGIN { printf \"%.7f\", $2 / 3600 / ($(wc -w <<<"$1") - 1) }")
  echo '<?xml version="1.0" encoding="UTF-8"?>'
  echo "<!-- $2 veh/h per approach; period=exp(r): r vehicles per second, exponential headways. -->"
  echo '<routes>'
  for from in $1; do
    for to in $1; do
      [[ $from != "$to" ]] || continue
      [[ $# -lt 3 ]] || between=$(ring "$from" "$to")
      flow "$from" "$to" "$rate" "${from}i $between${to}o"
    done
  done
  echo '</routes>'
}

# configuration NETWORK ROUTE_FILE
configuration() {
  cat <<SUMOCFG
<?xml version="1.0" encoding="UTF-8"?>
<configuration>
    <input>
        <net-file value="$1.net.xml"/>
        <route-files value="$2"/>
        <additional-files value="car.add.xml"/>
    </input>
    <time>
        <end value="600"/>
        <step-length value="0.1"/>
    </time>
    <processing>
        <time-to-teleport value="-1"/>
    </processing>
</configuration>
SUMOCFG
}

# scenario NETWORK VEHICLES_PER_HOUR ARMS
scenario() {
  local kind
  demand "$3" "$2" > "$1-$2.rou.xml"
  configuration "$1" "$1-$2.rou.xml" > "$1-$2.sumocfg"
  for kind in static actuated; do
    configuration "$1-$kind" "$1-$2.rou.xml" > "$1-$2.$kind.sumocfg"
  done
}

for rate in 200 360 600 800; do scenario four-arm "$rate" "E N W S"; done
scenario four-arm2 720 "E N W S"
scenario t-junction 468 "E W S"
demand "E N W S" 360 ring > roundabout-360.rou.xml
configuration roundabout roundabout-360.rou.xml > roundabout-360.sumocfg
