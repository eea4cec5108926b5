#!/usr/bin/env bash
# Makes the pictures of docs/replicate.md on Mizukami (2013) from the scenes in examples/rain/ and the street.
#   tools/make_rain_figures.sh [PROGRAM] [--size WxH] [FIGURE...]
# --size is that of the single pictures, FIGURE is 6, 8, 9a, 9b or 10; all without. Needs ffmpeg on the path to put the
# pictures beside each other.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=build/release/meniscus
size=
figures=()
while (($#)); do
  case $1 in
    --size) size=$2 && shift 2 ;;
    6 | 8 | 9a | 9b | 10) figures+=("$1") && shift ;;
    *) program=$1 && shift ;;
  esac
done
((${#figures[@]})) || figures=(6 8 9a 9b 10)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

draw() {  # NAME SCENE FRAME SIZE OPTIONS...
  "$program" render "examples/$2.json" -o "$work/$1.png" --quiet --frames "$3:$(($3 + 1))" --size "${size:-$4}" "${@:5}"
}
beside() {  # FIGURE NAMES...
  local inputs=() name
  for name in "${@:2}"; do inputs+=(-i "$work/$name.png"); done
  ffmpeg -v error -y "${inputs[@]}" -filter_complex "hstack=inputs=$(($# - 1))" "$work/row.png"
  mkdir -p docs/pictures
  mv "$work/row.png" "docs/pictures/figure_rain_$1.png"
  echo "docs/pictures/figure_rain_$1.png"
}

for figure in "${figures[@]}"; do
  case $figure in
    6)
      for wind in 0 4 8; do draw "6_$wind" rain/fig6 26 400x300 --wind "$wind,0,0"; done
      beside 6 6_0 6_4 6_8
      ;;
    8)
      for rained in 0 1 3.9 5.9 11; do draw "8_$rained" rain/fig8 40 220x220 --rained "$rained"; done
      beside 8 8_0 8_1 8_3.9 8_5.9 8_11
      ;;
    9a)
      names=()
      for frame in 12 16 22 30 42 58 80; do draw "9a_$frame" rain/fig9 "$frame" 180x240 && names+=("9a_$frame"); done
      beside 9a "${names[@]}"
      ;;
    9b)
      names=()
      for frame in 12 18 28 44 70 90 110 140; do
        draw "9b_$frame" rain/fig9 "$frame" 180x240 --rained 11 && names+=("9b_$frame")
      done
      beside 9b "${names[@]}"
      ;;
    10)
      draw 10_splashes street 20 1120x630 --only-splashes
      draw 10_all street 20 1120x630
      for name in 10_splashes 10_all; do  # the middle of the street, pixel by pixel: splashes are small
        ffmpeg -v error -y -i "$work/$name.png" -vf "crop=iw*0.5:ih*0.6:iw*0.25:ih*0.3" "$work/${name}_near.png"
      done
      beside 10 10_splashes_near 10_all_near
      ;;
  esac
done
