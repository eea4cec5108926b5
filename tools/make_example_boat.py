#!/usr/bin/python3
"""Writes a statue, a boat, and the boat's way over the waves of examples/boat.json.

    tools/make_example_boat.py [FOLDER]

The same files every time; FOLDER is examples/ unless said otherwise.
"""

import json
import math
import pathlib
import sys

EXAMPLES = pathlib.Path(__file__).resolve().parent.parent / "examples"
GRAVITY = 9.81


def unit(v):
    length = math.sqrt(sum(c * c for c in v)) or 1.0
    return [c / length for c in v]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


class Mesh:
    """Triangles in groups of one material each; normals are found by whoever reads them."""

    def __init__(self):
        self.lines, self.points = [], 0

    def points_at(self, points):
        first = self.points + 1
        self.lines += ["v " + " ".join(f"{c:.4f}" for c in p) for p in points]
        self.points += len(points)
        return first

    def material(self, name):
        self.lines.append(f"usemtl {name}")

    def faces(self, first, faces):
        self.lines += ["f " + " ".join(str(first + i) for i in face) for face in faces]

    def box(self, low, high):
        corners = [[(low, high)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)]
        first = self.points_at(corners)
        self.faces(first, [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])

    def write(self, path, library=None):
        head = [f"mtllib {library}"] if library else []
        path.write_text("\n".join(head + self.lines) + "\n", encoding="ascii")


def lathe(profile, around):
    """A closed body turned about y; the profile is (radius, height) from the lower end of the axis to the upper."""
    mesh = Mesh()
    points = [[0.0, profile[0][1], 0.0]]
    for radius, height in profile[1:-1]:
        for i in range(around):
            turn = 2 * math.pi * i / around
            points.append([radius * math.cos(turn), height, radius * math.sin(turn)])
    points.append([0.0, profile[-1][1], 0.0])
    rings = len(profile) - 2
    at = lambda ring, i: 1 + ring * around + i % around
    faces = [[0, at(0, i), at(0, i + 1)] for i in range(around)]
    for ring in range(rings - 1):
        faces += [[at(ring, i), at(ring + 1, i), at(ring + 1, i + 1), at(ring, i + 1)] for i in range(around)]
    faces += [[len(points) - 1, at(rings - 1, i + 1), at(rings - 1, i)] for i in range(around)]
    mesh.faces(mesh.points_at(points), faces)
    return mesh


def statue():
    """A bishop of chess, 1 m high."""
    key = [(0, 0), (0.20, 0), (0.21, 0.03), (0.20, 0.07), (0.16, 0.10), (0.155, 0.12), (0.13, 0.16), (0.095, 0.26),
           (0.075, 0.38), (0.07, 0.50), (0.085, 0.58), (0.125, 0.61), (0.125, 0.63), (0.09, 0.655), (0.10, 0.69),
           (0.115, 0.74), (0.11, 0.79), (0.085, 0.85), (0.05, 0.90), (0.03, 0.915), (0.042, 0.94), (0.045, 0.96),
           (0.032, 0.985), (0, 1.0)]
    return lathe(key, 40)


def hull_section(s, parts):
    """Points of one section from port to starboard; s runs from the stern, 0, to the bow, 1."""
    x = -0.75 + 1.5 * s
    fullness = (1 - max(0.0, (s - 0.35) / 0.65) ** 2.2) * (0.82 + 0.18 * min(1.0, s / 0.3))
    beam = max(0.30 * fullness, 0.004)
    sheer = 0.17 + 0.13 * max(0.0, s - 0.3) ** 1.6 + 0.02 * (1 - s)
    keel = -0.17 + 0.24 * max(0.0, (s - 0.72) / 0.28) ** 2
    points = []
    for i in range(parts + 1):
        turn = math.pi * (i / parts - 0.5)
        z = beam * math.copysign(abs(math.sin(turn)) ** 0.8, turn)
        y = sheer - (sheer - keel) * max(0.0, math.cos(turn)) ** 0.7
        points.append([x, y, z])
    return points


