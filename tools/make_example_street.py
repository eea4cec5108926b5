#!/usr/bin/python3
"""Writes what examples/street.json stands on and between: two small pictures of its ground, and the fronts of its houses.

    tools/make_example_street.py [FOLDER]

The same files every time; FOLDER is examples/ unless said otherwise. The street runs along x for 30 m and ends before a
house; across it, from z = 4.5 m in the first row to z = -4.5 m in the last, are a pavement, a kerb, the roadway with a
gutter on each side, and the same again. A steel plate lies in the roadway, slightly sunk. A pixel of the pictures is a
cell of the ground, so that kerbs are straight.
"""

import pathlib
import struct
import sys
import zlib

EXAMPLES = pathlib.Path(__file__).resolve().parent.parent / "examples"
CELL = 0.03  # m
LENGTH, WIDTH = 30.0, 9.0  # m
ACROSS, ALONG = round(WIDTH / CELL), round(LENGTH / CELL)
ROADWAY = 2.88  # m from the middle to the kerb
END = 28.2  # m: where the roadway ends
HEIGHT = 0.12  # m of the kerb above the gutter
GUTTER = 0.24  # m wide, beside the kerb
SUNK = 0.012  # m of the gutter under the roadway's edge
LOWEST, HIGHEST = -0.05, 0.15  # m: black and white
PLATE = (9.48, 10.98, -0.75, 0.75)  # m: x and z
ASPHALT, CONCRETE, STEEL = 40, 128, 230

FRONT = 4.56  # m from the middle to the houses
# From, to (m along the street), height, wall, door, storeys.
LEFT = [(-3, 4.4, 6.6, "brick", "green", 2), (4.4, 12.3, 5.4, "plaster", "red", 2), (12.3, 20.6, 7.4, "stone", "blue", 3),
        (20.6, 30, 6.2, "brick", "green", 2)]
RIGHT = [(-3, 2.1, 7.2, "stone", "red", 3), (2.1, 10.7, 5.8, "ochre", "blue", 2), (10.7, 17.9, 7.0, "brick", "green", 3),
         (17.9, 30, 5.2, "plaster", "blue", 2)]
MATERIALS = {  # linear albedo, roughness of the coat
    "brick": ((0.15, 0.075, 0.055), 1), "plaster": ((0.30, 0.28, 0.23), 1), "stone": ((0.17, 0.165, 0.16), 1),
    "ochre": ((0.26, 0.20, 0.13), 1), "plinth": ((0.07, 0.07, 0.07), 1), "sill": ((0.25, 0.245, 0.23), 1),
    "frame": ((0.42, 0.42, 0.40), 0.5), "pane": ((0.015, 0.019, 0.022), 0.04), "curtain": ((0.20, 0.18, 0.15), 0.04),
    "green": ((0.03, 0.09, 0.06), 0.25), "red": ((0.16, 0.02, 0.02), 0.25), "blue": ((0.03, 0.05, 0.12), 0.25),
    "roof": ((0.06, 0.055, 0.055), 1),
}


def height_at(x, z):
    """m above the level of the roadway's edge."""
    across = max(abs(z), ROADWAY + x - END)
    if across < ROADWAY - GUTTER:
        return -0.002 if on_plate(x, z) else 0.0
    if across < ROADWAY:
        return -SUNK * (across - (ROADWAY - GUTTER)) / GUTTER
    return HEIGHT


def on_plate(x, z):
    return PLATE[0] <= x <= PLATE[1] and PLATE[2] <= z <= PLATE[3]


def material_at(x, z):
    if on_plate(x, z):
        return STEEL
    return ASPHALT if abs(z) < ROADWAY and x < END else CONCRETE


def write_grey(path, rows):
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows), 9)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b""))


def picture(of):
    return [[of((i + 0.5) * CELL, WIDTH / 2 - (j + 0.5) * CELL) for i in range(ALONG)] for j in range(ACROSS)]


