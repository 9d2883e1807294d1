#!/usr/bin/env bash
# Measures what docs/toio.md says of emulated cubes: the plans of random/ on a collection mat, so many
# runs of each (20), with and without blocked wheels, with and without the release graph:
# scenarios/toio/measure.sh [RUNS]. Leaves its files in out/toio/random.
set -euo pipefail
cd "$(dirname "$0")/../.."
mvtp=build/release/bin/mvtp
times=${1:-20}
out=out/toio/random
mkdir -p "$out"

for instance in scenarios/toio/random/*.yaml; do
  name=$out/$(basename "$instance" .yaml)
  "$mvtp" solve -i "$instance" -o "$name.plan.yaml" -q
  "$mvtp" toio export "$name.plan.yaml" -i "$instance" --mat collection-ring -o "$name.run.json" -q
done

measure() {  # LABEL OPTION...
  local label=$1
  shift
  "$mvtp" toio emulate "$out"/*.run.json --delay 130 --loss 2 --runs "$times" "$@" >"$out/$label.txt" && code=0 || code=$?
  printf '%-30s %s\n' "$label" "$(tail -n 1 "$out/$label.txt")"
  return "$code"
}
measure calm-without-graph --no-gating || true # may touch
measure calm
measure stalls-without-graph --stall 4:1-5 --no-gating || true # touch: that is what the graph is for
measure stalls --stall 4:1-5
