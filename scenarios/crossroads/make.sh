#!/usr/bin/env bash
# Makes the demand and the configurations of the crossroads.
#
#   demand-Q.rou.xml                       Q veh/h per approach: 30 % left, 50 % straight, 20 % right
#   NAME[-Q].sumocfg                       the crossroads without a light; Q = 200 if not named
#   NAME[-Q].static.sumocfg, .actuated.    the same demand at the twins with a light
#
# NAME is crossroads (1 lane per arm) or crossroads2 (2 lanes). The demand is a Poisson process for
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

# configuration NETWORK VEHICLES_PER_HOUR
configuration() {
  cat <<SUMOCFG
<?xml version="1.0" encoding="UTF-8"?>
<configuration>
    <input>
        <net-file value="../../networks/$1.net.xml"/>
        <route-files value="demand-$2.rou.xml"/>
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

# scenario NAME NETWORK VEHICLES_PER_HOUR
scenario() {
  demand "$3" > "demand-$3.rou.xml"
  configuration "$2" "$3" > "$1.sumocfg"
  configuration "$2-static" "$3" > "$1.static.sumocfg"
  configuration "$2-actuated" "$3" > "$1.actuated.sumocfg"
}

scenario crossroads crossroads 200
scenario crossroads-400 crossroads 400
scenario crossroads-600 crossroads 600
scenario crossroads2-400 crossroads2 400
scenario crossroads2-800 crossroads2 800
