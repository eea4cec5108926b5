#!/usr/bin/python3
"""Writes what the ground of examples/street.json is made of and how high it is: two small pictures.

    tools/make_example_street.py [FOLDER]

The same files every time; FOLDER is examples/ unless said otherwise. The street runs along x for 30 m; across it, from
z = 4.5 m in the first row to z = -4.5 m in the last, are a pavement, a kerb, the roadway with a gutter on each side, and
the same again. A steel plate lies in the roadway, slightly sunk.
"""

import pathlib
import struct
import sys
import zlib

EXAMPLES = pathlib.Path(__file__).resolve().parent.parent / "examples"
LENGTH, WIDTH = 30.0, 9.0  # m
ACROSS = 450  # rows: 2 cm each
ALONG = 300  # columns: 10 cm each
ROADWAY = 2.9  # m from the middle to the kerb
KERB = 0.16  # m wide
HEIGHT = 0.12  # m of the kerb above the gutter
GUTTER = 0.25  # m wide, beside the kerb
SUNK = 0.012  # m of the gutter under the roadway's edge
LOWEST, HIGHEST = -0.05, 0.15  # m: black and white
PLATE = (9.5, 11.0, -0.75, 0.75)  # m: x and z
ASPHALT, CONCRETE, STEEL = 40, 128, 230


def height_at(x, z):
    """m above the level of the roadway's edge."""
    across = abs(z)
    if across < ROADWAY - GUTTER:
        return -0.004 if on_plate(x, z) else 0.0
    if across < ROADWAY:
        return -SUNK * (across - (ROADWAY - GUTTER)) / GUTTER
    return HEIGHT - 0.015 * max(0.0, 1.0 - (across - ROADWAY - KERB) / 1.2) * (across > ROADWAY + KERB)


def on_plate(x, z):
    return PLATE[0] <= x <= PLATE[1] and PLATE[2] <= z <= PLATE[3]


def material_at(x, z):
    if on_plate(x, z):
        return STEEL
    return ASPHALT if abs(z) < ROADWAY else CONCRETE


def write_grey(path, rows):
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows), 9)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b""))


def picture(of):
    return [
        [of((i + 0.5) / ALONG * LENGTH, WIDTH / 2 - (j + 0.5) / ACROSS * WIDTH) for i in range(ALONG)]
        for j in range(ACROSS)
    ]


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else EXAMPLES
    grey = lambda x, z: round(255 * (height_at(x, z) - LOWEST) / (HIGHEST - LOWEST))
    write_grey(folder / "street_heights.png", picture(grey))
    write_grey(folder / "street_materials.png", picture(material_at))


if __name__ == "__main__":
    main()
