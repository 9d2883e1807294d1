#!/usr/bin/env bash
# Measures every figure of docs/results.md by one build of one commit: FOLDER/results.md and
# results.csv, one table per product.
#   tools/results.sh [FOLDER]      out/results if not given; takes hours, on one core; started again
#                                  it goes on where it was interrupted
#   tools/results.sh --short DIR   a moment of everything
#   tools/results.sh --only roads,maps DIR     some of: roads saturation mixed faults lots maps cubes; two of these
#                                  may run at a time into the same folder
# MVTP=PROGRAM takes that program in place of a release build.
set -euo pipefail

short= products=roads,saturation,mixed,faults,lots,maps,cubes
while [[ "${1:-}" == --* ]]; do
  case $1 in
    --short) short=1 ;;
    --only) products=${2:-nothing}; [ $# = 1 ] || shift ;;
    *) echo "results.sh: $1: unknown option" >&2; exit 2 ;;
  esac
  shift
done
for product in ${products//,/ }; do
  case $product in
    roads | saturation | mixed | faults | lots | maps | cubes) ;;
    *) echo "results.sh: --only: $product: not one of roads, saturation, mixed, faults, lots, maps, cubes" >&2; exit 2 ;;
  esac
done
folder=$(realpath -m "${1:-"$(dirname "$0")/../out/results"}")
cd "$(dirname "$0")/.."

if [ -z "${MVTP:-}" ]; then
  tools/install_packages.sh
  cmake --preset release >/dev/null
  cmake --build --preset release --target mvtp
  MVTP=build/release/bin/mvtp
fi

# Rows of two commits never stand in one table.
begin_or_go_on() {
  mkdir -p "$folder/done"
  local now
  now="$("$MVTP" --version | head -n 1), commit $(git describe --always --dirty --abbrev=7 2>/dev/null || echo unknown)"
  if [ -e "$folder/version" ] && [ "$(cat "$folder/version")" != "$now" ]; then
    echo "results.sh: $folder: was begun by $(cat "$folder/version"), this is $now; choose another folder" >&2
    exit 2
  fi
  echo "$now" >"$folder/version"
}

# row NAME COMMAND...: runs it unless it was done before. Runs that do not succeed are results, too.
row() {
  local name=$1 code=0
  shift
  [ ! -e "$folder/done/$name" ] || return 0
  echo "results: $name" >&2
  "$@" || code=$?
  [ "$code" -le 1 ] || exit "$code"
  echo "$code" >"$folder/done/$name"
}

# resumed FILE COMMAND...: rows of a sweep or bench into FILE; goes on with what is there.
resumed() {
  local file=$1
  shift
  [ ! -e "$file" ] || set -- "$@" --resume
  "$MVTP" "$@" --output "$file"
}

if [ -n "$short" ]; then
  seeds=1 end=(--end 60) roads=(crossroads) jamming=(crossroads) mixed=(crossroads.static) shares=0.5 lots=(parking-120)
  signals=static sparse=(--count 1 --robots 2) dense=(--count 1 --robots 5) crowds=(--count 1 --size 50 --robots 12)
  lot_count=(--count 1 --in 1 --out 1) limit=3 times=1
  faulty=(crossroads-400) faults=(none loss=0.3) faults_end=(--end 60)
  busy=(crossroads-800) busy_end=(--end 60) busy_seeds=1 busy_signals=max-wave busy_rivals=(crossroads-800)
else
  seeds=1-5 end=() roads=(crossroads crossroads-400 crossroads-600 crossroads2-400 crossroads2-800)
  jamming=(crossroads crossroads-400)
  mixed=(crossroads-400.static crossroads2-800.static crossroads-people.static) shares=0,0.05,0.2,0.4,0.6,0.8,1
  lots=(parking-120 parking-240 angled)
  signals=static,actuated,max-pressure,max-wave
  faulty=(crossroads-400 crossroads-600) faults_end=(--end 900)
  faults=(none delay=0.2 delay=0.5 delay=1 loss=0.05 loss=0.1 loss=0.2 loss=0.3
    delay=0.5,loss=0.1,position=0.2,heading=1,actuation=0.1)
  # Until the last departure: what is left then waits for many times as long at some of them.
  busy=(crossroads-{800,1000,1200,1400} crossroads2-{1000,1500,2000,2500}) busy_end=(--end 1800) busy_seeds=1-3
  busy_signals=$signals busy_rivals=(crossroads-800 crossroads2-1000)
  sparse=(--count 10) dense=(--count 10) crowds=(--count 2) lot_count=(--count 10) limit=30 times=20
fi

# roads_row NAME SCENARIO SEEDS CONTROLLERS [OPTION...]
roads_row() {
  local name=$1 scenario=$2 seeds=$3 controllers=$4
  shift 4
  row "$name" resumed "$folder/$name.csv" sweep -c "scenarios/$scenario.sumocfg" --seeds "$seeds" \
    --controllers "$controllers" "${end[@]}" "$@"
}

