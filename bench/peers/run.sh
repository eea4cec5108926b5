#!/usr/bin/env bash
# Draws the same particles with this program and with VTK's fluid mapper (OpenGL on the processor, without a display),
# prints the times and their ratio, and leaves both pictures and peers.json in FOLDER.
#
#     bench/peers/run.sh PROGRAM FOLDER [PARTICLES,...] [FRAMES]
set -euo pipefail
if [ $# -lt 2 ]; then
  sed -n '2,5s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi
program=$(realpath "$1")
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mkdir -p "$2"
cd "$2"
counts=${3:-100000,1000000}
frames=${4:-5}

cmake -S "$here" -B build -DCMAKE_BUILD_TYPE=Release >cmake.log || { cat cmake.log >&2; exit 1; }
cmake --build build --parallel >build.log || { cat build.log >&2; exit 1; }

"$program" bench table1 --particles "$counts" --sizes 1024 --repeat "$frames" --write-frames . --json >table1.json
results=()
for count in ${counts//,/ }; do
  # On the processor as this program is, also where there is a graphics card.
  results+=("$(LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -s "-screen 0 1280x1280x24" \
    build/vtk_fluid "crown_$count.ply" table1.json "vtk_$count.png" "$frames" | tail -n 1)")
done
(IFS=,; echo "[${results[*]}]") >peers.json

python3 - peers.json <<'PYTHON'
import json
import sys

for row in json.load(open(sys.argv[1])):
    print(f"{row['particles']:>9} particles, {row['size']} px: meniscus {row['meniscus_ms']:.1f} ms, "
          f"vtkOpenGLFluidMapper {row['frame_ms']:.1f} ms ({row['same_particles_ms']:.1f} without upload), "
          f"{row['ratio']:.1f} times; {row['renderer']}")
PYTHON
cat peers.json
