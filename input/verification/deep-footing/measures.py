"""What the ledger and the attempts of a run tell."""

import numpy as np


def points_lost(job):
    """Points that are gone at the end of the run."""
    return float(job.ledger["lost"][-1])


def cut_backs(job):
    """Attempts that failed, over the whole run."""
    table = job.iterations
    increment = np.stack([table["step"], table["increment"]], axis=1)
    attempt = np.column_stack([increment, table["attempt"]])
    return float(len(np.unique(attempt, axis=0)) - len(np.unique(increment, axis=0)))