def boat():
    """A small boat, 1.5 m long, bow to +x, its water line at y = 0."""
    mesh, parts, along = Mesh(), 16, 24
    sections = [hull_section(s / along, parts) for s in range(along + 1)]
    row = parts + 1
    hull = [[j * row + i, (j + 1) * row + i, (j + 1) * row + i + 1, j * row + i + 1]
            for j in range(along) for i in range(parts)]
    mesh.material("hull")
    first = mesh.points_at([p for section in sections for p in section])
    mesh.faces(first, hull)
    mesh.faces(first, [list(range(row)), [along * row + i for i in range(parts, -1, -1)]])
    mesh.material("deck")
    ends = [end for section in sections for end in (section[0], section[-1])]
    mesh.faces(mesh.points_at(ends), [[2 * j, 2 * j + 1, 2 * j + 3, 2 * j + 2] for j in range(along)])
    mesh.material("cabin")
    mesh.box((-0.45, 0.14, -0.15), (0.0, 0.42, 0.15))
    mesh.material("hull")
    mesh.box((-0.5, 0.42, -0.19), (0.06, 0.45, 0.19))
    mesh.material("deck")
    mesh.box((0.13, 0.15, -0.015), (0.16, 0.95, 0.015))
    return mesh


MATERIALS = """newmtl hull
Kd 0.62 0.10 0.07
newmtl deck
Kd 0.55 0.38 0.20
newmtl cabin
Kd 0.85 0.84 0.78
"""


def wave_numbers(wave, depth):
    k = 2 * math.pi / wave["wavelength"]
    return k, math.sqrt(GRAVITY * k * math.tanh(k * depth))


def height_and_slope(waves, depth, x, z, time):
    """Of the waves as sines: what a hull of this length feels of them."""
    height = slope_x = slope_z = 0.0
    for wave in waves:
        k, omega = wave_numbers(wave, depth)
        turn = math.radians(wave.get("direction", 0))
        along = math.cos(turn), math.sin(turn)
        phase = k * (along[0] * x + along[1] * z) - omega * time + math.radians(wave.get("phase", 0))
        felt = math.exp(-((0.35 * k) ** 2) / 2)  # short waves pass under the hull
        height += math.cos(phase) * wave["amplitude"] * felt
        slope = -math.sin(phase) * wave["amplitude"] * k * felt
        slope_x += slope * along[0]
        slope_z += slope * along[1]
    return height, slope_x, slope_z


def boat_way(scene):
    """One transform a frame: it drifts, heaves, pitches and rolls."""
    heights = scene["water"]["heights"]
    low, high = heights["region"]
    way = []
    for frame in range(heights["frames"]):
        time = frame / heights["fps"]
        x, z = 2.7 + 0.16 * time, 2.05 - 0.03 * time
        heave, slope_x, slope_z = height_and_slope(heights["waves"], high[1] - low[1], x, z, time)
        up = unit([-slope_x, 1.0, -slope_z])
        yaw = math.radians(24 + 3 * math.sin(1.3 * time))
        ahead = [math.cos(yaw), 0.0, math.sin(yaw)]
        side = unit(cross(ahead, up))
        ahead = cross(up, side)
        place = [x, high[1] + heave, z]
        way.append([[round(c, 5) for c in (ahead[i], up[i], side[i], place[i])] for i in range(3)])
    return way


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else EXAMPLES
    statue().write(folder / "statue.obj")
    boat().write(folder / "boat.obj", "boat.mtl")
    (folder / "boat.mtl").write_text(MATERIALS, encoding="ascii")
    text = "\n".join(line for line in (EXAMPLES / "boat.json").read_text(encoding="utf-8").splitlines()
                     if not line.strip().startswith("//"))
    rows = ",\n".join('{"matrix": ' + json.dumps(matrix) + "}" for matrix in boat_way(json.loads(text)))
    (folder / "boat_way.json").write_text("[\n" + rows + "\n]\n", encoding="ascii")


if __name__ == "__main__":
    main()
