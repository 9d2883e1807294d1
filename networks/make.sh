#!/usr/bin/env bash
# Makes the networks of the crossroads from their nodes and edges:
#
#   crossroads.net.xml            1 lane per arm, nobody controls but the right of way
#   crossroads-static.net.xml     the same geometry under netconvert's fixed-time light
#   crossroads-actuated.net.xml   the same geometry under netconvert's actuated light
#   crossroads2*.net.xml          the same three with 2 lanes per arm
#
# Netconvert may choose other signal programs and corners in other versions: the committed networks
# are those of SUMO 1.15, and every figure in docs/ was measured on them.
set -euo pipefail
cd "$(dirname "$0")"

for name in crossroads crossroads2; do
  common=(
    --node-files crossroads.nod.xml --edge-files "$name.edg.xml"
    --no-turnarounds                  # nobody turns back inside the junction
    --offset.disable-normalization    # the junction stays at (0, 0)
  )
  netconvert "${common[@]}" --output-file "$name.net.xml"
  netconvert "${common[@]}" --tls.set C --tls.default-type static \
    --output-file "$name-static.net.xml"
  netconvert "${common[@]}" --tls.set C --tls.default-type actuated \
    --output-file "$name-actuated.net.xml"
done
