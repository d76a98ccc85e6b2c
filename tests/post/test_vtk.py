"""Results read through VTK, through h5py and by tessera_post.series: the same numbers."""

from pathlib import Path

import numpy as np
import pytest
from raw_results import raw_outputs
from tessera_post.series import Series
from test_results import Series as VtkSeries

pytest_plugins = ["lost_point_runs"]
FILES = [".vtkhdf", "_mesh.vtkhdf"]
JOBS = ["footing", "stretch", "strip-footing", "bar", "single", "killed", "thinned", "emptied"]


@pytest.mark.parametrize("ending", FILES)
@pytest.mark.parametrize("any_job", JOBS, indirect=True)
def test_every_field_of_every_time_is_the_same_through_vtk_and_h5py(any_job, ending):
    path = Path(f"{any_job}{ending}")
    raw = raw_outputs(path)
    vtk, ours = VtkSeries(path), Series(path)
    assert list(vtk.times) == [output.time for output in raw] == list(ours.times)
    for step, output in enumerate(raw):
        grid = vtk.at(output.time)
        np.testing.assert_array_equal(grid.points, output.points)
        np.testing.assert_array_equal(ours.points(step), output.points)
        np.testing.assert_array_equal(grid.cell_connectivity, output.connectivity)
        np.testing.assert_array_equal(ours.cells(step).ravel(), output.connectivity)
        assert set(grid.celltypes) <= {ours.cell_type}
        assert set(grid.point_data) | set(grid.cell_data) == set(output.fields)
        assert set(ours.field_names) == set(output.fields)
        for name, values in output.fields.items():
            np.testing.assert_array_equal(grid[name], values, err_msg=name)
            np.testing.assert_array_equal(ours.field(name, step), values, err_msg=name)


@pytest.mark.parametrize(("any_job", "n_times"), [("bar", 5), ("single", 2)], indirect=["any_job"])
def test_all_times_of_a_run_are_there(any_job, n_times):
    for ending in FILES:
        assert len(VtkSeries(f"{any_job}{ending}").times) == n_times


def test_points_that_are_removed_leave_the_outputs(thinned, emptied):
    counts = [len(output.fields["ID"]) for output in raw_outputs(f"{thinned}.vtkhdf")]
    assert counts[0] == 96
    assert 0 < counts[-1] < 96
    assert [len(output.points) for output in raw_outputs(f"{emptied}.vtkhdf")] == [96, 0, 0, 0, 0]
