#!/usr/bin/python3
"""Makes the sample files beside it with writers that know nothing of Meniscus: VTK's own and h5py.

Needs Debian's python3-vtk9, python3-h5py and python3-numpy. Every file holds COUNT particles; particle i has

    position (0.25 i, 1 - 0.5 i, i^2)   velocity (i, -i, 0.5 i)   density 1000 + i   id 10 i
"""
import pathlib

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

COUNT = 7
HERE = pathlib.Path(__file__).parent
INDEX = np.arange(COUNT, dtype=np.float64)
POSITION = np.stack([0.25 * INDEX, 1 - 0.5 * INDEX, INDEX**2], axis=1)
VELOCITY = np.stack([INDEX, -INDEX, 0.5 * INDEX], axis=1)
DENSITY = 1000 + INDEX
IDS = 10 * np.arange(COUNT)
TIME = 0.375


def array(values, name, dtype):
    result = numpy_to_vtk(values.astype(dtype), deep=1)
    result.SetName(name)
    return result


def points(precision):
    result = vtk.vtkPoints()
    result.SetDataType(vtk.VTK_DOUBLE if precision == "f8" else vtk.VTK_FLOAT)
    result.SetData(array(POSITION, "points", precision))
    return result


def cells():
    result = vtk.vtkCellArray()
    for i in range(COUNT):
        result.InsertNextCell(1)
        result.InsertCellPoint(i)
    return result


def add_rich_data(dataset):
    """One array of each kind that the legacy format knows, some of them with names for their components."""
    data = dataset.GetPointData()
    data.SetVectors(array(VELOCITY, "velocity", "f4"))
    data.SetScalars(array(DENSITY, "rho", "f8"))
    data.SetNormals(array(np.tile([0.0, 0.0, 1.0], (COUNT, 1)), "Normals", "f4"))
    data.SetTensors(array(np.tile(np.eye(3).ravel(), (COUNT, 1)), "stress", "f4"))
    data.SetTCoords(array(POSITION[:, :2], "uv", "f4"))
    pair = array(np.stack([IDS, -IDS], axis=1), "pair of numbers", "i4")
    pair.SetComponentName(0, "first")
    pair.SetComponentName(1, "second")
    data.AddArray(pair)
    text = vtk.vtkStringArray()
    text.SetName("text")
    bits = vtk.vtkBitArray()
    bits.SetName("bits")
    for i in range(COUNT):
        text.InsertNextValue("line one\nof " + str(i) * 70)
        bits.InsertNextValue(i % 2)
    data.AddArray(text)
    data.AddArray(bits)
    data.AddArray(array(IDS, "id", "i8"))
    data.AddArray(array(IDS, "small", "u1"))
    ids = vtk.vtkIdTypeArray()
    ids.SetName("GlobalIds")
    for value in IDS:
        ids.InsertNextValue(int(value))
    data.SetGlobalIds(ids)
    dataset.GetCellData().AddArray(array(DENSITY, "of_cells", "f8"))
    time = vtk.vtkDoubleArray()
    time.SetName("TimeValue")
    time.InsertNextValue(TIME)
    dataset.GetFieldData().AddArray(time)
    note = vtk.vtkStringArray()
    note.SetName("note")
    note.InsertNextValue("written by VTK")
    dataset.GetFieldData().AddArray(note)


def write_legacy(writer, dataset, name, version, binary):
    writer.SetInputData(dataset)
    writer.SetFileVersion(version)
    writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
    writer.SetFileName(str(HERE / name))
    assert writer.Write() == 1


def write_vtk():
    poly = vtk.vtkPolyData()
    poly.SetPoints(points("f4"))
    poly.SetVerts(cells())
    add_rich_data(poly)
    grid = vtk.vtkUnstructuredGrid()
    grid.SetPoints(points("f8"))
    grid.SetCells(vtk.VTK_VERTEX, cells())
    add_rich_data(grid)
    for version in (42, 51):
        for binary in (False, True):
            form = "binary" if binary else "ascii"
            write_legacy(vtk.vtkPolyDataWriter(), poly, f"polydata_{version}_{form}.vtk", version, binary)
            write_legacy(vtk.vtkUnstructuredGridWriter(), grid, f"grid_{version}_{form}.vtk", version, binary)


def write_ply():
    poly = vtk.vtkPolyData()
    poly.SetPoints(points("f4"))
    triangle = vtk.vtkCellArray()
    triangle.InsertNextCell(3)
    for i in range(3):
        triangle.InsertCellPoint(i)
    poly.SetPolys(triangle)
    poly.GetPointData().SetNormals(array(np.tile([0.0, 0.0, 1.0], (COUNT, 1)), "Normals", "f4"))
    colours = np.stack([INDEX * 40, 255 - INDEX * 40, 0 * INDEX], axis=1)
    poly.GetPointData().SetScalars(array(colours, "colours", "u1"))
    for form in ("ascii", "little", "big"):
        writer = vtk.vtkPLYWriter()
        writer.SetInputData(poly)
        writer.SetArrayName("colours")
        writer.SetFileTypeToASCII() if form == "ascii" else writer.SetFileTypeToBinary()
        writer.SetDataByteOrder(1 if form == "big" else 0)
        writer.SetFileName(str(HERE / f"mesh_{form}.ply"))
        assert writer.Write() == 1


