#!/usr/bin/env bash
# Formats every C++ file of the project in place by .clang-format.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if ! command -v clang-format >/dev/null; then
  echo "clang-format is not installed (it is needed for this only): apt-get install clang-format" >&2
  exit 1
fi
find src include apps tests bench -name '*.cpp' -o -name '*.h' | xargs -r clang-format -i
