"""Quantities from fields: names, components and invariants against numpy."""

import numpy as np
import pytest
from tessera_post.components import component_names
from tessera_post.errors import PostError
from tessera_post.fields import (
    CATEGORIES,
    find_quantity,
    mises,
    norm,
    parse,
    pressure,
    principal,
    quantities_of,
)

ORDER = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]  # 11, 22, 33, 12, 23, 13
PAIRS = ["11", "22", "33", "12", "23", "13"]


@pytest.fixture
def full():
    """(50, 3, 3) random symmetric tensors."""
    random = np.random.default_rng(7).normal(scale=100.0, size=(50, 3, 3))
    return random + np.swapaxes(random, 1, 2)


@pytest.fixture
def stored(full):
    """(50, 6) the same as they lie in the results."""
    return np.stack([full[:, i, j] for i, j in ORDER], axis=1)


def test_norm_is_that_of_the_full_tensor(full, stored):
    np.testing.assert_allclose(norm(stored), np.linalg.norm(full, axis=(1, 2)), rtol=1e-13)


def test_pressure_is_a_third_of_the_trace_and_positive_under_compression(full, stored):
    np.testing.assert_allclose(pressure(stored), -np.trace(full, axis1=1, axis2=2) / 3, rtol=1e-12)
    assert pressure(np.array([[-3.0, -3.0, -3.0, 0.0, 0.0, 0.0]])) == 3.0


def test_mises_is_the_root_of_three_halves_of_the_deviator(full, stored):
    mean = np.trace(full, axis1=1, axis2=2) / 3
    deviator = full - mean[:, None, None] * np.eye(3)
    expected = np.sqrt(1.5 * np.einsum("nij,nij->n", deviator, deviator))
    np.testing.assert_allclose(mises(stored), expected, rtol=1e-12)


def test_mises_of_uniaxial_tension_is_the_tension_and_of_shear_its_root_of_3():
    tension, shear = np.zeros((1, 6)), np.zeros((1, 6))
    tension[0, 1], shear[0, 4] = -7.0, 2.0
    assert mises(tension) == pytest.approx(7.0)
    assert mises(shear) == pytest.approx(2.0 * np.sqrt(3.0))


def test_mises_leaves_its_argument_as_it_is(stored):
    before = stored.copy()
    mises(stored)
    np.testing.assert_array_equal(stored, before)


def test_principal_values_ascend_and_are_those_of_the_full_tensor(full, stored):
    found = principal(stored)
    np.testing.assert_allclose(found, np.sort(np.linalg.eigvals(full).real, axis=1), rtol=1e-9)
    for name, column in (("S:max", 2), ("S:min", 0), ("TAU:max", 2)):
        quantity = find_quantity(name, ["S", "TAU"], "it")
        np.testing.assert_array_equal(quantity.evaluate(stored), found[:, column])


def test_invariants_of_no_points_are_empty():
    nothing = np.zeros((0, 6))
    for name in ("S", "S:mises", "S:pressure", "S:max", "S:min", "S12"):
        assert find_quantity(name, ["S"], "it").evaluate(nothing).shape == (0,)


@pytest.mark.parametrize("field", ["S", "TAU", "LE"])
def test_components_of_tensors_are_in_the_order_of_the_file(field, stored):
    assert component_names(field, 6) == PAIRS
    for i, pair in enumerate(PAIRS):
        for name in (field + pair, field + pair[::-1], f"{field}:{pair}"):
            quantity = find_quantity(name, [field], "it")
            assert quantity.field == field
            np.testing.assert_array_equal(quantity.evaluate(stored), stored[:, i])


