"""Measures of a job beside another one of the same case."""

import numpy as np
from tessera_post.job import SAME_TIME, SUFFIX, Job


def ratio_to_sibling(job: Job, sibling: str, column: str, time: float) -> float:
    """A column of the history over that of another job, both at a time."""
    other = Job(job.folder / f"{sibling}{SUFFIX}")
    try:
        return history_at(job, column, time) / history_at(other, column, time)
    finally:
        other.close()


def history_at(job: Job, column: str, time: float) -> float:
    """A column of the history at the end of an increment. ValueError when none ends there."""
    rows = np.flatnonzero(np.isclose(job.history["time"], time, rtol=SAME_TIME, atol=0.0))
    if len(rows) != 1:
        raise ValueError(f"no increment of {job.name} ends at {time:g}")
    return float(job.history[column][rows[0]])
