#!/usr/bin/env bash
# The main job in one command: installs what is missing, builds, and runs the crossroads under its
# traffic lights, under right of way and coordinated, with the same vehicles each time.
#   tools/demo.sh [FOLDER]    where the results go; out/demo if not given
set -euo pipefail
results=$(realpath -m "${1:-"$(dirname "$0")/../out/demo"}")
cd "$(dirname "$0")/.."

tools/install_packages.sh
cmake --preset release >/dev/null
cmake --build --preset release --target mvtp

echo
echo "Crossroads, one lane per arm, 400 vehicles per hour and approach, for half an hour:"
build/release/bin/mvtp compare -c scenarios/crossroads/crossroads-400.sumocfg --seeds 1-2 \
  --output-dir "$results"
echo "Open $results/view.html in a browser: traffic signal and coordination side by side."
