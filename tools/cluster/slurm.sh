#!/usr/bin/env bash
# Submits a `mvtp bench` or `mvtp sweep` as a Slurm job array of chunks; docs/cluster.md.
set -euo pipefail
source "$(dirname "$0")/chunks.sh"

usage() {
  cat <<'EOF'
Usage: slurm.sh [--chunks N] [--at-once M] [--sbatch "OPTIONS"] [--wait] -- mvtp bench|sweep ... -o RESULTS.csv

  --chunks N          elements of the job array (default: 16)
  --at-once M         of them at a time (default: all)
  --sbatch "OPTIONS"  more options of sbatch for the array, e.g. "--time=2:00:00 --cpus-per-task=4"
  --wait              returns when the results are merged; else prints the ids of the two jobs

The folder of the results is one that all nodes see. The same command again does what is missing.
Exit code: 0 submitted, or with --wait merged; 1 a chunk failed; 2 bad usage.
EOF
}

chunks=16
at_once=
more=()
wait=
while [ $# -gt 0 ] && [ "$1" != -- ]; do
  case $1 in
    --chunks | --at-once | --sbatch) [ $# -ge 2 ] || die "$1: a value is missing" ;;&
    --chunks) chunks=$2; shift ;;
    --at-once) at_once=$2; check_number --at-once "$2"; shift ;;
    --sbatch) read -ra more <<<"$2"; shift ;;
    --wait) wait=1 ;;
    -h | --help) usage; exit 0 ;;
    *) die "$1: is no option; see --help" ;;
  esac
  shift
done
[ $# -gt 0 ] && shift
check_number --chunks "$chunks"
command -v sbatch >/dev/null || die "sbatch is not here; run this where Slurm's commands are"
read_command "$@"

{
  echo '#!/usr/bin/env bash'
  echo 'case $SLURM_ARRAY_TASK_ID in'
  for ((i = 1; i <= chunks; i++)); do echo "  $i) $(chunk_command "$i" "$chunks") ;;"; done
  echo esac
} >"$parts/chunk.sh"
{
  echo '#!/usr/bin/env bash'
  declare -p command output parts
  declare -f merge_chunks
  echo "merge_chunks $chunks"
} >"$parts/merge.sh"

array=$(sbatch --parsable --job-name "mvtp ${command[1]}" --array "1-$chunks${at_once:+%$at_once}" \
  --output "$parts/%a.log" ${more[@]+"${more[@]}"} "$parts/chunk.sh")
array=${array%%;*}
# Whatever became of the chunks: who did not finish is named.
merge=(sbatch --parsable --job-name "mvtp merge" --dependency "afterany:$array"
  --output "$parts/merge.log" "$parts/merge.sh")
if [ -z "$wait" ]; then
  echo "array $array, merge $("${merge[@]}")"
  exit 0
fi
"${merge[@]:0:1}" --wait "${merge[@]:1}" >/dev/null && exit 0
cat "$parts/merge.log" >&2
exit 1
