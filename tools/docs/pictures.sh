#!/usr/bin/env bash
# Makes the pictures in docs/drawings that show what the program does: tools/docs/pictures.sh
# MVTP=PROGRAM takes that program in place of the release build. A minute.
set -euo pipefail
cd "$(dirname "$0")/../.."
mvtp=$(realpath "${MVTP:-build/release/bin/mvtp}")
drawings=docs/drawings
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

four=scenarios/toio/four.yaml
"$mvtp" solve -q -i "$four" -o "$work/four.yaml"
for t in 0 6 12; do "$mvtp" view "$work/four.yaml" -i "$four" --at "$t" -o "$drawings/four-$t.svg"; done
"$mvtp" toio export "$work/four.yaml" -i "$four" --mat simple -o "$work/run.json" -q
"$mvtp" toio emulate "$work/run.json" --report "$work/report.json" >/dev/null
tools/docs/cubes.py "$work/run.json" "$work/report.json" -o "$drawings/cubes.svg"

"$mvtp" generate dense --size 100 --obstacles 40 --robots 100 --count 1 -q -o "$work/dense"
"$mvtp" solve -q -i "$work"/dense/*.yaml -o "$work/crowd.yaml"
"$mvtp" view "$work/crowd.yaml" -i "$work"/dense/*.yaml --at 45 -o "$drawings/crowd.svg"

# 68 x 40 m around the junction.
"$mvtp" coordinate -c scenarios/crossroads/crossroads2-800.sumocfg --output-dir "$work/run" --quiet \
  --no-fcd --seed 1 --end 200 || [ $? = 1 ]
"$mvtp" view "$work/run/view.html" --at 190 --title "A crossroads, coordinated" -o "$work/crossroads.svg"
sed -E '1s/width="[0-9]+" height="[0-9]+" viewBox="[^"]*"/width="1360" height="960" viewBox="-51 -36 102 72"/' \
  "$work/crossroads.svg" >"$drawings/crossroads.svg"
