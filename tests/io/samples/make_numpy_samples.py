#!/usr/bin/python3
"""Makes the .npy and .npz samples beside it with NumPy itself: the particles of make_samples.py.

Needs Debian's python3-numpy.
"""
import io
import zipfile

import numpy as np

from make_samples import COUNT, DENSITY, HERE, IDS, POSITION, TIME, VELOCITY


def write_version(name, array, version):
    with open(HERE / name, "wb") as file:
        np.lib.format.write_array(file, array, version=version)


def write_npy():
    np.save(HERE / "double.npy", POSITION)
    np.save(HERE / "fortran.npy", np.asfortranarray(POSITION.astype(">f4")))
    np.save(HERE / "half.npy", POSITION.astype("f2"))
    write_version("version_2.npy", POSITION.astype("f4"), (2, 0))
    fields = [("id", "<i8"), ("position", "<f8", (3,)), ("v", ">f4", (3,)), ("rho", "<f4"), ("kind", "S3"), ("flag", "?")]
    structured = np.zeros(COUNT, fields)
    structured["id"], structured["position"], structured["v"], structured["rho"] = IDS, POSITION, VELOCITY, DENSITY
    structured["flag"][2] = True
    np.save(HERE / "structured.npy", structured)
    names = np.zeros(COUNT, [("x", "f4"), ("y", "f4"), ("z", "f4"), ("d\u00e9j\u00e0", "f4")])
    for axis, column in zip("xyz", POSITION.T):
        names[axis] = column
    write_version("version_3.npy", names, (3, 0))
    np.save(HERE / "object.npy", np.array([{"x": 1}, None], dtype=object))


def write_npz():
    columns = dict(zip("xyz", POSITION.T))
    np.savez(HERE / "columns.npz", **columns, u=VELOCITY[:, 0], v=VELOCITY[:, 1], w=VELOCITY[:, 2], rho=DENSITY, id=IDS,
             names=np.array(["a"] * COUNT), spare=np.ones(3))
    np.savez_compressed(HERE / "packed.npz", time=TIME, pos=POSITION.astype("f4"), vel=np.asfortranarray(VELOCITY),
                        rho=DENSITY.astype("f2"), id=IDS, up="z", spacing=0.25)
    # PySPH's own .npz: dictionaries in arrays of objects.
    np.savez(HERE / "pickled.npz", particles=np.array({"fluid": columns}, dtype=object), solver_data=np.array({"t": 0}, dtype=object))
    with zipfile.ZipFile(HERE / "lists.zip", "w") as archive:
        archive.writestr("readme.txt", "no arrays")
    # A directory of 64-bit numbers, which zip uses where 32 bits do not do.
    zipfile.ZIP64_LIMIT, zipfile.ZIP_FILECOUNT_LIMIT = 1, 1
    with zipfile.ZipFile(HERE / "wide.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.comment = b"a comment behind the directory"
        for name, values in (("points", POSITION), ("velocity", VELOCITY), ("density", DENSITY)):
            stream = io.BytesIO()
            np.save(stream, values)
            archive.writestr(name + ".npy", stream.getvalue())


if __name__ == "__main__":
    write_npy()
    write_npz()