def test_components_of_the_deformation_gradient_run_row_by_row():
    gradient = np.random.default_rng(1).normal(size=(5, 3, 3))
    rows = gradient.reshape(5, 9)
    assert component_names("F", 9) == [f"{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)]
    for i in range(3):
        for j in range(3):
            quantity = find_quantity(f"F{i + 1}{j + 1}", ["F"], "it")
            np.testing.assert_array_equal(quantity.evaluate(rows), gradient[:, i, j])


def test_components_of_vectors_and_their_magnitude():
    vectors = np.random.default_rng(2).normal(size=(5, 3))
    assert component_names("U", 3) == ["1", "2", "3"]
    for i in range(3):
        quantity = find_quantity(f"U{i + 1}", ["U"], "it")
        np.testing.assert_array_equal(quantity.evaluate(vectors), vectors[:, i])
    length = find_quantity("rf", ["RF"], "it").evaluate(vectors)
    np.testing.assert_allclose(length, np.sqrt((vectors**2).sum(axis=1)), rtol=1e-14)
    inc = find_quantity("U_INC2", ["U", "U_INC"], "it")
    assert (inc.field, inc.dimension) == ("U_INC", "length")


def test_fields_that_we_do_not_know_have_numbered_components():
    assert component_names("HEAT", 2) == ["_1", "_2"]
    assert component_names("HEAT", 1) == component_names("PEEQ", 1) == [""]


@pytest.mark.parametrize(
    ("text", "name", "field", "label", "dimension"),
    [
        ("s33", "S33", "S", "Cauchy stress 33", "stress"),
        ("S", "S:NORM", "S", "norm of Cauchy stress", "stress"),
        ("mises", "S:MISES", "S", "von Mises stress", "stress"),
        (" s:Mises ", "S:MISES", "S", "von Mises stress", "stress"),
        ("S mises", "S:MISES", "S", "von Mises stress", "stress"),
        ("pressure", "S:PRESSURE", "S", "pressure", "stress"),
        ("tau:PRESSURE", "TAU:PRESSURE", "TAU", "pressure of Kirchhoff stress", "stress"),
        ("TAU22", "TAU22", "TAU", "Kirchhoff stress 22", "stress"),
        ("le:max", "LE:MAX", "LE", "largest principal elastic log strain", "number"),
        ("peeq", "PEEQ", "PEEQ", "accumulated plastic strain", "number"),
        ("f31", "F31", "F", "deformation gradient 31", "number"),
        ("u", "U", "U", "displacement", "length"),
        ("Rf2", "RF2", "RF", "reaction 2", "force"),
        ("vol", "VOL", "VOL", "volume", "volume"),
    ],
)
def test_names_are_found_in_any_case(text, name, field, label, dimension):
    found = parse(text)
    assert (found.name, found.field, found.label, found.dimension) == (
        name,
        field,
        label,
        dimension,
    )


@pytest.mark.parametrize(
    "text", ["", ":", "S:", "S44", "S1", "S:water", "F", "F14", "U4", "U_INC0", "RF12", "PEEQ1"]
)
def test_names_that_mean_nothing_are_not_found(text):
    assert parse(text) is None
    with pytest.raises(PostError, match=r"'job\.vtkhdf' has no field"):
        find_quantity(text, ["S", "U", "F"], "'job.vtkhdf'")


def test_missing_field_names_those_there_are():
    with pytest.raises(PostError) as raised:
        find_quantity("TAU33", ["S", "PEEQ", "U", "F", "HEAT"], "'job.vtkhdf'")
    assert str(raised.value) == (
        "'job.vtkhdf' has no field 'TAU33': there are S11..S33, S:norm, S:pressure, S:mises,"
        " S:max, S:min, PEEQ, U, U1..U3, F11..F33"
    )
    with pytest.raises(PostError, match="has no field 'S': there are none"):
        find_quantity("S", [], "it")


def test_every_name_that_is_offered_is_found():
    fields = ["S", "TAU", "LE", "U", "U_INC", "RF", "F", "PEEQ", "J", "JBAR", "JPATCH", "VOL"]
    for name in quantities_of([*fields, *CATEGORIES]):
        for end in name.split(".."):
            assert parse(end) is not None, name


def test_numbers_of_things_are_categories_and_become_real():
    for name in CATEGORIES:
        quantity = parse(name)
        assert quantity.is_category
        assert quantity.evaluate(np.array([1, 2], dtype=np.int32)).dtype == float
    assert not parse("NPOINTS").is_category
