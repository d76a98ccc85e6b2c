"""Fixtures: results of runs that lose points, and any result by the name of its fixture."""

import pytest
from post_runs import bar_deck

MOVING = "*MOVING MESH, DRIVER=X1, DIRECTION=1,0,0, FIXED=X0"
REMOVED = "*LOST POINTS, ACTION=REMOVE"


@pytest.fixture(scope="session")
def thinned(run_deck, tmp_path_factory):
    """The bar on a mesh that stays: points leave it during the run."""
    folder = tmp_path_factory.mktemp("thinned")
    return run_deck(folder, bar_deck().replace(MOVING, REMOVED))


@pytest.fixture(scope="session")
def emptied(run_deck, tmp_path_factory):
    """The bar, moved off its mesh in one increment: no point is left."""
    deck = bar_deck(strength="1e9").replace(MOVING, REMOVED)
    deck = deck.replace("X0, 1, 1\n", "X0, 1, 1, 40\n").replace("X1, 1, 1, 0.4", "X1, 1, 1, 40")
    return run_deck(tmp_path_factory.mktemp("emptied"), deck)


@pytest.fixture
def any_job(request, example):
    """Path of a job: of a shipped example with F-bar patches, or of one of the small runs."""
    if request.param in ("footing", "stretch", "strip-footing"):
        return example(request.param, "fbar")
    return request.getfixturevalue(request.param)
