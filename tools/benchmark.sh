#!/usr/bin/env bash
# Installs what is missing, builds the release, and times the hot pieces of the planner, or with --page how fast
# the replay page draws. Arguments go to Google Benchmark, e.g. --benchmark_filter=sweep --benchmark_repetitions=5
set -euo pipefail
cd "$(dirname "$0")/.."
benchmark=planner_benchmark
[ "${1:-}" = --page ] && { benchmark=page_benchmark; shift; }

tools/install_packages.sh
cmake --preset release -DMVTP_BUILD_BENCHMARKS=ON >/dev/null
cmake --build --preset release --target "$benchmark" >/dev/null
exec "build/release/tests/$benchmark" "$@"
