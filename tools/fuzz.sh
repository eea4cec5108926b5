#!/usr/bin/env bash
# Feeds each reader what libFuzzer makes of small files, for a bounded time each; stops at the first fault.
#
#     tools/fuzz.sh [SECONDS [FORMAT ...]]      (60 seconds for each format by default)
#
# What it finds stays in build/fuzz/found/FORMAT/; a file that made a fault belongs into tests/fuzz/corpus/, which the
# tests read.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-60}
[ $# -gt 0 ] && shift
mapfile -t known < <(grep -oE 'Format\{"[a-z0-9]+"' src/io/formats.cpp | cut -d'"' -f2)
[ $# -gt 0 ] || set -- any "${known[@]}"

cmake -S tests/fuzz -B build/fuzz -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_COMPILER=clang++-14 \
  "-DMENISCUS_FUZZ_FORMATS=$(IFS=';'; echo "${known[*]}")" >/dev/null
for format in "$@"; do
  cmake --build build/fuzz --target "fuzz_$format"
  found=build/fuzz/found/$format
  mkdir -p "$found"
  echo "$format: $seconds s"
  ASAN_OPTIONS=allocator_may_return_null=0:detect_leaks=1 "build/fuzz/fuzz_$format" -max_total_time="$seconds" \
    -max_len=65536 -timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=512 -print_final_stats=1 \
    -artifact_prefix="$found/" "$found" tests/fuzz/corpus tests/io/samples 2>"$found.log" ||
    { tail -n 40 "$found.log"; exit 1; }
  grep -E 'stat::number_of_executed_units|stat::new_units_added' "$found.log"
done
