#!/usr/bin/env bash
# Makes the pictures of the water crown: figures 8 and 9 of [Xiao2017] (docs/pictures/figure_crown_8.png and _9.png) and
# the crown of the README (docs/pictures/crown.png).
#
#     tools/make_crown_figures.sh [PROGRAM] [8] [9] [readme]
#
# All without names. Figure 9 takes 37,975,520 particles, 1.2 GB of memory and of disk; those of FIG9 are taken instead
# if it is set. Needs ffmpeg on the path to put the pictures side by side.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=$(realpath "${1:-build/release/meniscus}")
shift || true
[ $# -gt 0 ] || set -- 8 9 readme
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p docs/pictures

# The crown's particles as a file, seen by the camera of the bench.
crown() { "$program" bench table1 --particles "$1" --sizes 64 --repeat 1 --write-frames "$work" --json >"$work/$1.json"; }
draw() {
  "$program" render "$work/crown_$1.ply" -o "$work/$2.png" --quiet --up y --fov 32.09 "${@:3}"
}
bench_camera=(--target=-0.149,0.19,0.030 --distance 4.25 --azimuth 11.46 --elevation 40.68)
beside() { # FIGURE PICTURE ...
  local inputs=() picture
  for picture in "${@:2}"; do inputs+=(-i "$work/$picture.png"); done
  ffmpeg -v error -y "${inputs[@]}" -filter_complex "hstack=inputs=$(($# - 1))" "$work/$1.png"
  mv "$work/$1.png" "docs/pictures/$1.png"
  echo "docs/pictures/$1.png"
}

for part in "$@"; do
  case $part in
    8)
      crown 2027776
      for material in water milk oil ink; do
        draw 2027776 "$material" "${bench_camera[@]}" --size 512x512 --material "$material"
      done
      beside figure_crown_8 water milk oil ink
      ;;
    9)
      pictures=()
      for count in ${FIG9:-12394215 37975520}; do
        crown "$count"
        draw "$count" "$count" "${bench_camera[@]}" --size 1024x1024 --material water
        rm "$work/crown_$count.ply"
        pictures+=("$count")
      done
      beside figure_crown_9 "${pictures[@]}"
      ;;
    readme)
      crown 2027776
      draw 2027776 crown --size 864x480 --elevation 24 --distance 3.3 --target=0,0.34,0 --azimuth 20
      mv "$work/crown.png" docs/pictures/crown.png
      echo docs/pictures/crown.png
      ;;
    *)
      echo "no such figure: $part" >&2
      exit 2
      ;;
  esac
done
