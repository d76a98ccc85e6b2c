"""The turn between the level decks and the inclined ones; make_decks.py and measures.py use it."""

import numpy as np

SLOPE = 30.0  # degrees: the plane against the horizontal
BEARING = 20.0  # degrees: its steepest line against the x axis, in 3-D


def turn(n_dim):
    """(3, 3) rotation: columns are the directions up the plane, across it and off it (2-D: the
    third is normal to the drawing)."""
    c, s = np.cos(np.radians(SLOPE)), np.sin(np.radians(SLOPE))
    if n_dim == 2:
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    cb, sb = np.cos(np.radians(BEARING)), np.sin(np.radians(BEARING))
    up = np.array([c * cb, c * sb, s])
    across = np.array([-sb, cb, 0.0])
    return np.column_stack([up, across, np.cross(up, across)])
