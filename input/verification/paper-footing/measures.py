"""Measures of the footing."""

import numpy as np


def growth(job):
    """Growth of the reaction from 1 mm to 2 mm of settlement: none at a limit load."""
    settlement = np.abs(job.history["U3[FOOTING]"])
    reaction = np.abs(job.history["RF3[FOOTING]"])
    half, full = np.interp([1.0e-3, 2.0e-3], settlement, reaction)
    return full / half - 1.0
