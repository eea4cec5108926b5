#!/usr/bin/python3
"""Makes the samples of VTK's XML formats beside it by VTK's own writers: the particles of make_samples.py, in doubles
in grids (.vtu) and in floats in polygonal data (.vtp). Needs Debian's python3-vtk9."""
import vtk

from make_samples import COUNT, DENSITY, HERE, IDS, POSITION, TIME, VELOCITY, array, cells, points


def dataset(kind, begin=0, end=COUNT):
    """The particles from `begin` to `end`."""
    if kind == "vtu":
        data = vtk.vtkUnstructuredGrid()
        chosen = vtk.vtkPoints()
        chosen.SetDataType(vtk.VTK_DOUBLE)
        chosen.SetData(array(POSITION[begin:end], "points", "f8"))
        data.SetPoints(chosen)
        data.Allocate(end - begin)
        for i in range(end - begin):
            data.InsertNextCell(vtk.VTK_VERTEX, 1, [i])
    else:
        data = vtk.vtkPolyData()
        data.SetPoints(points("f4"))
        data.SetVerts(cells())
    arrays = data.GetPointData()
    arrays.SetVectors(array(VELOCITY[begin:end], "velocity", "f4"))
    arrays.SetScalars(array(DENSITY[begin:end], "rho", "f8"))
    for name, dtype in (("id", "i8"), ("i8", "i1"), ("u8", "u1"), ("i16", "i2"), ("u16", "u2"), ("i32", "i4"),
                        ("u32", "u4"), ("u64", "u8")):
        arrays.AddArray(array(IDS[begin:end], name, dtype))
    text = vtk.vtkStringArray()
    text.SetName("text")
    for i in range(begin, end):
        text.InsertNextValue(f"line {i} <&>")
    arrays.AddArray(text)
    data.GetCellData().AddArray(array(DENSITY[begin:end], "of_cells", "f8"))
    time = vtk.vtkDoubleArray()
    time.SetName("TimeValue")
    time.InsertNextValue(TIME)
    data.GetFieldData().AddArray(time)
    return data


def write(name, form="appended", base64=False, zlib=False, header=32, big=False, block=32768, begin=0, end=COUNT):
    kind = name.split(".")[-1]
    writer = vtk.vtkXMLUnstructuredGridWriter() if kind == "vtu" else vtk.vtkXMLPolyDataWriter()
    writer.SetInputData(dataset(kind, begin, end))
    {"ascii": writer.SetDataModeToAscii, "inline": writer.SetDataModeToBinary,
     "appended": writer.SetDataModeToAppended}[form]()
    writer.SetEncodeAppendedData(base64)
    writer.SetCompressorTypeToZLib() if zlib else writer.SetCompressorTypeToNone()
    writer.SetHeaderType(header)
    writer.SetByteOrderToBigEndian() if big else writer.SetByteOrderToLittleEndian()
    writer.SetBlockSize(block)
    writer.SetFileName(str(HERE / name))
    assert writer.Write() == 1


def write_parallel():
    """A .pvtu of VTK's writer; its pieces, which that writer would give all points each, are parted here."""
    writer = vtk.vtkXMLPUnstructuredGridWriter()
    writer.SetInputData(dataset("vtu"))
    writer.SetNumberOfPieces(2)
    writer.SetStartPiece(0)
    writer.SetEndPiece(1)
    writer.SetFileName(str(HERE / "parallel.pvtu"))
    assert writer.Write() == 1
    write("parallel_0.vtu", "ascii", end=3)
    write("parallel_1.vtu", base64=True, zlib=True, begin=3)


def write_two_pieces():
    """One file with the pieces of two."""
    texts = []
    for begin, end in ((0, 3), (3, COUNT)):
        write("two_pieces.vtu", "ascii", begin=begin, end=end)
        texts.append((HERE / "two_pieces.vtu").read_text())
    begin, end = texts[1].index("    <Piece"), texts[1].index("  </UnstructuredGrid>")
    at = texts[0].index("  </UnstructuredGrid>")
    (HERE / "two_pieces.vtu").write_text(texts[0][:at] + texts[1][begin:end] + texts[0][at:])


def write_lz4():
    writer = vtk.vtkXMLPolyDataWriter()
    writer.SetInputData(dataset("vtp"))
    writer.SetCompressorTypeToLZ4()
    writer.SetFileName(str(HERE / "lz4.vtp"))
    assert writer.Write() == 1


if __name__ == "__main__":
    write("ascii.vtp", "ascii")
    write("inline_64.vtp", "inline", header=64)
    write("inline_zlib.vtu", "inline", zlib=True, block=40)
    write("raw_big.vtu", big=True)
    write("raw_zlib_64.vtu", zlib=True, header=64, block=64)
    write("base64_zlib_big.vtu", base64=True, zlib=True, big=True)
    write("base64_64.vtp", base64=True, header=64)
    write_two_pieces()
    write_parallel()
    write_lz4()
