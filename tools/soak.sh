#!/usr/bin/env bash
# Hours of traffic at the crossroads with faults, in one process: memory, overlaps, replan times.
set -euo pipefail

usage() {
  cat <<'EOF'
Usage: soak.sh [OPTION VALUE]... OUTPUT_DIR

  --hours H            simulated [h] (default: 24)
  --demand Q           vehicles per hour and approach: 200, 400 or 600 (default: 400)
  --faults LIST        as of mvtp coordinate (default: delay=0.2,loss=0.1,position=0.1,
                       heading=0.5,actuation=0.05,stops=0.001,ignores=0.0005,late=0.01)
  --assume-noise LIST  likewise (default: faults)
  --seed N             (default: 1)
  --every S            between two looks at the memory, by the clock [s] (default: 10)
  --mvtp PROGRAM       (default: build/release/bin/mvtp)

Writes the files of the run and soak.csv (wall clock, simulated time, resident memory) into
OUTPUT_DIR, and prints the figures. Exit code: 0 the run came to its end and no vehicle under control
overlapped another, unless one of the two had stopped dead or ignored its plan; 1 otherwise; 2 bad usage.
EOF
}

source=$(cd "$(dirname "$0")/.." && pwd)
hours=24
demand=400
faults=delay=0.2,loss=0.1,position=0.1,heading=0.5,actuation=0.05,stops=0.001,ignores=0.0005,late=0.01
assumed=faults
seed=1
every=10
mvtp=$source/build/release/bin/mvtp
while [ $# -gt 1 ]; do
  case $1 in
    --hours) hours=$2 ;;
    --demand) demand=$2 ;;
    --faults) faults=$2 ;;
    --assume-noise) assumed=$2 ;;
    --seed) seed=$2 ;;
    --every) every=$2 ;;
    --mvtp) mvtp=$2 ;;
    *) echo "soak.sh: $1: is no option; see --help" >&2; exit 2 ;;
  esac
  shift 2
done
case ${1:-} in
  --help | -h) usage; exit 0 ;;
  '' | -*) usage >&2; exit 2 ;;
esac
out=$1
[ -f "$source/scenarios/crossroads/demand-$demand.rou.xml" ] ||
  { echo "soak.sh: --demand $demand: there are 200, 400 and 600" >&2; exit 2; }
end=$(awk "BEGIN { printf \"%.0f\", $hours * 3600 }")

mkdir -p "$out"
sed "s/end=\"1800\"/end=\"$end\"/" "$source/scenarios/crossroads/demand-$demand.rou.xml" >"$out/soak.rou.xml"
cat >"$out/soak.sumocfg" <<EOF
<configuration>
    <net-file value="$source/networks/crossroads.net.xml"/>
    <route-files value="soak.rou.xml"/>
    <additional-files value="$source/scenarios/crossroads/car.add.xml"/>
    <step-length value="0.1"/>
    <end value="$end"/>
</configuration>
EOF

"$mvtp" coordinate -c "$out/soak.sumocfg" --output-dir "$out" --seed "$seed" --no-fcd --no-view --quiet \
  ${faults:+--faults "$faults"} ${assumed:+--assume-noise "$assumed"} &
run=$!
trap 'kill $run 2>/dev/null || true' EXIT
echo "wall_s,simulated_s,resident_mb" >"$out/soak.csv"
while kill -0 "$run" 2>/dev/null; do
  # The program that holds SUMO is a child of mvtp.
  memory=$(cat "/proc/$run/status" /proc/$(pgrep -P "$run" | head -n 1)/status 2>/dev/null |
    awk '/^VmRSS/ { sum += $2 } END { if (sum) print sum / 1024 }' || true)
  simulated=$(tail -n 1 "$out/replans.csv.part" 2>/dev/null | cut -d, -f1 || true)
  [ -n "$memory" ] && echo "$SECONDS,$simulated,$memory" >>"$out/soak.csv"
  sleep "$every"
done
wait "$run" || true
trap - EXIT

python3 - "$out" <<'EOF'
import csv, json, sys
out = sys.argv[1]
summary = json.load(open(out + "/summary.json"))
memory = [float(row["resident_mb"]) for row in csv.DictReader(open(out + "/soak.csv"))] or [0.0]
faults = summary.get("faults", {})
wrong = {event["vehicle"] for event in faults.get("events", []) + faults.get("given_up", [])}
contacts = faults.get("contacts", [])
others = [c for c in contacts if not wrong & set(c["what"].split())]
print(f"{summary['simulated_s'] / 3600:.2f} h simulated, status {summary['status']}, "
      f"{summary['real_time_factor']:.0f} x real time")
print(f"{summary['completed']} of {summary['vehicles']} vehicles arrived, mean delay "
      f"{summary['delay_s']['mean']:.2f} s")
print(f"overlaps: {summary['audit']['overlap_pairs']} pairs, {len(contacts)} of them with a vehicle under "
      f"control, {len(others)} of these without a vehicle that did not obey")
print(f"{len(faults.get('events', []))} vehicles did not obey, {len(faults.get('given_up', []))} given up")
print(f"replan: 95 % {summary['replan_ms']['p95']:.1f} ms, 99 % {summary['replan_ms']['p99']:.1f} ms, "
      f"at most {summary['replan_ms']['max']:.1f} ms")
print(f"memory: {memory[len(memory) // 2]:.0f} MB half way, {memory[-1]:.0f} MB at the end, "
      f"{max(memory):.0f} MB at most")
sys.exit(0 if summary["status"] in ("finished", "end reached") and not others else 1)
EOF
