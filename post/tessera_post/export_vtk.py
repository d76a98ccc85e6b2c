"""export JOB vtk: one .vtu file per output, and .pvd collections with the times."""

from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkObject, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

from tessera_post.cli import tell, wrote
from tessera_post.errors import PostError
from tessera_post.export_files import Batch, refuse_existing
from tessera_post.job import Job
from tessera_post.series import Series


def export_vtk(job: Job, folder: Path, force: bool) -> None:
    """Writes points and mesh of all outputs to a folder; the .pvd files are what to open."""
    tell(job.notes)
    if folder.exists() and not folder.is_dir():
        raise PostError(f"'{folder}' is a file: expected a folder")
    collections = {job.name: job.points}
    if job.mesh is not None:
        collections[f"{job.name}_mesh"] = job.mesh
    refuse_existing(
        (
            path
            for name, series in collections.items()
            for path in (folder / f"{name}.pvd", *grid_paths(folder, name, series))
        ),
        force,
    )
    with Batch() as batch:
        batch.make_folder(folder)
        for name, series in collections.items():
            write_collection(batch, folder / f"{name}.pvd", name, series)
    for name, series in collections.items():
        wrote(folder / f"{name}.pvd")
        print(f"  with {series.n_steps} files {name}_*.vtu beside it")


def grid_paths(folder: Path, name: str, series: Series) -> list[Path]:
    """The files of the outputs of a series."""
    return [folder / f"{name}_{output:04d}.vtu" for output in range(series.n_steps)]


def write_collection(batch: Batch, path: Path, name: str, series: Series) -> None:
    """Writes all outputs of a series and the file that lists them with their times."""
    lines = [
        '<?xml version="1.0"?>',
        '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">',
        "  <Collection>",
    ]
    for output, file in enumerate(grid_paths(path.parent, name, series)):
        write_grid(make_grid(series, output), batch.open_name(file), file)
        time = float(series.times[output])
        lines.append(
            f'    <DataSet timestep="{time!r}" group="" part="0" file={quoteattr(file.name)}/>'
        )
    lines += ["  </Collection>", "</VTKFile>", ""]
    batch.open_name(path).write_text("\n".join(lines), encoding="utf-8")


def make_grid(series: Series, output: int) -> vtkUnstructuredGrid:
    """The grid of an output with all fields, in the precision of the file."""
    grid = vtkUnstructuredGrid()
    points = vtkPoints()
    points.SetData(numpy_to_vtk(series.points(output), deep=True))
    grid.SetPoints(points)
    connectivity = series.cells(output)
    cells = vtkCellArray()
    cells.SetData(connectivity.shape[1], numpy_to_vtkIdTypeArray(connectivity.ravel(), deep=True))
    grid.SetCells(series.cell_type, cells)
    for data, names in (
        (grid.GetPointData(), series.point_fields),
        (grid.GetCellData(), series.cell_fields),
    ):
        for name in names:
            values = numpy_to_vtk(np.ascontiguousarray(series.field(name, output)), deep=True)
            values.SetName(name)
            data.AddArray(values)
    return grid


def write_grid(grid: vtkUnstructuredGrid, temporary: Path, path: Path) -> None:
    """Writes a grid, binary and compressed. Raises PostError when that fails."""
    vtkObject.GlobalWarningDisplayOff()  # VTK would print the failure that is told below
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(temporary))
    writer.SetInputData(grid)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToZLib()
    writer.SetHeaderTypeToUInt64()
    if writer.Write() != 1 or writer.GetErrorCode() != 0:
        raise PostError(f"cannot write '{path}': no permission, or no space left")
