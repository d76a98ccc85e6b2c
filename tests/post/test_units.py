"""Units of axes from the labels of *UNITS."""

import pytest
from tessera_post.units import Units, conversion


@pytest.mark.parametrize(
    ("text", "length", "force"),
    [
        ("length m force kN", "m", "kN"),
        ("length mm force N", "mm", "N"),
        ("length m", "m", ""),
        ("force kN", "", "kN"),
        ("length in the model force pound force", "in the model", "pound force"),
        ("  length m force kN ", "m", "kN"),
        ("", "", ""),
        ("none", "", ""),
    ],
)
def test_labels_are_read_from_the_results(text, length, force):
    assert Units.from_text(text, 3) == Units(length, force, 3)


@pytest.mark.parametrize(
    ("length", "force", "stress"),
    [
        ("m", "N", "Pa"),
        ("m", "kN", "kPa"),
        ("m", "MN", "MPa"),
        ("mm", "N", "MPa"),
        ("mm", "kN", "GPa"),
        ("ft", "lb", "lb/ft²"),
        ("", "", "force/length²"),
    ],
)
def test_stress_has_the_unit_of_force_over_area(length, force, stress):
    assert Units(length, force, 3).of("stress") == stress
    assert Units(length, force, 2).of("stress") == stress


def test_forces_and_volumes_are_per_thickness_in_plane_strain():
    solid, plane = Units("m", "kN", 3), Units("m", "kN", 2)
    assert (solid.of("force"), plane.of("force")) == ("kN", "kN/m")
    assert (solid.of("volume"), plane.of("volume")) == ("m³", "m²")
    assert (solid.of("length"), plane.of("length")) == ("m", "m")


def test_deck_without_units_has_words_on_its_axes():
    assert Units().of("length") == "length"
    assert Units(n_dim=2).of("force") == "force/length"
    assert Units().of("volume") == "length³"


def test_numbers_have_a_dash():
    assert Units("m", "kN").of("number") == "-"
    assert Units("m", "kN").axis("plastic strain", "number") == "plastic strain [-]"


def test_axis_names_quantity_and_unit():
    units = Units("m", "kN", 3)
    assert units.axis("displacement 3", "length") == "displacement 3 [m]"
    assert units.axis("displacement 3", "length", "mm") == "displacement 3 [mm]"


@pytest.mark.parametrize(
    ("old", "new", "factor"),
    [
        ("m", "mm", 1e3),
        ("mm", "m", 1e-3),
        ("m", "cm", 1e2),
        ("kN", "N", 1e3),
        ("kN", "MN", 1e-3),
        ("kPa", "MPa", 1e-3),
        ("GPa", "Pa", 1e9),
        ("kN/m", "N/m", 1e3),
        ("m", "m", 1.0),
    ],
)
def test_factor_between_units_of_a_kind(old, new, factor):
    assert conversion(old, new) == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize(
    ("old", "new"),
    [("m", "N"), ("kN", "kPa"), ("kN", "kN/m"), ("m", "ft"), ("ft", "m"), ("", "m"), ("m", "")],
)
def test_units_of_different_kinds_have_no_factor(old, new):
    assert conversion(old, new) is None
