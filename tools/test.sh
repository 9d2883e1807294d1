#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test: with assertions first, then under the sanitizers.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/install_packages.sh
for preset in dev asan; do
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset"
  ctest --preset "$preset"
done
