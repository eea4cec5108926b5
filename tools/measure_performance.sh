#!/usr/bin/env bash
# Measures what docs/performance.md says of the water crown, and prints its tables. On an idle machine, or the times mean
# nothing: a table takes some minutes, 142.6 million particles 6 GB.
#
#     tools/measure_performance.sh PROGRAM FOLDER [table1] [peers] [temporal]
#
# Without a part named, all are measured. FOLDER keeps what the benches print (table1.json, peers/peers.json,
# temporal.json) and the pictures. For a smaller run: PARTICLES=100000,779752 SIZES=256,512 MAX_PARTICLES=N REPEAT=1
# PEER_PARTICLES=100000 TEMPORAL="--particles 30000 --frames 2 --rays 2".
set -euo pipefail
if [ $# -lt 2 ]; then
  sed -n '2,9s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi
program=$(realpath "$1")
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
mkdir -p "$2"
cd "$2"
shift 2
[ $# -gt 0 ] || set -- table1 peers temporal

load=$(cut -d' ' -f1 /proc/loadavg)
if awk -v load="$load" 'BEGIN { exit !(load > 0.5) }'; then
  echo "The machine is not idle (load $load): the times say little." >&2
fi
for part in "$@"; do
  case $part in
    table1)
      arguments=(--max-particles "${MAX_PARTICLES:-142612764}" --repeat "${REPEAT:-5}")
      [ -z "${PARTICLES:-}" ] || arguments+=(--particles "$PARTICLES")
      [ -z "${SIZES:-}" ] || arguments+=(--sizes "$SIZES")
      "$program" bench table1 --json "${arguments[@]}" >table1.json
      ;;
    peers)
      "$root/tools/install_packages.sh" "$root/bench/peers/packages.txt" >&2
      "$root/bench/peers/run.sh" "$program" peers "${PEER_PARTICLES:-100000,1000000}" "${REPEAT:-3}" >&2
      ;;
    temporal)
      read -ra arguments <<<"${TEMPORAL:-}"
      "$program" bench temporal --json "${arguments[@]}" >temporal.json
      ;;
    *)
      echo "no such part: $part" >&2
      exit 2
      ;;
  esac
done

python3 -B - "$@" <<'PYTHON'
import json
import pathlib
import sys


def table(head, rows):
    print("| " + " | ".join(head) + " |")
    print("| " + " | ".join("---:" if i else "---" for i in range(len(head))) + " |")
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")
    print()


def ms(value):
    return "-" if value is None else f"{value:.0f}" if value >= 99.5 else f"{value:.1f}"


def table1():
    found = json.loads(pathlib.Path("table1.json").read_text())
    sizes = sorted({row["size"] for row in found["rows"]})
    counts = sorted({row["particles"] for row in found["rows"]})
    by = {(row["particles"], row["size"]): row for row in found["rows"]}
    print(f"{found['threads']} threads, {found['instruction_set']}, median of {found['repeat']} runs at most; ms a frame "
          f"(that of the paper)\n")
    table(["particles"] + [f"{size}" for size in sizes],
          [[f"{count:,}"] + [f"{ms(by[count, size]['frame_ms'])} ({ms(by[count, size]['paper_ms'])})" for size in sizes]
           for count in counts])
    size = found["growth_size"]
    stages = list(dict.fromkeys(stage for count in counts for stage in by[count, size]["stages_ms"]))
    print(f"By stage at {size} x {size}, ms; memory beside the particles, MB\n")
    rows = []
    for count in counts:
        row = by[count, size]
        rows.append([f"{count:,}", ms(row["build_ms"]), ms(row["view_ms"])]
                    + [ms(row["stages_ms"].get(stage)) for stage in stages]
                    + [f"{100 * row['covered_pixels'] / size ** 2:.0f} %", f"{row['beside_input_bytes'] / 1e6:.0f}"])
    table(["particles", "build", "view"] + stages + ["covered", "memory"], rows)
    if found["growth"] is not None:
        print(f"Growth from the fewest to the most: {found['growth']:.1f} times a frame, "
              f"{found['view_growth']:.1f} times a new view of the same particles.\n")
    for note in found["notes"]:
        print(note + "\n")


def peers():
    found = json.loads(pathlib.Path("peers/peers.json").read_text())
    table(["particles", "Meniscus, ms", "VTK, ms", "VTK without upload, ms", "ratio"],
          [[f"{row['particles']:,}", ms(row["meniscus_ms"]), ms(row["frame_ms"]), ms(row["same_particles_ms"]),
            f"{row['ratio']:.1f}"] for row in found])
    if found:
        print(f"VTK draws with {found[0]['renderer']}.\n")


def temporal():
    found = json.loads(pathlib.Path("temporal.json").read_text())
    print(f"{found['particles']:,} particles, {found['frames']} frames, {found['rays_a_pixel']} rays a pixel; "
          "thousandths of white\n")
    table(["motion", "px a spacing", "change", "of the truth", "ratio", "error", "its change"],
          [[row["motion"], f"{row['px_per_spacing']:g}"]
           + [f"{1000 * row[key]:.1f}" for key in ("change_rms", "truth_change_rms")]
           + [f"{row['ratio']:.2f}"]
           + [f"{1000 * row[key]:.1f}" for key in ("error_rms", "error_change_rms")] for row in found["rows"]])


for part in sys.argv[1:]:
    {"table1": table1, "peers": peers, "temporal": temporal}[part]()
PYTHON
