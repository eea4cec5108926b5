#!/usr/bin/env bash
# Makes the README's film of a walk along a street in the rain, and a still of it.
#   tools/make_rain_film.sh [PROGRAM] [--size WxH] [--quality Q]
# Without --quality the film is made again, coarser each time, until it is no more than 2 MB.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=build/release/meniscus
size=640x360
qualities="19 22 25 28 32"
while (($#)); do
  case $1 in
    --size) size=$2 && shift 2 ;;
    --quality) qualities=$2 && shift 2 ;;
    *) program=$1 && shift ;;
  esac
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for quality in $qualities; do
  "$program" render examples/street.json -o "$work/rain.mp4" --quiet --size "$size" --quality "$quality"
  bytes=$(stat -c %s "$work/rain.mp4")
  if ((bytes <= 2000000)); then break; fi
  echo "quality $quality: $bytes bytes" >&2
done
"$program" render examples/street.json -o "$work/rain.png" --quiet --size 864x486 --frames 60:61
mkdir -p docs/pictures
mv "$work/rain.mp4" docs/pictures/rain.mp4
mv "$work/rain.png" docs/pictures/rain.png
echo "docs/pictures/rain.mp4 docs/pictures/rain.png"
