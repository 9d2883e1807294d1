#!/usr/bin/env bash
# Runs a `mvtp bench` or `mvtp sweep` in chunks on several hosts with GNU parallel; docs/cluster.md.
set -euo pipefail
source "$(dirname "$0")/chunks.sh"

usage() {
  cat <<'EOF'
Usage: parallel.sh [--hosts LIST] [--chunks N] -- mvtp bench|sweep ... -o RESULTS.csv

  --hosts LIST  hosts as of GNU parallel's --sshlogin: [JOBS/]HOST,...; ":" is this one
                (default: ":"). All see the same folder under the same path.
  --chunks N    parts of the work; several per job keep the last host from working alone
                (default: 16)

A job does one chunk at a time. The same command again does what is missing.
Exit code: 0 all chunks ran; 1 one failed; 2 bad usage.
EOF
}

hosts=:
chunks=16
while [ $# -gt 0 ] && [ "$1" != -- ]; do
  case $1 in
    --hosts | --chunks) [ $# -ge 2 ] || die "$1: a value is missing" ;;&
    --hosts) hosts=$2; shift ;;
    --chunks) chunks=$2; shift ;;
    -h | --help) usage; exit 0 ;;
    *) die "$1: is no option; see --help" ;;
  esac
  shift
done
[ $# -gt 0 ] && shift
check_number --chunks "$chunks"
command -v parallel >/dev/null || die "GNU parallel is not installed; install the package parallel"
read_command "$@"

failed=0
for ((i = 1; i <= chunks; i++)); do
  chunk_command "$i" "$chunks"
  echo
done | parallel --will-cite --sshlogin "$hosts" --workdir "$PWD" --joblog "$parts/jobs.log" || failed=1
merge_chunks "$chunks" || failed=1
exit "$failed"