class Fronts:
    """Rectangles that face the street, by material."""

    def __init__(self):
        self.faces = {name: [] for name in MATERIALS}
        self.to_world = None

    def rectangle(self, material, *corners):
        """Four (along, up, out): anticlockwise as the street sees it where along is to the right."""
        self.faces[material].append([self.to_world(*corner) for corner in corners])

    def wall(self, material, a0, a1, y0, y1, out=0.0):
        if a1 > a0 and y1 > y0:
            self.rectangle(material, (a0, y0, out), (a1, y0, out), (a1, y1, out), (a0, y1, out))

    def box(self, material, a0, a1, y0, y1, out, back=0.0):
        """What stands out of a wall."""
        self.wall(material, a0, a1, y0, y1, out)
        self.rectangle(material, (a0, y0, back), (a0, y0, out), (a0, y1, out), (a0, y1, back))
        self.rectangle(material, (a1, y0, out), (a1, y0, back), (a1, y1, back), (a1, y1, out))
        self.rectangle(material, (a0, y1, out), (a1, y1, out), (a1, y1, back), (a0, y1, back))
        self.rectangle(material, (a0, y0, back), (a1, y0, back), (a1, y0, out), (a0, y0, out))

    def opening(self, wall, inside, a0, a1, y0, y1, deep):
        """The sides of a hole in a wall, and what closes it."""
        self.rectangle(wall, (a0, y0, 0), (a0, y0, -deep), (a0, y1, -deep), (a0, y1, 0))
        self.rectangle(wall, (a1, y0, -deep), (a1, y0, 0), (a1, y1, 0), (a1, y1, -deep))
        self.rectangle(wall, (a0, y1, -deep), (a1, y1, -deep), (a1, y1, 0), (a0, y1, 0))
        self.wall(inside, a0, a1, y0, y1, -deep)

    def window(self, wall, number, a0, a1, y0, y1):
        self.opening(wall, "curtain" if number % 5 == 3 else "pane", a0, a1, y0, y1, 0.14)
        bar, middle = 0.055, (a0 + a1) / 2
        for b0, b1, z0, z1 in ((a0, a0 + bar, y0, y1), (a1 - bar, a1, y0, y1), (a0, a1, y0, y0 + bar),
                               (a0, a1, y1 - bar, y1), (middle - bar / 2, middle + bar / 2, y0, y1),
                               (a0, a1, y0 + 0.64 * (y1 - y0), y0 + 0.64 * (y1 - y0) + bar)):
            self.box("frame", b0, b1, z0, z1, -0.09, -0.14)
        self.box("sill", a0 - 0.06, a1 + 0.06, y0 - 0.08, y0, 0.07)

    def house(self, a0, a1, top, wall, door, storeys, foot=0.1):
        """A front with windows at a regular distance, the second of its ground floor a door."""
        count = max(2, round((a1 - a0) / 2.1))
        pitch, wide, floor = (a1 - a0) / count, 1.0, (top - 0.5 - foot) / storeys
        self.wall(wall, a0, a1, top - 0.5, top)
        self.wall(wall, a0, a1, foot - 0.4, foot)
        for storey in range(storeys):
            y0 = foot + storey * floor
            sill, lintel = y0 + 0.36 * floor, y0 + 0.84 * floor
            left = a0
            for k in range(count):
                w0 = a0 + (k + 0.5) * pitch - wide / 2
                is_door = storey == 0 and k == 1
                self.wall(wall, left, w0, y0, y0 + floor)
                self.wall(wall, w0, w0 + wide, lintel, y0 + floor)
                if is_door:
                    self.opening(wall, door, w0, w0 + wide, y0, lintel, 0.2)
                    self.box("sill", w0 - 0.1, w0 + wide + 0.1, foot - 0.4, y0 + 0.06, 0.2)
                    for p0, p1 in ((0.12, 0.46), (0.54, 0.88)):
                        self.box(door, w0 + p0, w0 + p1, y0 + 0.2, y0 + 0.9, -0.18, -0.2)
                        self.box(door, w0 + p0, w0 + p1, y0 + 1.05, lintel - 0.15, -0.18, -0.2)
                else:
                    self.wall(wall, w0, w0 + wide, y0, sill)
                    self.window(wall, k + 3 * storey + round(7 * a1), w0, w0 + wide, sill, lintel)
                left = w0 + wide
            self.wall(wall, left, a1, y0, y0 + floor)
        door_at = a0 + 1.5 * pitch
        for b0, b1 in ((a0, door_at - wide / 2 - 0.1), (door_at + wide / 2 + 0.1, a1)):
            self.box("plinth", b0, b1, foot - 0.4, foot + 0.45, 0.035)
        self.box("sill", a0, a1, top - 0.22, top, 0.16)
        # The sides and the roof behind the front.
        self.rectangle(wall, (a0, foot - 0.4, -3), (a0, foot - 0.4, 0), (a0, top, 0), (a0, top, -3))
        self.rectangle(wall, (a1, foot - 0.4, 0), (a1, foot - 0.4, -3), (a1, top, -3), (a1, top, 0))
        self.rectangle("roof", (a0, top, 0), (a1, top, 0), (a1, top, -3), (a0, top, -3))
        self.wall("roof", a0, a1, foot, top, -3)

    def write(self, folder, name):
        lines, points = [f"mtllib {name}.mtl"], {}
        faces = []
        for material, quads in self.faces.items():
            faces.append(f"usemtl {material}")
            for quad in quads:
                ids = [points.setdefault(tuple(round(c, 3) for c in p), len(points) + 1) for p in quad]
                faces.append("f " + " ".join(map(str, ids)))
        lines += ["v " + " ".join(f"{c:g}" for c in p) for p in points]
        (folder / f"{name}.obj").write_text("\n".join(lines + faces) + "\n")
        text = ""
        for material, (colour, roughness) in MATERIALS.items():
            text += f"newmtl {material}\nKd {colour[0]} {colour[1]} {colour[2]}\nPr {roughness}\nNi 1.5\n"
        (folder / f"{name}.mtl").write_text(text)


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else EXAMPLES
    grey = lambda x, z: round(255 * (height_at(x, z) - LOWEST) / (HIGHEST - LOWEST))
    write_grey(folder / "street_heights.png", picture(grey))
    write_grey(folder / "street_materials.png", picture(material_at))
    fronts = Fronts()
    # From the street a walker sees +x on the right of the houses at -z, and on the left of those at +z.
    fronts.to_world = lambda a, y, out: (a, y, -FRONT + out)
    for house in LEFT:
        fronts.house(*house)
    fronts.to_world = lambda a, y, out: (-a, y, FRONT - out)
    for a0, a1, *rest in RIGHT:
        fronts.house(-a1, -a0, *rest)
    fronts.to_world = lambda a, y, out: (LENGTH - out, y, a)
    fronts.house(-5.2, 5.2, 6.0, "ochre", "green", 2)
    fronts.write(folder, "street_houses")


if __name__ == "__main__":
    main()
