"""Finding jobs and reading them."""

import numpy as np
import pytest
from tessera_post.errors import PostError
from tessera_post.job import open_job, open_jobs


def test_job_is_found_by_any_of_its_files(bar):
    names = ["bar", "bar.inp", "bar.vtkhdf", "bar_mesh.vtkhdf", "bar.log", "bar_history.csv"]
    for name in names:
        assert open_job(str(bar.parent / name)).name == "bar"
    assert len(open_jobs([str(bar.parent / name) for name in names])) == 1


def test_name_of_a_comparison_means_both_jobs(run_deck, tmp_path):
    from post_runs import bar_deck

    path = run_deck(tmp_path, bar_deck(), "--compare", "standard,fbar")
    jobs = open_jobs([str(path)])
    assert [job.name for job in jobs] == ["bar_standard", "bar_fbar"]
    assert [job.formulation for job in jobs] == ["standard MPM", "F-bar patch"]
    with pytest.raises(PostError, match=r"more than one job: expected '.*bar_standard' or '.*bar_"):
        open_job(str(path))


def test_increments_and_times_choose_outputs(run_deck, tmp_path):
    from post_runs import bar_deck

    job = open_job(str(run_deck(tmp_path, bar_deck(size=0.125, every=3))))
    np.testing.assert_array_equal(job.increments, [0, 3, 6, 8])
    assert job.output_of() == 3
    assert job.output_of(increment=3) == 1
    assert job.output_of(increment=-2) == 2
    assert job.output_of(time=0.75) == 2
    with pytest.raises(PostError, match="no output at increment 4: there are 0, 3, 6, 8"):
        job.output_of(increment=4)
    with pytest.raises(PostError, match=r"no output at time 0.5: there are 0, 0.375, 0.75, 1"):
        job.output_of(time=0.5)


def test_killed_job_is_read_as_far_as_it_goes(killed):
    job = open_job(str(killed))
    assert job.is_unfinished
    assert job.n_increments >= 8
    assert any("has not finished" in note for note in job.notes)
    assert np.isfinite(job.points.field("S", job.output_of())).all()
