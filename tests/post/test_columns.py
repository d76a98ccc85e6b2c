"""Columns of the history: names, ambiguity, words and what is worth seeing first."""

import numpy as np
import pytest
from tessera_post.columns import column_names, default_pair, describe, find_column
from tessera_post.errors import PostError
from tessera_post.job import open_job


class FakeJob:
    """A job of which only the history matters."""

    name = "job"

    def __init__(self, **columns):
        rows = len(next(iter(columns.values()), [0.0]))
        counted = {name: np.arange(rows) for name in ("increment", "step", "time")}
        self.history = {**columns, **counted}


def fake(**columns):
    """A job with columns named SET for [SET]: RF1_A is RF1[A]."""
    return FakeJob(
        **{name.replace("_", "[") + "]": np.array(values) for name, values in columns.items()}
    )


@pytest.fixture
def job(bar):
    return open_job(str(bar))


def test_counting_columns_come_first(job):
    assert column_names(job) == "step increment time RF1[X1] RF2[X1] U1[X1] U2[X1]".split()


@pytest.mark.parametrize("text", ["RF1[X1]", "rf1[x1]", " RF1 ", "rf1"])
def test_column_is_found_in_any_case_and_without_its_set(job, text):
    column = find_column(job, text)
    assert (column.name, column.label, column.dimension) == (
        "RF1[X1]",
        "reaction 1 of X1",
        "force",
    )
    np.testing.assert_array_equal(column.values, job.history["RF1[X1]"])


def test_missing_column_names_those_there_are(job):
    with pytest.raises(PostError) as raised:
        find_column(job, "RF3")
    assert str(raised.value) == (
        "the history of 'bar' has no column 'RF3': expected one of step, increment, time,"
        " RF1[X1], RF2[X1], U1[X1], U2[X1]"
    )


def test_name_without_set_must_mean_one_column():
    two = fake(RF1_A=[0.0, 1.0], RF1_B=[0.0, 2.0])
    with pytest.raises(PostError) as raised:
        find_column(two, "rf1")
    assert str(raised.value) == (
        "the history of 'job' has more than one column 'rf1': expected one of RF1[A], RF1[B]"
    )
    assert find_column(two, "RF1[b]").values[1] == 2.0


def test_increment_counts_over_all_steps():
    job = fake(RF1_A=[0.0, 1.0, 2.0])
    job.history["increment"] = np.array([0, 1, 1])
    np.testing.assert_array_equal(find_column(job, "increment").values, [0, 1, 2])
    np.testing.assert_array_equal(job.history["increment"], [0, 1, 1])


@pytest.mark.parametrize(
    ("name", "label", "generic", "dimension"),
    [
        ("RF3[FOOTING]", "reaction 3 of FOOTING", "reaction", "force"),
        ("CF1[TOP]", "applied force 1 of TOP", "applied force", "force"),
        ("U2[TOP]", "displacement 2 of TOP", "displacement", "length"),
        ("U2[0.5 1 0]", "displacement 2 of 0.5 1 0", "displacement", "length"),
        ("S12[0 0 0]", "Cauchy stress 12 at 0 0 0", "Cauchy stress", "stress"),
        (
            "PEEQ[0 0 0]",
            "accumulated plastic strain at 0 0 0",
            "accumulated plastic strain",
            "number",
        ),
        ("HEAT[A]", "HEAT[A]", "HEAT[A]", "number"),
    ],
)
def test_columns_are_told_in_words(name, label, generic, dimension):
    assert describe(name) == (label, generic, dimension)


def test_reaction_over_displacement_of_the_same_set_comes_first(job):
    assert default_pair(job) == ("U1[X1]", "RF1[X1]")


def test_driven_set_is_shown_not_the_one_that_reacts():
    base = fake(RF2_BASE=[0, 9.0], U2_BASE=[0, 0.0], RF2_TOP=[0, -8.0], U2_TOP=[0, -1.0])
    assert default_pair(base) == ("U2[TOP]", "RF2[TOP]")


def test_largest_reaction_over_time_without_displacements():
    job = fake(RF1_A=[0, 1.0], RF2_A=[0, -3.0], PEEQ_A=[0, 9.0])
    assert default_pair(job) == ("time", "RF2[A]")


def test_first_column_over_time_without_reactions():
    assert default_pair(fake(PEEQ_A=[0, 9.0], S11_A=[0, 1.0])) == ("time", "PEEQ[A]")


def test_history_without_columns_is_an_error():
    with pytest.raises(PostError) as raised:
        default_pair(FakeJob())
    assert str(raised.value) == "the history of 'job' has no columns: the deck asks for none"
