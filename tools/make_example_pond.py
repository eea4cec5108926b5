#!/usr/bin/python3
"""Writes examples/pond_banks.obj: the bed of a pond and the banks around it, whose water stands at height 0.

    tools/make_example_pond.py [FOLDER]

The same file every time; FOLDER is examples/ unless said otherwise. Points lie on rings around the middle, closest at
the shore; y is up, 1 is a metre.
"""

import math
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "examples"
MIDDLE = (3.0, 3.4)
HALF_WIDTH, HALF_LENGTH = 2.6, 3.3  # m, of the shore
DEPTH, BANK, HILL = 0.5, 0.22, 1.1  # m
AROUND = 144
RINGS = (0.3, 0.6, 0.8, 0.9, 0.95, 0.98, 1.0, 1.015, 1.035, 1.065, 1.1, 1.15, 1.22, 1.32, 1.46, 1.63, 1.82, 2.05, 2.35, 2.7, 3.2, 3.9, 4.8)


def smooth(t):
    t = min(max(t, 0.0), 1.0)
    return t * t * (3 - 2 * t)


def shore(angle):
    """How far the shore is out, over an ellipse's."""
    return 1 + 0.06 * math.sin(3 * angle + 0.7) + 0.04 * math.sin(5 * angle + 2.1) + 0.02 * math.sin(11 * angle) + 0.008 * math.sin(23 * angle + 1)


def bumps(x, z):
    sum_ = 0.0
    for length, height, turn in ((1.9, 0.07, 0.4), (0.83, 0.035, 1.9), (0.37, 0.016, 3.3), (0.19, 0.007, 5.1)):
        a, b = x * math.cos(turn) + z * math.sin(turn), z * math.cos(turn) - x * math.sin(turn)
        k = 2 * math.pi / length
        sum_ += height * math.sin(k * a + 1.3 * math.sin(0.6 * k * b)) * math.cos(0.8 * k * b + turn)
    return sum_


def height(part, x, z):
    away = (part - 1) * 0.5 * (HALF_WIDTH + HALF_LENGTH)  # m from the shore, about
    if away < 0:
        return -DEPTH * smooth(-away / 1.1) - 0.02 * smooth(-away / 0.1) + bumps(x, z) * 0.5 * smooth(-away / 0.5)
    rises = BANK * (1 - math.exp(-away / 0.3)) + HILL * smooth((away - 0.6) / 7)
    return rises + bumps(x, z) * smooth(away / 0.5) * (1 - 0.5 * smooth(away / 4))


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    lines = ["# Bed and banks of a pond, made by tools/make_example_pond.py"]

    def point(part, angle):
        out = part * shore(angle)
        x, z = MIDDLE[0] + out * HALF_WIDTH * math.cos(angle), MIDDLE[1] + out * HALF_LENGTH * math.sin(angle)
        lines.append(f"v {x:.3f} {height(part, x, z):.3f} {z:.3f}")

    point(0, 0)
    for part in RINGS:
        for k in range(AROUND):
            point(part, 2 * math.pi * k / AROUND)
    for k in range(AROUND):
        n = (k + 1) % AROUND
        lines.append(f"f 1 {2 + n} {2 + k}")
        for ring in range(len(RINGS) - 1):
            here, out = 2 + ring * AROUND, 2 + (ring + 1) * AROUND
            lines.append(f"f {here + k} {here + n} {out + n} {out + k}")
    (folder / "pond_banks.obj").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
