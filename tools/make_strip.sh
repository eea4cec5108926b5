#!/usr/bin/env bash
# Makes the README's strip: particles, surface normals, thickness and water of one frame of the shipped sequence, and
# the four scenes of examples/ below.
#   tools/make_strip.sh [PROGRAM]
# Needs ffmpeg on the path to put the pictures side by side.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=${1:-build/release/meniscus}
frame=data/dam_break_3d/dam_break_3d_04320.hdf5
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

draw() { "$program" render "$frame" -o "$work/$1.png" --quiet --size 432x288 --target 2.35,0,0.22 --distance 2.6 --azimuth 38 --elevation 20 "${@:2}"; }
scene() { "$program" render "examples/$2.json" -o "$work/$1.png" --quiet --size 432x288 --frames "$3:$(($3 + 1))"; }
draw 1 --surface spheres
draw 2 --show normals
draw 3 --show thickness
draw 4
scene 5 pool 20
scene 6 block_drop 4
scene 7 duck 20
scene 8 dam_break 48
mkdir -p docs/pictures
inputs=()
for i in 1 2 3 4 5 6 7 8; do inputs+=(-i "$work/$i.png"); done
ffmpeg -v error -y "${inputs[@]}" \
  -filter_complex "[0][1][2][3]hstack=inputs=4[a];[4][5][6][7]hstack=inputs=4[b];[a][b]vstack" "$work/strip.png"
mv "$work/strip.png" docs/pictures/strip.png
echo "docs/pictures/strip.png"
