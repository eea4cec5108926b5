#!/usr/bin/env bash
# Draws the same particles with this program and with VTK's fluid mapper (OpenGL on the processor, without a display),
# prints the times and their ratio, and leaves both pictures and peers.json in FOLDER.
#
#     bench/peers/run.sh PROGRAM FOLDER [PARTICLES,...] [FRAMES]
#
# Of FRAMES frames (3) after one that warms up the median is taken. VTK takes some seconds a frame where nothing else
# runs; what takes longer than PEER_SECONDS (900) for all frames of one number of particles is given up.
set -euo pipefail
if [ $# -lt 2 ]; then
  sed -n '2,8s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi
program=$(realpath "$1")
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mkdir -p "$2"
cd "$2"
counts=${3:-100000,1000000}
frames=${4:-3}
seconds=${PEER_SECONDS:-900}

cmake -S "$here" -B build -DCMAKE_BUILD_TYPE=Release >cmake.log 2>&1 || { cat cmake.log >&2; exit 1; }
cmake --build build --parallel >build.log 2>&1 || { cat build.log >&2; exit 1; }

"$program" bench table1 --particles "$counts" --sizes 1024 --repeat "$frames" --write-frames . --json >table1.json
results=()
failed=0
for count in ${counts//,/ }; do
  echo "VTK draws $count particles, $((frames + 2)) frames ..." >&2
  # On the processor as this program is, also where there is a graphics card. The limit is put on the driver itself, so
  # that the virtual display is always taken down.
  status=0
  LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -s "-screen 0 1280x1280x24" timeout "$seconds" \
    build/vtk_fluid "crown_$count.ply" table1.json "vtk_$count.png" "$frames" >"vtk_$count.json" 2>"vtk_$count.log" ||
    status=$?
  if [ "$status" -eq 0 ]; then
    results+=("$(tail -n 1 "vtk_$count.json")")
    continue
  fi
  failed=1
  if [ "$status" -eq 124 ]; then
    echo "VTK has not drawn $count particles within $seconds s (PEER_SECONDS); they are left out." >&2
  else
    echo "VTK has failed on $count particles (status $status); they are left out. It said:" >&2
    tail -n 5 "vtk_$count.log" >&2
  fi
done
(IFS=,; echo "[${results[*]-}]") >peers.json

python3 -B - peers.json <<'PYTHON'
import json
import sys

for row in json.load(open(sys.argv[1])):
    print(f"{row['particles']:>9} particles, {row['size']} px: meniscus {row['meniscus_ms']:.1f} ms, "
          f"vtkOpenGLFluidMapper {row['frame_ms']:.1f} ms ({row['same_particles_ms']:.1f} without upload), "
          f"{row['ratio']:.1f} times; {row['renderer']}")
PYTHON
cat peers.json
exit "$failed"
