#!/usr/bin/env bash
# In chunks on two local workers of GNU parallel, results are those of a single run.
set -euo pipefail
source "$(dirname "$0")/cluster.sh"
run=$SOURCE/tools/cluster/parallel.sh

"${sweep[@]}" -o whole.csv
"$run" --hosts 2/: --chunks 3 -- "${sweep[@]}" -o chunks.csv
expect_equal whole.csv chunks.csv
"${bench[@]}" -o maps.csv
"$run" --hosts 2/: --chunks 2 -- "${bench[@]}" --output=maps-chunks.csv
expect_equal maps.csv maps-chunks.csv

# The same command again does what is missing, and no more.
rm chunks.csv.parts/2.csv chunks.csv
rows=$(cat chunks.csv.parts/1.csv) # with times that a second run would not repeat
"$run" --hosts 2/: --chunks 3 -- "${sweep[@]}" -o chunks.csv
expect_equal whole.csv chunks.csv
[ "$(cat chunks.csv.parts/1.csv)" = "$rows" ] || { echo "FAILED: a chunk was done again"; exit 1; }

# Bad usage is said in one line.
for bad in "--chunks 0 -- $MVTP sweep -o x.csv" "-- $MVTP sweep" "-- $MVTP solve -o x.csv" \
  "--chunks 2 -- $MVTP sweep --shard 1/2 -o x.csv"; do
  code=0
  $run $bad >out 2>err || code=$?
  [ "$code" = 2 ] && [ "$(wc -l <err)" = 1 ] || { echo "FAILED: $bad: exit $code"; cat err; exit 1; }
done
