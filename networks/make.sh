#!/usr/bin/env bash
# Makes the networks of the crossroads from their nodes and edges:
#
#   crossroads.net.xml            1 lane per arm, nobody controls but the right of way
#   crossroads-static.net.xml     the same geometry under netconvert's fixed-time light
#   crossroads-actuated.net.xml   the same geometry under netconvert's actuated light
#   crossroads2*.net.xml          the same three with 2 lanes per arm
#   crossings.net.xml             1 lane per arm, with sidewalks and zebra crossings: people first
#   crossings-static.net.xml, crossings-actuated.net.xml  the same geometry under netconvert's lights
#
# Netconvert may choose other signal programs and corners in other versions: the committed networks
# are those of SUMO 1.15, and every figure in docs/ was measured on them.
set -euo pipefail
cd "$(dirname "$0")"

with_lights() {  # NAME OPTIONS...: the network without a light and its two twins
  local name=$1
  shift
  netconvert "$@" --output-file "$name.net.xml"
  netconvert "$@" --tls.set C --tls.default-type static --output-file "$name-static.net.xml"
  netconvert "$@" --tls.set C --tls.default-type actuated --output-file "$name-actuated.net.xml"
}

for name in crossroads crossroads2; do
  common=(
    --node-files crossroads.nod.xml --edge-files "$name.edg.xml"
    --no-turnarounds                  # nobody turns back inside the junction
    --offset.disable-normalization    # the junction stays at (0, 0)
  )
  with_lights "$name" "${common[@]}"
done
common=(
  --node-files crossroads.nod.xml --edge-files crossroads.edg.xml --connection-files crossings.con.xml
  --no-turnarounds --offset.disable-normalization --sidewalks.guess
)
with_lights crossings "${common[@]}"
