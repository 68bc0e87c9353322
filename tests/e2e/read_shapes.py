# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens exported shapes as MeshLab, CloudCompare and ParaView do, and compares them with an HDF5 export.

read_shapes.py EXPORT.h5 FOLDER: FOLDER holds ITEM.csv, ITEM.ply and ITEM.vtp of every item of the export. Prints
"ok: N items" or says what is wrong. Points, normals and faces are read by VTK; the further properties of a PLY file,
which VTK passes over, by its header.
"""

import pathlib
import sys

try:
    import h5py
    import numpy
    import pandas
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOPLY import vtkPLYReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError as error:
    sys.exit(f"{error}: install python3-h5py, python3-pandas and python3-vtk9 (scripts/setup does)")

PLY_TYPES = {"double": "<f8", "float": "<f4"}


def expect(same, path, what):
    if not same:
        sys.exit(f"{path}: {what} differs from the export")


def expected(item):
    """Points, normals, faces (None where there are none) and the fields of an item of the export."""
    mesh = "mesh" in item
    points = item["mesh/vertices"][:] if mesh else item["scan/points"][:]
    normals = item["normals/normals" if mesh else "scan_normals/normals"][:]
    faces = item["mesh/faces" if mesh else "surface/faces"][:]
    truth = item["ground_truth" if mesh else "scan_ground_truth"]
    fields = {"ground_truth": truth["saliency"][:],
              "picks": numpy.bincount(truth["picks"][:], minlength=len(points)).astype(float)}
    for stage in item:
        if stage.split(".")[0] in ("map", "matched"):
            fields[stage.replace(".", "_")] = item[stage]["saliency"][:]
    return points, normals, faces, fields


def read_by(reader, path):
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def faces_of(data):
    cells = data.GetPolys()
    if cells.GetNumberOfCells() == 0:
        return numpy.zeros((0, 3))
    offsets = vtk_to_numpy(cells.GetOffsetsArray())
    expect((numpy.diff(offsets) == 3).all(), "faces", "their size")
    return vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, 3)


def check_vtp(path, points, normals, faces, fields):
    data = read_by(vtkXMLPolyDataReader(), path)
    at_points = data.GetPointData()
    expect(numpy.array_equal(vtk_to_numpy(data.GetPoints().GetData()), points), path, "points")
    expect(numpy.array_equal(vtk_to_numpy(at_points.GetNormals()), normals), path, "normals")
    expect(numpy.array_equal(faces_of(data), faces), path, "faces")
    expect(data.GetNumberOfVerts() == (0 if len(faces) else len(points)), path, "the number of vertex cells")
    expect(at_points.GetNumberOfArrays() == 1 + len(fields), path, "the number of fields")
    for name, values in fields.items():
        expect(numpy.array_equal(vtk_to_numpy(at_points.GetArray(name)), values), path, name)


def ply_vertices(path):
    header, _, body = path.read_bytes().partition(b"end_header\n")
    count, columns = 0, []
    for line in header.decode().splitlines():
        words = line.split()
        if words[:2] == ["element", "vertex"]:
            count = int(words[2])
        if words[0] == "property" and words[1] in PLY_TYPES:
            columns.append((words[2], PLY_TYPES[words[1]]))
    return numpy.frombuffer(body, dtype=columns, count=count)


def check_ply(path, points, normals, faces, fields):
    data = read_by(vtkPLYReader(), path)
    single = numpy.float32  # what VTK keeps of a PLY file
    expect(numpy.array_equal(vtk_to_numpy(data.GetPoints().GetData()), points.astype(single)), path, "points")
    expect(numpy.array_equal(vtk_to_numpy(data.GetPointData().GetNormals()), normals.astype(single)), path, "normals")
    expect(numpy.array_equal(faces_of(data), faces), path, "faces")
    vertices = ply_vertices(path)
    for axis, name in enumerate("xyz"):
        expect(numpy.array_equal(vertices[name], points[:, axis]), path, name)
    expect(set(vertices.dtype.names) == {"x", "y", "z", "nx", "ny", "nz", *fields}, path, "the set of properties")
    for name, values in fields.items():
        expect(numpy.array_equal(vertices[name], values.astype(single)), path, name)


def check_csv(path, points, normals, fields):
    table = pandas.read_csv(path, float_precision="round_trip")
    expect(numpy.array_equal(table[["x", "y", "z"]], points), path, "points")
    expect(numpy.array_equal(table[["nx", "ny", "nz"]], normals), path, "normals")
    expect(list(table.columns[6:]) == sorted(fields, key=list(table.columns).index), path, "the set of columns")
    for name, values in fields.items():
        expect(numpy.array_equal(table[name], values), path, name)


def main():
    folder = pathlib.Path(sys.argv[2])
    with h5py.File(sys.argv[1], "r") as file:
        items = {name: item for name, item in file.items() if "dataset" in item.attrs}
        for name, item in items.items():
            points, normals, faces, fields = expected(item)
            check_vtp(folder / f"{name}.vtp", points, normals, faces, fields)
            check_ply(folder / f"{name}.ply", points, normals, faces, fields)
            check_csv(folder / f"{name}.csv", points, normals, fields)
    print(f"ok: {len(items)} items")


main()
