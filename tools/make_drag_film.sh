#!/usr/bin/env bash
# Makes the README's film of a post that is drawn through a tank, and its strip of four pictures.
#   tools/make_drag_film.sh [PROGRAM]
# Needs ffmpeg on the path to put the pictures side by side.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=${1:-build/release/meniscus}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$program" render examples/drag.json -o "$work/drag.mp4" --quiet --size 480x270 --quality 24
"$program" render examples/drag.json -o "$work/{}.png" --quiet --size 432x288 --frames 12:58:15
inputs=()
for i in 12 27 42 57; do inputs+=(-i "$work/$i.png"); done
ffmpeg -v error -y "${inputs[@]}" -filter_complex "hstack=inputs=4" "$work/strip.png"
mkdir -p docs/pictures
mv "$work/drag.mp4" docs/pictures/drag.mp4
mv "$work/strip.png" docs/pictures/drag.png
echo "docs/pictures/drag.mp4 docs/pictures/drag.png"
