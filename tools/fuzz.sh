#!/usr/bin/env bash
# Feeds each reader what libFuzzer makes of small files, for a bounded time each; stops at the first fault.
#
#     tools/fuzz.sh [SECONDS [FORMAT ...]]      (60 seconds for each format by default)
#
# FORMAT is a name of src/io/formats.cpp's table ("series": lists of frames), "any", or "where" (conditions).
#
# What it finds stays in build/fuzz/found/FORMAT/; a file that made a fault belongs into tests/fuzz/corpus/, which the
# tests read.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-60}
[ $# -gt 0 ] && shift
mapfile -t known < <(grep -oE 'Format\{"[a-z0-9]+"' src/io/formats.cpp | cut -d'"' -f2)
[ $# -gt 0 ] || set -- any "${known[@]}" where

cmake -S tests/fuzz -B build/fuzz -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_COMPILER=clang++-14 >/dev/null
cmake --build build/fuzz
for format in "$@"; do
  program=read
  [ "$format" = series ] || [ "$format" = where ] && program=$format
  found=build/fuzz/found/$format
  mkdir -p "$found"
  echo "$format: $seconds s"
  # The HDF5 library loses memory where files are damaged; what the readers themselves hold they release all the same.
  leaks=1
  [ "$format" = hdf5 ] || [ "$format" = any ] && leaks=0
  ASAN_OPTIONS=allocator_may_return_null=0:detect_leaks=$leaks MENISCUS_FUZZ_FORMAT=$format "build/fuzz/fuzz_$program" -max_total_time="$seconds" \
    -max_len=65536 -timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=512 -print_final_stats=1 \
    -dict=tests/fuzz/words.dict -artifact_prefix="$found/" "$found" tests/fuzz/corpus tests/io/samples 2>"$found.log" ||
    { tail -n 40 "$found.log"; exit 1; }
  grep -E 'stat::number_of_executed_units|stat::new_units_added' "$found.log"
done
