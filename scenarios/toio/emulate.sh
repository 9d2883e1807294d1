#!/usr/bin/env bash
# The paper's conflict of four robots, from the instance to an emulated run on a mat (simple; or
# collection-ring, or any other): scenarios/toio/emulate.sh [MAT]. Leaves its files in out/toio.
set -euo pipefail
cd "$(dirname "$0")/../.."
mvtp=build/release/bin/mvtp
mat=${1:-simple}
instance=scenarios/toio/four.yaml
mkdir -p out/toio

"$mvtp" solve -i "$instance" -o out/toio/plan.yaml
"$mvtp" view out/toio/plan.yaml -i "$instance" -o out/toio/plan.html
"$mvtp" toio export out/toio/plan.yaml -i "$instance" --mat "$mat" -o out/toio/run.json
"$mvtp" toio check out/toio/run.json
"$mvtp" toio emulate out/toio/run.json --delay 130 --stall 4:1-5 --loss 2 --runs 20
