#!/usr/bin/env bash
# Makes the README's strip (particles, surface normals, thickness, water) from one frame of the shipped sequence.
#   tools/make_strip.sh [PROGRAM]
# Needs ffmpeg on the path to put the four pictures side by side.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=${1:-build/release/meniscus}
frame=data/dam_break_3d/dam_break_3d_04320.hdf5
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

draw() { "$program" render "$frame" -o "$work/$1.png" --quiet --size 480x320 --target 2.35,0,0.22 --distance 2.6 --azimuth 38 --elevation 20 "${@:2}"; }
draw 1 --surface spheres
draw 2 --show normals
draw 3 --show thickness
draw 4
mkdir -p docs/pictures
ffmpeg -v error -y -i "$work/1.png" -i "$work/2.png" -i "$work/3.png" -i "$work/4.png" \
  -filter_complex "[0][1][2][3]hstack=inputs=4" "$work/strip.png"
mv "$work/strip.png" docs/pictures/strip.png
echo "docs/pictures/strip.png"
