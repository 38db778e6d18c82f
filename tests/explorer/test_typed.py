"""What a text in the command palette sets or shows."""

from __future__ import annotations

import math
from typing import Any

import pytest

from paminsa_viz.explorer.kit.entries import Then
from paminsa_viz.explorer.state.pins import IMBALANCE
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.tabs import places_to_go
from paminsa_viz.explorer.typed import meaning, named
from paminsa_viz.model import PARAMETERS, InvalidInput


def done(text: str) -> State:
    """Return the state after what a text means."""
    found = meaning(text)
    assert found is not None, text
    assert found.effect is not None, text
    action: Any = found.effect.action if isinstance(found.effect, Then) else found.effect
    return action(initial_state())


@pytest.mark.parametrize(
    ("text", "path", "value"),
    [
        ("m7 3.063", "joints.j7", 3.063),
        ("m_7 = 3,5 kg", "joints.j7", 3.5),
        ("R_b 370 mm", "geometry.base_radius", 0.37),
        ("R_b 0.4 m", "geometry.base_radius", 0.4),
        ("R_b 37cm", "geometry.base_radius", 0.37),
        ("m7 3063 g", "joints.j7", 3.063),
        ("m_B3 1.5", "links.b3", 1.5),
        ("b4 3", "friction.viscous_linear", 3.0),
        ("M_x -2 N m", "load.moment_x", -2.0),
        ("g 9.81 m/s^2", "gravity", 9.81),
    ],
)
def test_symbol_with_number_sets_it(text: str, path: str, value: float) -> None:
    assert done(text).document.design.value(path) == pytest.approx(value)


def test_every_parameter_is_set_by_its_symbol() -> None:
    for parameter in PARAMETERS:
        shown = parameter.display.from_si(parameter.default or 0.01)
        name = parameter.symbol.partition(" =")[0]
        after = done(f"{name} {shown * 1.001:.9f} {parameter.display.text}")
        changed = after.document.design.value(parameter.path)
        assert changed == pytest.approx((parameter.default or 0.01) * 1.001, rel=1e-6), name


def test_pose_is_typed_in_the_units_that_are_shown() -> None:
    assert done("theta 60").document.pose[2] == pytest.approx(math.pi / 3)
    assert done("x \u221250 mm").document.pose[0] == pytest.approx(-0.05)
    assert done("x \u22120.05 m").document.pose[0] == pytest.approx(-0.05)
    assert done("theta 0.5 rad").document.pose[2] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("text", "quantity"),
    [
        ("map stiffness z", "stiffness_z"),
        ("Map Condition", "condition"),
        ("map kappa", "condition"),
        ("map tau m2", "tau_2"),
        ("map worst error theta", "error_theta"),
        ("map yield stress", "utilization"),
    ],
)
def test_words_after_map_name_a_quantity(text: str, quantity: str) -> None:
    assert done(text).map_view.quantity == quantity


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("pin clearance", "clearance"),
        ("Pin kappa", "condition"),
        ("pin m7", "joints.j7"),
        ("pin R_b", "geometry.base_radius"),
        ("pin M_p2", IMBALANCE),
        ("pin first natural", "frequency_1"),
    ],
)
def test_words_after_pin_name_a_number_of_the_strip(text: str, key: str) -> None:
    assert done(text).pins.settings.keys == (key,)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("m7 3,063", "thousand or a fraction"),
        ("m7 3 mm", "m₇ is set in kg, not in mm"),
        ("k 3 mm", "k is set without a unit, not in mm"),
        ("m7 1e400", "finite"),
    ],
)
def test_what_cannot_be_set_says_why(text: str, reason: str) -> None:
    found = meaning(text)
    assert found is not None
    assert found.effect is None
    assert reason in found.label


@pytest.mark.parametrize(
    "text",
    [
        "",
        "m7",
        "rb3",
        "stiff",
        "map",
        "map -",
        "pin",
        "pin x",
        "nothing 5",
        "M7 3",
        "x" * 101,
        "μ 3",
    ],
)
def test_a_search_means_nothing_else(text: str) -> None:
    assert meaning(text) is None


def test_an_impossible_value_is_refused_by_the_name_typed() -> None:
    with pytest.raises(InvalidInput, match="m₇"):
        done("m7 -1")


NAMES = [command.name for command in places_to_go()]


def test_every_place_is_named_by_its_name_in_any_case() -> None:
    assert len(NAMES) == len(set(NAMES)) == 25
    for name in NAMES:
        assert named(name, NAMES) == named(f" {name.upper()}", NAMES) == name


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("stiff", "Stiffness"),
        ("load", "Load"),
        ("loads", "Loads"),
        ("torque", "Torque maps"),
        ("error", "Errors"),
        ("mo", None),  # too short
        ("moti", None),  # of Motion and Motion plots
        ("motor", None),
        ("stiffness z", None),
        ("", None),
    ],
)
def test_a_place_is_named_by_the_beginning_of_its_name_alone(text: str, name: str | None) -> None:
    assert named(text, NAMES) == name
