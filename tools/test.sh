#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test once: under the sanitizers, with assertions, or
# where they cannot run it, with the product as it is released.
set -euo pipefail
cd "$(dirname "$0")/.."

# With the sanitizers and the scheduler on which one test runs a cluster of one node.
tools/install_packages.sh clang-16 libclang-rt-16-dev llvm-16 munge slurm-client slurmctld slurmd
for preset in asan product; do
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset"
  ctest --preset "$preset"
done
