#!/usr/bin/python3
"""Every number of the known frames as h5py sees it, in /frames and in /VTKHDF: h5py_check.py FOLDER"""
import os
import sys
import xml.etree.ElementTree as xml

import h5py
import numpy as np

from known_frames import COMPONENTS, POINTS, position, values


def equal(found, expected, what):
    found, expected = np.asarray(found), np.asarray(expected)
    assert found.shape == expected.shape, f"{what}: shape {found.shape}, expected {expected.shape}"
    assert (found == expected).all(), f"{what}: {found[found != expected][:3]} …"


def check_views(file):
    assert list(file["frames"]) == [f"{k:06d}" for k in range(len(POINTS))]
    for k, (name, frame) in enumerate(file["frames"].items()):
        assert frame.attrs["time"] == 0.1 * k, name
        assert frame.attrs["stage"] == (b"at rest" if k < 2 else b"valve open"), name
        i = np.arange(POINTS[k])
        equal(frame["position"], position(k), f"{name} position")
        equal(frame["phase"], i % 2, f"{name} phase")
        equal(frame["body"], i % 3, f"{name} body")
        equal(frame["vertex"], i, f"{name} vertex")
        for field, components in COMPONENTS.items():
            equal(frame[field], values(k, components), f"{name} {field}")
            assert frame[field].dtype == np.float32 and frame["position"].dtype == np.float64


def check_vtkhdf(file):
    """As VTK's readers walk the file: rows of a frame from Steps."""
    root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
    assert list(root.attrs["Version"]) == [2, 0] and root.attrs["Type"] == b"PolyData"
    assert steps.attrs["NSteps"] == len(POINTS)
    equal(root["NumberOfPoints"], POINTS, "NumberOfPoints")
    equal(steps["Values"], [0.1 * k for k in range(len(POINTS))], "Values")
    equal(steps["PartOffsets"], range(len(POINTS)), "PartOffsets")
    equal(steps["NumberOfParts"], [1] * len(POINTS), "NumberOfParts")
    for k, count in enumerate(POINTS):
        first = steps["PointOffsets"][k]
        equal(root["Points"][first:first + count], position(k), f"Points {k}")
        for field, components in COMPONENTS.items():
            first = steps["PointDataOffsets"][field][k]
            equal(root["PointData"][field][first:first + count], values(k, components), f"{field} {k}")
        check_cells(root, steps, k, count)


def check_cells(root, steps, k, count):
    for kind, name in enumerate(["Vertices", "Lines", "Polygons", "Strips"]):
        cells = count if name == "Vertices" else 0
        group = root[name]
        assert group["NumberOfCells"][k] == cells and group["NumberOfConnectivityIds"][k] == cells
        cell_offset, id_offset = steps["CellOffsets"][k][kind], steps["ConnectivityIdOffsets"][k][kind]
        equal(group["Connectivity"][id_offset:id_offset + cells], range(cells), f"{name} connectivity {k}")
        # VTK 9.3 adds the number of parts before to find the offsets, later versions count those parts whose
        # cells lie before CellOffsets: both must arrive at the same row.
        counted, before = 0, 0
        for n in group["NumberOfCells"][:k]:
            if before >= cell_offset:
                break
            counted, before = counted + 1, before + n
        for parts in (k, counted):
            first = cell_offset + parts
            equal(group["Offsets"][first:first + cells + 1], range(cells + 1), f"{name} offsets {k}")


def check_series(file):
    n = 100 * len(POINTS)
    x = np.arange(n)
    for name, unit, value in (("probe.below", "Pa", x), ("section.pipe", "m/s", x[:, None] + [0.1, 0.2, 0.3]),
                              ("ledger.water_volume", "m³", -x)):
        group = file["series"][name]
        equal(group["time"], 1e-3 * x, f"{name} time")
        equal(group["value"], value, name)
        assert group["value"].attrs["unit"] in (unit, unit.encode()), name


def check_documents(file):
    assert file["run/case"][()] == '{"name": "größer"}'.encode()
    assert file["run/empty"][()] == b""
    assert file["run/report"][()] == b'{"status": "succeeded"}'


def check_xdmf(folder, file):
    """Each data item exists and has the dimensions and the number type that the XDMF promises."""
    grids = xml.parse(os.path.join(folder, "result.xdmf")).getroot().findall(".//Grid[@GridType='Uniform']")
    assert len(grids) == len(POINTS)
    for k, grid in enumerate(grids):
        assert float(grid.find("Time").get("Value")) == 0.1 * k
        items = grid.findall(".//DataItem")
        assert len(items) == (4 + len(COMPONENTS) if POINTS[k] else 0)
        for item in items:
            name, path = item.text.split(":")
            assert name == "result.vtkhdf"
            assert [int(n) for n in item.get("Dimensions").split()] == list(file[path].shape), path
            assert int(item.get("Precision")) == file[path].dtype.itemsize, path


def main():
    folder = sys.argv[1]
    left = sorted(os.listdir(folder))
    assert left == ["result.vtkhdf", "result.xdmf"], left
    with h5py.File(os.path.join(folder, "result.vtkhdf"), "r") as file:
        check_views(file)
        check_vtkhdf(file)
        check_series(file)
        check_documents(file)
        check_xdmf(folder, file)
    print(f"{len(POINTS)} frames, {sum(POINTS)} points: all values as written")


if __name__ == "__main__":
    main()