measure_roads() {
  local name
  roads_row roads-rilsa rilsa/rilsa "$seeds" "$signals,prioritized,escot"
  roads_row lateral-rilsa rilsa/rilsa "$seeds" escot --max-lateral-accel 3
  for name in "${roads[@]}"; do
    roads_row "roads-$name" "crossroads/$name" "$seeds" "$signals,prioritized,escot"
    roads_row "lateral-$name" "crossroads/$name" "$seeds" escot --max-lateral-accel 3
  done
  for name in "${roads[@]}"; do
    roads_row "rivals-$name" "crossroads/$name" "$seeds" aim,conflict-zone
  done
  # These jam beyond the first demands, and then take many times as long.
  for name in "${jamming[@]}"; do
    roads_row "rivals-jamming-$name" "crossroads/$name" "$seeds" fcfs,pbcr
  done
  roads_row rivals-rilsa rilsa/rilsa "$seeds" conflict-zone,aim,fcfs
}

# Reservations jam beyond the first demands.
measure_saturation() {
  local name
  local sweep=(sweep --seeds "$busy_seeds" "${busy_end[@]}")
  for name in "${busy[@]}"; do
    row "saturation-$name" resumed "$folder/saturation-$name.csv" "${sweep[@]}" \
      -c "scenarios/crossroads/$name.sumocfg" --controllers "$busy_signals,prioritized,escot"
  done
  for name in "${busy_rivals[@]}"; do
    row "saturation-rivals-$name" resumed "$folder/saturation-rivals-$name.csv" "${sweep[@]}" \
      -c "scenarios/crossroads/$name.sumocfg" --controllers aim,conflict-zone
  done
}

# Among human drivers, with real signal timing: on the twins with lights, which the coordinator shows.
measure_mixed() {
  local name
  for name in "${mixed[@]}"; do
    roads_row "mixed-$name" "crossroads/$name" "$seeds" actuated,escot --penetration "$shares"
  done
}

# Faults of V2X that are declared: nobody may touch anybody.
measure_faults() {
  local name fault options
  for name in "${faulty[@]}"; do
    for fault in "${faults[@]}"; do
      options=()
      [ "$fault" = none ] || options=(--faults "$fault" --assume-noise faults)
      row "faults-$name-$fault" resumed "$folder/faults@$name@$fault.csv" sweep -c "scenarios/crossroads/$name.sumocfg" \
        --seeds "$seeds" --controllers escot "${faults_end[@]}" "${options[@]}"
    done
  done
}

measure_lot() {  # NAME SEED
  "$MVTP" compare -c "scenarios/parking/$1.sumocfg" --seeds "$2" --jobs 1 --output-dir "$folder/lot" \
    --controllers one-at-a-time,pbcr,prioritized,escot "${end[@]}" || [ $? = 1 ]
  mv "$folder/lot/compare.csv" "$folder/lots-$1-$2.csv"
}

measure_lots() {
  local name seed
  for name in "${lots[@]}"; do
    for seed in $(seq "${seeds%-*}" "${seeds#*-}"); do row "lots-$name-$seed" measure_lot "$name" "$seed"; done
  done
}

measure_maps() {
  row suite-sparse "$MVTP" generate sparse -q -o "$folder/sparse" "${sparse[@]}"
  row suite-dense "$MVTP" generate dense -q -o "$folder/dense" "${dense[@]}"
  row suite-typical "$MVTP" generate typical -q -o "$folder/typical"
  row suite-crowd "$MVTP" generate crowd -q -o "$folder/crowd" --vehicle cl-cbs "${crowds[@]}"
  row suite-parking "$MVTP" generate parking -q -o "$folder/parking" "${lot_count[@]}"
  row maps-paper resumed "$folder/maps-paper.csv" bench "$folder"/{typical,sparse,dense} --algorithms escot,pbcr \
    --runs 5 --run-time-limit 12
  row maps-crowd resumed "$folder/maps-crowd.csv" bench "$folder/crowd" --algorithms escot,escot-star \
    --vehicle cl-cbs --time-limit "$limit"
  row maps-parking resumed "$folder/maps-parking.csv" bench "$folder/parking" --algorithms escot-star \
    --time-limit "$limit" --gap 2
}

plan_cubes() {
  local instance plan
  mkdir -p "$folder/cubes"
  for instance in scenarios/toio/random/*.yaml; do
    plan=$folder/cubes/$(basename "$instance" .yaml)
    "$MVTP" solve -i "$instance" -o "$plan.plan.yaml" -q
    "$MVTP" toio export "$plan.plan.yaml" -i "$instance" --mat collection-ring -o "$plan.run.json" -q
    [ -z "$short" ] || break
  done
}

measure_cubes() {
  row cubes-plans plan_cubes
  local emulate=("$MVTP" toio emulate "$folder"/cubes/*.run.json --delay 130 --loss 2 --runs "$times" -q)
  row cubes-calm "${emulate[@]}" --report "$folder/cubes-calm.json"
  row cubes-calm-ungated "${emulate[@]}" --no-gating --report "$folder/cubes-calm-ungated.json"
  row cubes-stalls "${emulate[@]}" --stall 4:1-5 --report "$folder/cubes-stalls.json"
  row cubes-stalls-ungated "${emulate[@]}" --stall 4:1-5 --no-gating --report "$folder/cubes-stalls-ungated.json"
}

begin_or_go_on
for product in ${products//,/ }; do "measure_$product" >&2; done
tools/results/tables.py "$folder"
