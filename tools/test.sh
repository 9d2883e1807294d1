#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test: with assertions first, then under the sanitizers.
set -euo pipefail
cd "$(dirname "$0")/.."

# With the scheduler on which one test runs a cluster of one node.
tools/install_packages.sh munge slurm-client slurmctld slurmd
for preset in dev asan; do
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset"
  ctest --preset "$preset"
done
