"""Every number of the known frames as ParaView's XDMF readers see it: pvpython paraview_check.py FOLDER"""
import os
import sys

import numpy as np
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from known_frames import COMPONENTS, POINTS, position, values  # noqa: E402


def leaf(data):
    return leaf(data.GetBlock(0)) if data.IsA("vtkMultiBlockDataSet") else data


def check_frame(data, k, what):
    assert data.GetNumberOfPoints() == POINTS[k], f"{what}: {data.GetNumberOfPoints()} points"
    assert data.GetNumberOfCells() == POINTS[k], f"{what}: {data.GetNumberOfCells()} cells"
    if not POINTS[k]:
        return
    assert (vtk_to_numpy(data.GetPoints().GetData()) == position(k)).all(), f"{what}: positions"
    i = np.arange(POINTS[k])
    expected = {name: values(k, components) for name, components in COMPONENTS.items()}
    expected.update(phase=i % 2, body=i % 3)
    for name, numbers in expected.items():
        found = vtk_to_numpy(data.GetPointData().GetArray(name))
        assert found.shape == numbers.shape and (found == numbers).all(), f"{what}: {name}"


def main():
    path = os.path.join(sys.argv[1], "result.xdmf")
    readers = {"XDMFReader": simple.XDMFReader(FileNames=[path]),
               "Xdmf3ReaderS": simple.Xdmf3ReaderS(FileName=[path]),
               "Xdmf3ReaderT": simple.Xdmf3ReaderT(FileName=[path])}
    for name, reader in readers.items():
        reader.UpdatePipelineInformation()
        times = list(reader.TimestepValues)
        assert np.allclose(times, [0.1 * k for k in range(len(POINTS))], rtol=1e-12, atol=0), f"{name}: {times}"
        for k, time in enumerate(times):
            reader.UpdatePipeline(time)
            check_frame(leaf(servermanager.Fetch(reader)), k, f"{name}, frame {k}")
        print(f"{name}: {len(POINTS)} frames as written")


main()
