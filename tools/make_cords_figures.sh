#!/usr/bin/env bash
# Makes the pictures of docs/replicate.md on Cords (2008) from the scenes in examples/cords/.
#   tools/make_cords_figures.sh [PROGRAM]
# Needs ffmpeg on the path to put the pictures side by side.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=${1:-build/release/meniscus}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

draw() {  # NAME SCENE OPTIONS...
  "$program" render "${@:3}" "examples/cords/$2.json" -o "$work/$1.png" --quiet --size 400x400
}
beside() {  # FIGURE NAMES...
  local inputs=() name
  for name in "${@:2}"; do inputs+=(-i "$work/$name.png"); done
  ffmpeg -v error -y "${inputs[@]}" -filter_complex "hstack=inputs=$(($# - 1))" "$work/row.png"
  mv "$work/row.png" "docs/pictures/figure_cords_$1.png"
  echo "docs/pictures/figure_cords_$1.png"
}

draw 4a fig4
draw 4b fig4 --refraction ray_traced
beside 4 4a 4b
draw 5a fig5b --frames 10:11
draw 5b fig5b --frames 10:11 --refraction ray_traced
beside 5 5a 5b
draw 9a fig9 --frames 60:61 --caustics simple
draw 9b fig9 --frames 60:61 --caustics light_map
draw 9c fig9 --frames 60:61 --caustics combined
beside 9 9a 9b 9c
draw 10a fig10 --frames 10:11
draw 10b fig10 --frames 10:11 --no-displaced-eye
draw 10c fig10 --frames 10:11 --refraction ray_traced
beside 10 10a 10b 10c
draw 12a fig12a --frames 60:61
draw 12b fig12b --frames 60:61
draw 12c fig12c --frames 60:61
beside 12 12a 12b 12c
draw 13a fig13 --refraction ray_traced
draw 13b fig13
draw 13c fig13_curved --frames 10:11 --refraction ray_traced
draw 13d fig13_curved --frames 10:11
beside 13 13a 13b 13c 13d
