#!/usr/bin/env bash
# Fuzzes what decodes bytes from outside, for so many seconds (60); installs clang where it is missing.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/install_packages.sh clang-16 libclang-rt-16-dev
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target toio_protocol_fuzzer
build/fuzz/tests/toio_protocol_fuzzer -max_total_time="${1:-60}" -max_len=256 -print_funcs=0 -print_final_stats=1
