#!/usr/bin/env bash
# Makes the demand and the configurations of the crossroads.
#
#   demand-Q.rou.xml                       Q veh/h per approach: 30 % left, 50 % straight, 20 % right
#   NAME[-Q].sumocfg                       the crossroads without a light; Q = 200 if not named
#   NAME[-Q].static.sumocfg, .actuated.    the same demand at the twins with a light
#   people-300.rou.xml                     300 people/h on foot over the crossings
#   crossroads-people.sumocfg, .static., .actuated.  they beside 200 veh/h per approach
#
# NAME is crossroads (1 lane per arm) or crossroads2 (2 lanes). Lights carry 500 and 900, all lanes
# without conflicts about 1400 and 2700. The demand is a Poisson process for
# half an hour, another one for each seed; the run ends when the last vehicle has arrived.
set -euo pipefail
cd "$(dirname "$0")"

# One approach: demand FROM LEFT STRAIGHT RIGHT VEHICLES_PER_HOUR
approach() {
  local from=$1 rate
  local -A share=([left]=0.3 [straight]=0.5 [right]=0.2) to=([left]=$2 [straight]=$3 [right]=$4)
  for turn in left straight right; do
    rate=$(awk "BEGIN { printf \"%.7f\", $5 * ${share[$turn]} / 3600 }")
    cat <<FLOW
    <flow id="$from-$turn" type="car" begin="0" end="1800" period="exp($rate)"
          departLane="best" departSpeed="max"><route edges="${from}i ${to[$turn]}o"/></flow>
FLOW
  done
}

demand() {
  echo '<?xml version="1.0" encoding="UTF-8"?>'
  echo "<!-- $1 veh/h per approach; period=exp(r): r vehicles per second, exponential headways. -->"
  echo '<routes>'
  approach E S W N "$1"
  approach N E S W "$1"
  approach S W N E "$1"
  approach W N E S "$1"
  echo '</routes>'
}

# people FLOW FROM TO PEOPLE_PER_HOUR: from 60 m before the junction to 60 m behind it
people() {
  local depart=$2 arrive=$3 rate
  rate=$(awk "BEGIN { printf \"%.7f\", $4 / 3600 }")
  # Sidewalks are used both ways: towards the junction along ..i, against the traffic along ..o.
  [[ $depart == *i ]] && depart=240 || depart=60
  [[ $arrive == *o ]] && arrive=60 || arrive=240
  cat <<FLOW
    <personFlow id="$1" begin="0" end="1800" period="exp($rate)" departPos="$depart">
        <walk from="$2" to="$3" arrivalPos="$arrive"/></personFlow>
FLOW
}

# The sidewalks of Ni and Wo meet in the north-west, those of No and Ei in the north-east, and so on.
walkers() {
  echo '<?xml version="1.0" encoding="UTF-8"?>'
  echo '<!-- 300 people/h: 25 each way over each arm, 25 from each corner to the one opposite. -->'
  echo '<routes>'
  people north-a Ni Ei 25
  people north-b No Wo 25
  people east-a Ei Si 25
  people east-b Eo No 25
  people south-a Si Wi 25
  people south-b So Eo 25
  people west-a Wi Ni 25
  people west-b Wo So 25
  people across-a Ni Eo 25
  people across-b Ei So 25
  people across-c Si Wo 25
  people across-d Wi No 25
  echo '</routes>'
}

# configuration NETWORK ROUTE_FILES
configuration() {
  cat <<SUMOCFG
<?xml version="1.0" encoding="UTF-8"?>
<configuration>
    <input>
        <net-file value="../../networks/$1.net.xml"/>
        <route-files value="$2"/>
        <additional-files value="car.add.xml"/>
    </input>
    <time>
        <step-length value="0.1"/>
    </time>
    <processing>
        <time-to-teleport value="-1"/>
    </processing>
</configuration>
SUMOCFG
}

# configurations NAME NETWORK ROUTE_FILES
configurations() {
  configuration "$2" "$3" > "$1.sumocfg"
  configuration "$2-static" "$3" > "$1.static.sumocfg"
  configuration "$2-actuated" "$3" > "$1.actuated.sumocfg"
}

# scenario NAME NETWORK VEHICLES_PER_HOUR
scenario() {
  demand "$3" > "demand-$3.rou.xml"
  configurations "$1" "$2" "demand-$3.rou.xml"
}

scenario crossroads crossroads 200
scenario crossroads-400 crossroads 400
scenario crossroads-600 crossroads 600
scenario crossroads2-400 crossroads2 400
scenario crossroads2-800 crossroads2 800
for demand in 800 1000 1200 1400; do scenario "crossroads-$demand" crossroads "$demand"; done
for demand in 1000 1500 2000 2500; do scenario "crossroads2-$demand" crossroads2 "$demand"; done

walkers > people-300.rou.xml
configurations crossroads-people crossings demand-200.rou.xml,people-300.rou.xml
