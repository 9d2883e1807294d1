# Sourced by the tests of tools/cluster: one sweep and one bench, whole and in chunks.
#
# MVTP is the program, SOURCE the repository, WORK an empty folder.

cd "$WORK"
net=$SOURCE/networks/crossroads.net.xml
cat >x.rou.xml <<'EOF'
<routes><vType id="car" length="4.5"/>
<vehicle id="a" type="car" depart="0"><route edges="Wi Eo"/></vehicle>
<vehicle id="b" type="car" depart="1"><route edges="Si No"/></vehicle></routes>
EOF
cat >x.sumocfg <<EOF
<configuration><net-file value="$net"/><route-files value="x.rou.xml"/>
<step-length value="0.1"/></configuration>
EOF
mkdir maps
for i in 1 2 3; do
  printf 'agents:\n  - {name: a, start: [2, %d, 0], goal: [12, %d, 0]}\nmap: {dimensions: [15, 15], obstacles: []}\n' \
    $((2 + i)) $((2 + i)) >maps/m$i.yaml
done
sweep=("$MVTP" sweep -c x.sumocfg --controllers escot,sumo --seeds 1-3 --quiet)
bench=("$MVTP" bench maps --seeds 0-1 --quiet)

# The table without the columns that measure the machine, in order.
without_clock() {
  python3 -c '
import csv, sys
rows = list(csv.DictReader(open(sys.argv[1])))
clock = ("runtime", "first_solution", "rss", "replan_p", "replan_max", "real_time", "_ms", "folder")
keys = [k for k in rows[0] if not any(word in k for word in clock)]
print("\n".join(sorted(",".join(row[k] for k in keys) for row in rows)))' "$1"
}

expect_equal() {
  diff <(without_clock "$1") <(without_clock "$2") || { echo "FAILED: $2 differs from $1"; exit 1; }
}
