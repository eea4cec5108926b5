#!/usr/bin/env bash
# Renders the demonstration from the frames in data/ and a scene of examples/: a short film and two stills, into demo/.
#   tools/demo.sh [PROGRAM]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=${1:-build/release/meniscus}
frames=data/dam_break_3d
still=$(find "$frames" -maxdepth 1 -type f -name '*04320*' | sort | head -n 1)

mkdir -p demo
"$program" render "$still" -o demo/dam_break.png --size 1280x720
"$program" render examples/duck.json -o demo/duck.png --frames 20:21
"$program" render "$frames" -o demo/dam_break.mp4 --size 1280x720
echo "The still: $PWD/demo/dam_break.png"
echo "The scene: $PWD/demo/duck.png"
echo "The film:  $PWD/demo/dam_break.mp4"