def write_group(file, name, position, arrays):
    """One group as PySPH's output module writes it."""
    group = file.create_group(f"particles/{name}/arrays")
    file.create_group(f"particles/{name}/constants")
    for key, column in zip("xyz", position.T):
        arrays = {**arrays, key: column}
    for key, values in arrays.items():
        dataset = group.create_dataset(key, data=values)
        stride = len(values) // len(position) if len(values) else 1
        dataset.attrs.update({"name": key, "default": 0, "stored": len(values) > 0, "stride": stride, "type": "double"})
    return group


def write_hdf5():
    unused = np.zeros(0, np.float32)
    with h5py.File(HERE / "pysph.hdf5", "w") as file:
        file.create_group("solver_data").attrs.update({"count": 90, "dt": 1e-4, "t": TIME})
        write_group(file, "boundary", POSITION[:3] - 5, {"rho": DENSITY[:3]})
        write_group(file, "fluid", POSITION, {
            "u": VELOCITY[:, 0], "v": VELOCITY[:, 1], "w": VELOCITY[:, 2], "rho": DENSITY, "m": np.full(COUNT, 1 / 64 * 1000),
            "gid": IDS.astype(np.uint32), "tag": np.zeros(COUNT, np.int32), "au": unused, "gradient": np.arange(2.0 * COUNT),
            "spare": np.ones(3)})
        write_group(file, "zz_inlet", POSITION[:5], {})
    with h5py.File(HERE / "pysph_gzip.hdf5", "w", libver="latest") as file:
        # The time as an array, compressed big-endian values, and no group of the name fluid.
        file["solver_data/t"] = TIME
        for name, position in (("obstacle", POSITION), ("a_solid", POSITION), ("water", POSITION[:4])):
            for key, column in zip("xyz", position.T):
                file.create_dataset(f"particles/{name}/arrays/{key}", data=column.astype(">f8"), compression="gzip", shuffle=True)
    with h5py.File(HERE / "tiny.hdf5", "w", libver="latest") as file:
        for key, column in zip("xyz", POSITION.T):
            file[f"particles/fluid/arrays/{key}"] = column.astype(np.float32)
    with h5py.File(HERE / "other.hdf5", "w", libver="latest") as file:
        file["field/pressure"] = np.ones((4, 5))
        file["field/force"] = np.ones((4, 3))
        file["wind/speed"] = np.ones((2, 3))
    with h5py.File(HERE / "gadget.hdf5", "w", libver="latest") as file:
        file.create_group("Header").attrs.update({"Time": np.array([TIME]), "NumFilesPerSnapshot": 4})
        file["PartType0/Coordinates"], file["PartType0/Velocities"] = POSITION, VELOCITY.astype("f4")
        file["PartType0/Density"], file["PartType0/ParticleIDs"] = DENSITY, IDS.astype("u8")
        file["PartType1/Coordinates"] = POSITION[:3] - 9
    with h5py.File(HERE / "plain.hdf5", "w", libver="latest") as file:
        file["Position"] = POSITION.astype(">f8")
        file["vel"] = VELOCITY.astype("f2")
        file["rho"], file["half"] = DENSITY.astype(">i2"), np.arange(COUNT).astype("f2")
        file["words"] = np.array(["a"] * COUNT, dtype="S1")
        file["root"] = np.ones(3)
        for key, column in zip("abc", POSITION.T):
            file["odd/" + key] = column
    with h5py.File(HERE / "links.hdf5", "w", libver="latest") as file:
        file["hidden/data"] = POSITION
        file["water/pos"] = h5py.SoftLink("/hidden/data")
        file["water/outside"] = h5py.ExternalLink("tiny.hdf5", "/particles/fluid/arrays/x")
        file["outside_positions"] = h5py.ExternalLink("gadget.hdf5", "/PartType0/Coordinates")
        file["through"] = h5py.ExternalLink("gadget.hdf5", "/PartType0")
        file["through2"] = h5py.SoftLink("/through/Coordinates")
        file.create_dataset("stored_outside", (3, 3), "f8", external=[("elsewhere.bin", 0, 72)])
    with h5py.File(HERE / "circle.hdf5", "w", libver="latest") as file:
        file["a/b/c/points"] = POSITION
        file["a/b/again"] = file["a"]
        file["a/soft"] = h5py.SoftLink("/a/b")
    # In the older form, which has no checksums: damage reaches the reader.
    with h5py.File(HERE / "rank2.hdf5", "w") as file:
        file["pos"], file["mass"] = np.arange(21.0).reshape(7, 3), np.ones(7, "f4")
    with h5py.File(HERE / "packed.hdf5", "w") as file:
        file.create_dataset("pos", data=np.arange(21.0).reshape(7, 3), chunks=(7, 3), compression="gzip")
    with h5py.File(HERE / "absurd.hdf5", "w", libver="latest") as file:
        # Claims 2^40 values, stores none.
        for key in "xyz":
            file.create_dataset(f"particles/fluid/arrays/{key}", shape=(2**40,), chunks=(1024,), dtype="f8", compression="gzip")


if __name__ == "__main__":
    write_vtk()
    write_ply()
    write_hdf5()
