#!/usr/bin/python3
"""Writes the meshes of examples/: a rubber duck with its way over the waves, and a rock.

    tools/make_example_meshes.py [FOLDER]

The same files every time; FOLDER is examples/ unless said otherwise.
"""

import json
import math
import pathlib
import sys

EXAMPLES = pathlib.Path(__file__).resolve().parent.parent / "examples"


class Mesh:
    """Triangles with smooth normals, in groups of one material each."""

    def __init__(self):
        self.points, self.normals, self.groups = [], [], []

    def add(self, material, points, normals, triangles):
        first = len(self.points) + 1
        self.points += points
        self.normals += normals
        self.groups.append((material, [[first + corner for corner in triangle] for triangle in triangles]))

    def write(self, path, library=None):
        lines = [f"mtllib {library}"] if library else []
        lines += ["v " + " ".join(f"{c:.4f}" for c in p) for p in self.points]
        lines += ["vn " + " ".join(f"{c:.3f}" for c in n) for n in self.normals]
        for material, triangles in self.groups:
            if material:
                lines.append(f"usemtl {material}")
            lines += ["f " + " ".join(f"{i}//{i}" for i in t) for t in triangles]
        path.write_text("\n".join(lines) + "\n", encoding="ascii")


def unit(v):
    length = math.sqrt(sum(c * c for c in v))
    return [c / length for c in v]


def grid_triangles(around, along):
    """Of a sphere's points: `along` + 1 rings of `around` + 1 points; outwards."""
    triangles = []
    for j in range(along):
        for i in range(around):
            a = j * (around + 1) + i
            b = a + around + 1
            if j > 0:
                triangles.append([a, a + 1, b + 1])
            if j < along - 1:
                triangles.append([a, b + 1, b])
    return triangles


def ellipsoid(centre, radii, around, along, bend=0.0):
    """A ball with three radii; `bend` lifts it at its -x end, as a tail."""
    points, normals = [], []
    for j in range(along + 1):
        polar = math.pi * j / along
        for i in range(around + 1):
            turn = 2 * math.pi * i / around
            d = [math.sin(polar) * math.cos(turn), math.cos(polar), -math.sin(polar) * math.sin(turn)]
            back = max(0.0, -d[0])
            points.append([centre[k] + radii[k] * d[k] + (bend * back * back if k == 1 else 0) for k in range(3)])
            slope = -2 * bend * back / radii[0]  # of the lift along x
            n = [d[k] / radii[k] for k in range(3)]
            normals.append(unit([n[0] - slope * n[1], n[1], n[2]]))
    return points, normals, grid_triangles(around, along)


def duck():
    """About 0.3 m long, looks along +x; the water line is at y = 0."""
    mesh = Mesh()
    mesh.add("yellow", *ellipsoid((0, 0.025, 0), (0.15, 0.075, 0.105), 30, 18, bend=0.055))
    mesh.add("yellow", *ellipsoid((0.095, 0.15, 0), (0.065, 0.063, 0.062), 24, 14))
    for side in (-1, 1):
        mesh.add("yellow", *ellipsoid((-0.02, 0.045, side * 0.092), (0.075, 0.035, 0.022), 14, 9, bend=0.03))
        mesh.add("black", *ellipsoid((0.138, 0.175, side * 0.034), (0.0095, 0.0125, 0.0095), 10, 6))
    mesh.add("orange", *ellipsoid((0.165, 0.142, 0), (0.036, 0.0095, 0.03), 16, 8))
    mesh.add("orange", *ellipsoid((0.16, 0.132, 0), (0.028, 0.008, 0.024), 14, 8))
    return mesh


DUCK_MATERIALS = """newmtl yellow
Kd 0.86 0.52 0.02
newmtl orange
Kd 0.80 0.16 0.01
newmtl black
Kd 0.01 0.01 0.01
"""


def noise(p):
    """A sum of waves in odd directions, about -1 to 1."""
    value, size = 0.0, 1.0
    q = list(p)
    for _ in range(5):
        value += size * math.sin(q[0] + 1.3 * math.sin(q[1])) * math.sin(q[1] + 1.7 * math.sin(q[2]) + 0.7)
        q = [1.9 * (0.8 * q[0] - 0.6 * q[2]) + 1.1, 1.9 * q[1] + 2.3, 1.9 * (0.6 * q[0] + 0.8 * q[2]) - 0.4]
        size *= 0.52
    return value / 1.6


def rock():
    """About 1 m wide and 1 m high around the origin."""
    around, along = 56, 28
    corner = (1 + math.sqrt(5)) / 2
    flats = [unit(f) for f in ((1, corner, 0.2), (-1, corner, 0.1), (0.3, 1, corner), (-0.2, 1, -corner),
                               (corner, 0.1, 1), (-corner, 0.2, 1), (corner, 0.3, -1), (-corner, 0.1, -1.2))]

    def place(d):
        # A ball with flat cuts, roughened.
        radius = min([0.5] + [0.42 / max(1e-3, sum(a * b for a, b in zip(d, f))) for f in flats])
        radius += 0.05 * noise([3.1 * c for c in d]) + 0.012 * noise([11 * c for c in d])
        return [radius * d[0], 1.05 * radius * d[1], radius * d[2]]

    def direction(i, j):
        polar, turn = math.pi * j / along, 2 * math.pi * i / around
        return [math.sin(polar) * math.cos(turn), math.cos(polar), -math.sin(polar) * math.sin(turn)]

    points = [place(direction(i % around, j)) for j in range(along + 1) for i in range(around + 1)]
    normals = []
    for j in range(along + 1):
        for i in range(around + 1):
            # From points nearby, where the poles are no exception.
            d = direction(i % around, j)
            side = unit([d[2], 0, -d[0]]) if abs(d[1]) < 0.999 else [1.0, 0.0, 0.0]
            over = [d[1] * side[2] - d[2] * side[1], d[2] * side[0] - d[0] * side[2], d[0] * side[1] - d[1] * side[0]]
            step = 0.02
            along_side = [b - a for a, b in zip(*(place(unit([d[k] + s * step * side[k] for k in range(3)]))
                                                  for s in (-1, 1)))]
            along_over = [b - a for a, b in zip(*(place(unit([d[k] + s * step * over[k] for k in range(3)]))
                                                  for s in (-1, 1)))]
            n = [along_side[1] * along_over[2] - along_side[2] * along_over[1],
                 along_side[2] * along_over[0] - along_side[0] * along_over[2],
                 along_side[0] * along_over[1] - along_side[1] * along_over[0]]
            n = unit(n)
            if sum(a * b for a, b in zip(n, d)) < 0:
                n = [-c for c in n]
            normals.append(n)
    mesh = Mesh()
    mesh.add("", points, normals, grid_triangles(around, along))
    return mesh


def standing_waves(size, height, shortest):
    """The waves of a scene's tank, as the program makes them (src/render/synthetic_waves.cpp)."""
    longer = max(size[0], size[2])
    longest, count, waves = 2 * longer, 14, []
    for i in range(count):
        k = 2 * math.pi / (longest * (shortest / longest) ** (i / (count - 1)))
        angle = 0.5 * math.pi * math.fmod(0.5 + 0.61803398875 * i, 1)
        m = math.floor(k * math.cos(angle) * size[0] / math.pi + 0.5)
        n = math.floor(k * math.sin(angle) * size[2] / math.pi + 0.5)
        if m == 0 and n == 0:
            m, n = (1, 0) if size[0] >= size[2] else (0, 1)
        kx, kz = m * math.pi / size[0], n * math.pi / size[2]
        k = math.hypot(kx, kz)
        omega = math.sqrt(9.81 * k * math.tanh(k * size[1]))
        waves.append((1 / math.sqrt(k), kx, kz, omega, 2 * math.pi * math.fmod(0.3 + 0.754877666 * i, 1)))
    total = sum(wave[0] for wave in waves)
    return [(a * height / total, kx, kz, omega, phase) for a, kx, kz, omega, phase in waves]


def duck_way(scene):
    """Where the duck is in each frame: it drifts in a slow arc and follows height and slope of the longer waves."""
    made = scene["water"]["waves"]
    size = made["size"]
    waves = [w for w in standing_waves(size, made["height"], made["shortest"]) if math.hypot(w[1], w[2]) < 14]
    frames = []
    for frame in range(made["frames"]):
        t = frame / made["fps"]
        turn = math.radians(-40 + 9 * t)
        x, z = 1.08 + 0.07 * math.sin(0.45 * t), 0.62 - 0.06 * math.sin(0.3 * t + 0.4)
        lift = slope_x = slope_z = 0.0
        for a, kx, kz, omega, phase in waves:
            swing = a * math.cos(omega * t + phase)
            lift += swing * math.cos(kx * x) * math.cos(kz * z)
            slope_x -= swing * kx * math.sin(kx * x) * math.cos(kz * z)
            slope_z -= swing * kz * math.cos(kx * x) * math.sin(kz * z)
        up = unit([-0.7 * slope_x, 1, -0.7 * slope_z])
        ahead = [math.cos(turn), 0, -math.sin(turn)]
        dot = sum(a * b for a, b in zip(ahead, up))
        ahead = unit([a - dot * b for a, b in zip(ahead, up)])
        right = [ahead[1] * up[2] - ahead[2] * up[1], ahead[2] * up[0] - ahead[0] * up[2],
                 ahead[0] * up[1] - ahead[1] * up[0]]
        place = [x, size[1] + lift, z]
        rows = [[round(c, 5) for c in (ahead[k], up[k], right[k], place[k])] for k in range(3)]
        frames.append({"matrix": rows})
    return frames


def main():
    if len(sys.argv) > 2:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) == 2 else EXAMPLES
    duck().write(folder / "duck.obj", "duck.mtl")
    (folder / "duck.mtl").write_text(DUCK_MATERIALS, encoding="ascii")
    rock().write(folder / "rock.obj")
    scene = json.loads((EXAMPLES / "duck.json").read_text(encoding="utf-8"))
    frames = duck_way(scene)
    (folder / "duck_way.json").write_text(
        "[\n" + ",\n".join(json.dumps(frame) for frame in frames) + "\n]\n", encoding="ascii")
    return 0


if __name__ == "__main__":
    sys.exit(main())
