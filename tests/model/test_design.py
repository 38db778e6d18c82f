"""A design: its numbers, what it refuses, and how it is compared, hashed and varied."""

from __future__ import annotations

import math
from dataclasses import FrozenInstanceError, fields, is_dataclass, replace
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.errors import LONGEST_VALUE
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETER,
    PARAMETERS,
    Counterweight,
    Design,
    Geometry,
    InvalidDesign,
    InvalidInput,
    KneeBranch,
    PaminsaError,
    Parameter,
)
from paminsa_viz.model import design as model_design
from paminsa_viz.model.design import OPTIONAL_GROUPS
from paminsa_viz.model.parameters import MOST_COUNTERWEIGHTS, SMALLEST, possible_range
from paminsa_viz.units import rounded_to_side, unit_text
from tests.support import samples
from tests.support.samples import possible_values

NO_NUMBERS = [math.nan, math.inf, -math.inf, 10**400, -(10**400), True, False, "0.3", "", [0.3]]
NO_NUMBERS += [0.3 + 0.0j, Fraction(1, 3), Decimal("0.3"), np.array(0.3), np.True_, {}]
STROKE = "geometry.guide_stroke"

APPENDIX_4_RETYPED = {
    "k": 3.0, "R_b": 0.35, "R_pl": 0.1, "l_B1": 0.308, "l_B2": 0.442, "l_B3 = l_B8": 0.42,
    "l_B4 = k l_B7": 0.63, "l_B5": 0.0275, "l_B10": 0.3635,
    "m_2": 0.214, "m_3": 0.338, "m_4": 0.262, "m_5": 0.233, "m_7": 0.28, "m_8": 0.305,
    "m_9": 0.259, "m_pl": 2.301,
    "m_B1": 1.221, "m_B2": 0.921, "m_B3": 0.406, "m_B4": 0.672, "m_B7": 0.107, "m_B8": 0.403,
    "m_B10": 0.436,
    "I_XX^(B3)": 0.0038, "I_YY^(B3)": 0.02, "I_XX^(B4)": 0.0012, "I_YY^(B4)": 0.048,
    "I_XX^(B7)": 8e-4, "I_YY^(B7)": 0.003, "I_XX^(B8)": 0.0024, "I_YY^(B8)": 0.02,
    "I_B2": 0.003, "I_B10": 0.02, "I_pl": 0.015,
    "g": 9.81,
}  # fmt: skip
"""Appendix 4 (and g from Appendix 3), by the paper's symbols."""

NOT_IN_THE_PAPER = {
    STROKE: 0.3635, "friction.transition_speed": 1e-3, "geometry.body_scale": 1.0
}  # fmt: skip
"""What the paper does not have and is not zero, at values that change nothing of the paper."""


def test_the_default_is_appendix_4() -> None:
    found = {p.symbol: p.default for p in PARAMETERS if p.symbol in APPENDIX_4_RETYPED}
    assert found == APPENDIX_4_RETYPED
    others = {p.path: p.default for p in PARAMETERS if p.symbol not in APPENDIX_4_RETYPED}
    assert others == dict.fromkeys(others, 0.0) | NOT_IN_THE_PAPER


def test_every_number_of_a_design_is_listed_once_with_symbol_label_and_unit() -> None:
    found = []
    for item in fields(APPENDIX_4):
        value = getattr(APPENDIX_4, item.name)
        inner = fields(value) if is_dataclass(value) else ()
        found += [f"{item.name}.{part.name}" for part in inner] or [item.name]
    for choice in ("geometry.knee", "load.frame", "counterweights", "drives", "name"):
        found.remove(choice)
    assert list(PARAMETER) == found
    rigid = [path for path in found if path.partition(".")[0] not in OPTIONAL_GROUPS]
    assert [p.path for p in PARAMETERS] == rigid
    assert all(PARAMETER[p.path] is p for p in PARAMETERS)
    assert {p.group for p in PARAMETER.values() if p not in PARAMETERS} == set(OPTIONAL_GROUPS)
    assert PARAMETER["gravity"].group == "design"
    # a leg's deviation has the symbol of its length
    own = [p for p in PARAMETER.values() if p.group not in ("leg1", "leg2", "leg3")]
    for name in ("symbol", "label"):
        assert len({getattr(p, name) for p in own}) == len(own)
    units = {"joints": {"kg"}, "links": {"kg"}, "inertias": {"kg m^2"}, "geometry": {"", "m"}}
    units |= {"platform": {"kg", "kg m^2"}, "payload": {"kg", "kg m^2", "m"}, "design": {"m/s^2"}}
    for p in PARAMETERS:
        assert p.unit in units.get(p.group, {p.unit})
        assert bool(p.unit) == (p.symbol not in ("k", "s_b"))


def set_value(parameter: Parameter, value: Any) -> Design:
    """Make a design by the constructors, not by `vary`."""
    group, _, name = parameter.path.rpartition(".")
    if not group:
        return Design(**{name: value})
    owner = type(getattr(APPENDIX_4, group))
    return Design(**{group: owner(**{name: value})})


def expect_refusal(parameter: Parameter, value: Any) -> None:
    path = parameter.path if "." in parameter.path else f"design.{parameter.path}"
    for attempt in (
        lambda: set_value(parameter, value),
        lambda: APPENDIX_4.vary({parameter.path: value}),
    ):
        with pytest.raises(InvalidDesign) as caught:
            attempt()
        error = caught.value
        assert error.field == path
        assert error.value is value
        least = "above 0" if parameter.positive else "at least 0"
        assert parameter.signed or least in error.allowed
        assert f"[{unit_text(parameter.unit)}]" in error.allowed or not parameter.unit
        assert str(error) == f"{path} = {value!r:.{LONGEST_VALUE}} is not possible: {error.allowed}"
        assert isinstance(error, PaminsaError)
        assert isinstance(error, ValueError)


def test_what_is_no_finite_number_is_refused() -> None:
    for parameter in PARAMETERS:
        for value in NO_NUMBERS:
            expect_refusal(parameter, value)


@pytest.mark.slow
@given(share=st.floats(1e-9, 1.0, exclude_max=True), power=st.integers(0, 200))
def test_a_number_outside_its_range_is_refused(share: float, power: int) -> None:
    for parameter in PARAMETERS:
        least, most = possible_range(parameter.unit, parameter.positive)
        beyond = most / share * 10.0**power
        wrong = [beyond, -beyond] if parameter.signed else [beyond, -least, -share]
        if least > 0:
            wrong.append(least * share / 10.0**power)
        if parameter.positive:
            wrong += [0.0, -0.0, 0]
        if parameter.path != STROKE:
            wrong.append(None)
        for value in wrong:
            if value != 0 or parameter.positive or value is None:
                expect_refusal(parameter, value)


@pytest.mark.slow
@given(data=st.data())
def test_a_number_in_its_range_is_kept_to_the_last_bit(data: st.DataObject) -> None:
    for parameter in PARAMETERS:
        value = data.draw(possible_values(parameter), label=parameter.path)
        try:
            design = set_value(parameter, value)
        except InvalidDesign as error:
            assert error.field == "geometry.coupler_length" or value < 1 + SMALLEST  # noqa: PT017
            continue
        assert design.value(parameter.path) == value
        assert design == APPENDIX_4.vary({parameter.path: value})
        others = [p.path for p in PARAMETERS if p.path != parameter.path]
        if parameter.path == "geometry.guide_link_length":
            others.remove(STROKE)  # follows it
            assert design.value(STROKE) == value
        assert [design.value(p) for p in others] == [APPENDIX_4.value(p) for p in others]
        assert (design == APPENDIX_4) == (value == parameter.default and parameter.path != STROKE)


def test_a_refusal_in_words_is_one_of_the_design() -> None:
    """At the ends of the range of a number, and one step beyond them."""
    for parameter in PARAMETERS:
        least, most = possible_range(parameter.unit, parameter.positive)
        ends = [
            (most, True),
            (math.nextafter(most, math.inf), False),
            (0.0, not parameter.positive),
        ]
        ends += [(-most, parameter.signed), (-math.nextafter(most, math.inf), False)]
        if parameter.positive:
            ends += [(least, True), (math.nextafter(least, 0.0), False)]
        for value, possible in ends:
            text = parameter.refusal(value, parameter.display)
            assert (text is None) == possible
            if text is not None:
                shown = most * parameter.display.factor
                assert f"{shown:g}" in text
                expect_refusal(parameter, value)
        assert parameter.largest == most


def test_loads_are_none_or_large_enough_to_be_multiplied() -> None:
    for path in ("links.b3", "payload.inertia", "gravity"):
        assert APPENDIX_4.vary({path: 1e-30}).value(path) == 1e-30
        with pytest.raises(InvalidDesign, match="below 1e-30 it has to be 0"):
            APPENDIX_4.vary({path: 0.99e-30})
        with pytest.raises(InvalidDesign) as caught:
            APPENDIX_4.vary({path: -1.0})
        assert "below" not in caught.value.allowed
    with pytest.raises(InvalidDesign) as caught:
        Geometry(base_radius=0.5e-6)
    assert "below" not in caught.value.allowed


def test_the_least_magnification_and_the_shortest_bars() -> None:
    assert Geometry(magnification=1 + SMALLEST, guide_stroke=50.0, crank_length=100.0,
                    base_radius=0.1001)  # fmt: skip
    with pytest.raises(InvalidDesign, match="greater than 1"):
        Geometry(magnification=math.nextafter(1 + SMALLEST, 1.0))
    halves = {"magnification": 2.0, "base_radius": 1.0, "platform_radius": 0.5}
    halves |= {"crank_length": 0.25, "coupler_length": 0.75}  # just as long as the span at home
    with pytest.raises(InvalidDesign, match="together they reach 1 m"):
        Geometry(**halves)
    assert Geometry(**halves | {"coupler_length": 0.75 + 2**-50}).home_span == 1.0


def test_a_long_path_is_cut_where_it_is_named() -> None:
    path = "links." + "b" * 100
    for call in (APPENDIX_4.value, APPENDIX_4.stored):
        with pytest.raises(InvalidInput) as caught:
            call(path)
        assert caught.value.argument == path[:60]


@given(ratio=st.floats(1e-6, 1.0))
def test_a_pantograph_magnifies(ratio: float) -> None:
    with pytest.raises(InvalidDesign, match="greater than 1") as caught:
        Geometry(magnification=ratio)
    assert (caught.value.field, caught.value.value) == ("geometry.magnification", ratio)


@given(seed=st.integers(0, 2**32 - 1), short=st.floats(1e-3, 1.0, exclude_max=True))
def test_bars_that_cannot_close_the_pantograph_are_refused(seed: int, short: float) -> None:
    """Of any robot: bars that add up to less than the distance they have to bridge at home."""
    geometry = samples.random_design(np.random.default_rng(seed)).geometry
    k = geometry.magnification
    span = k / (k - 1) * abs(geometry.base_radius - geometry.platform_radius)

    def scaled(factor: float) -> Geometry:
        factor *= span / (geometry.crank_length + geometry.coupler_length)
        crank, coupler = factor * geometry.crank_length, factor * geometry.coupler_length
        return replace(geometry, crank_length=crank, coupler_length=coupler)

    with pytest.raises(InvalidDesign, match="cannot close the pantograph") as caught:
        scaled(short)
    assert caught.value.field == "geometry.coupler_length"
    told = rounded_to_side(span, 6, up=True)  # so that bars of this length reach
    assert f"{told:.6g} m apart" in caught.value.allowed
    assert scaled(1.001).home_span == pytest.approx(span)


def test_derived_lengths() -> None:
    geometry = Geometry()
    assert geometry.span_ratio == 1.5
    assert geometry.home_span == pytest.approx(1.5 * 0.25, rel=1e-15)
    assert geometry.short_coupler_length == pytest.approx(0.21, rel=1e-15)
    assert geometry.stroke == geometry.guide_link_length == 0.3635
    assert Geometry(guide_stroke=0.2).stroke == 0.2
    assert Geometry(guide_link_length=0.5).stroke == 0.5


@pytest.mark.parametrize("group", [f.name for f in fields(Design) if f.name not in "gravity name"])
@pytest.mark.parametrize("value", [None, 0.3, {"mass": 1.0}, "links"])
def test_a_group_of_another_kind_is_refused(group: str, value: Any) -> None:
    with pytest.raises(InvalidDesign) as caught:
        Design(**{group: value})
    assert (caught.value.field, caught.value.value) == (group, value)


def test_a_leg_has_a_limited_number_of_counterweights() -> None:
    weights = (Counterweight("b8", 8, 0.1, 1.0),) * (MOST_COUNTERWEIGHTS + 1)
    assert replace(APPENDIX_4, counterweights=weights[1:]).counterweights == weights[1:]
    with pytest.raises(InvalidDesign, match="counterweights = 13"):
        replace(APPENDIX_4, counterweights=weights)


def test_designs_are_frozen_all_the_way_down() -> None:
    for item in (APPENDIX_4, *(getattr(APPENDIX_4, f.name) for f in fields(Design))):
        if is_dataclass(item):
            with pytest.raises(FrozenInstanceError):
                item.__setattr__(fields(item)[0].name, 1.0)


@given(seed=st.integers(0, 2**32 - 1))
def test_equal_numbers_make_equal_designs_of_any_name(seed: int) -> None:
    one, other = (samples.random_design(np.random.default_rng(seed)) for _ in range(2))
    other = replace(other, name="mine")
    assert one is not other
    assert one == other != APPENDIX_4
    assert len({one, other, APPENDIX_4}) == 2
    assert (one.name, other.name, APPENDIX_4.name) == ("random", "mine", "Appendix 4")


def test_other_numbers_are_not_called_appendix_4() -> None:
    heavier = APPENDIX_4.vary({"links.b4": 1.0})
    assert heavier.name == "Appendix 4, changed"
    assert heavier.vary({"links.b4": APPENDIX_4.links.b4}).name == "Appendix 4"
    assert APPENDIX_4.vary({}).with_knee(KneeBranch.UPPER).name == "Appendix 4"
    assert replace(APPENDIX_4, name="mine").vary({"links.b4": 1.0}).name == "mine"


@pytest.mark.parametrize("knee", ["mirror", None, 1.0, -1])
def test_a_knee_is_one_of_two_branches(knee: Any) -> None:
    with pytest.raises(InvalidDesign, match="a KneeBranch is needed") as caught:
        Geometry(knee=knee)
    assert (caught.value.field, caught.value.value) == ("geometry.knee", knee)


def test_the_knee_is_part_of_a_design_and_no_number_of_it() -> None:
    upper = APPENDIX_4.with_knee(KneeBranch.UPPER)
    assert upper != APPENDIX_4
    assert upper.with_knee(KneeBranch.LOWER) == APPENDIX_4
    assert upper.vary({"geometry.base_radius": 0.36}).geometry.knee is KneeBranch.UPPER
    assert [upper.value(p.path) for p in PARAMETERS] == [p.default for p in PARAMETERS]


def test_lengths_that_depend_on_each_other_change_in_one_step() -> None:
    """Half of either change alone could not be closed."""
    design = APPENDIX_4.vary({"geometry.base_radius": 3.5, "geometry.coupler_length": 6.3})
    assert design.geometry == replace(Geometry(), base_radius=3.5, coupler_length=6.3)
    with pytest.raises(InvalidDesign):
        APPENDIX_4.vary({"geometry.base_radius": 3.5})


def test_vary_leaves_the_original_and_shares_what_did_not_change() -> None:
    design = APPENDIX_4.vary({"links.b3": 0.5, "gravity": 1.62})
    assert (design.links.b3, design.gravity) == (0.5, 1.62)
    assert (APPENDIX_4.links.b3, APPENDIX_4.gravity) == (0.406, 9.81)
    assert design.geometry is APPENDIX_4.geometry
    assert design.name == "Appendix 4, changed"
    assert APPENDIX_4.vary({}) == APPENDIX_4


@pytest.mark.parametrize(
    "path",
    ["", ".", "links", "links.", "links.b99", "b3", "links.b3.real", "name", "legs.b3",
     "geometry.knee", "counterweights.0.mass", "counterweights.x.mass"],
)  # fmt: skip
def test_a_value_that_does_not_exist_is_refused(path: str) -> None:
    with pytest.raises(InvalidDesign, match="no design value") as caught:
        APPENDIX_4.vary({path: 1.0})
    assert (caught.value.field, caught.value.value) == (path, 1.0)
    with pytest.raises(InvalidInput, match="there is no design value"):
        APPENDIX_4.value(path)


@pytest.mark.parametrize("kind", [int, np.float64, np.float32, np.int64])
def test_whole_and_numpy_numbers_become_floats(kind: Any) -> None:
    """The compiled formulas are made for floats; another type would compile all of them again."""
    bars = {"geometry.crank_length": kind(90), "geometry.coupler_length": kind(90)}
    for parameter in PARAMETERS:
        value = kind(round(parameter.default) + 3)
        stored: Any = APPENDIX_4.vary(bars | {parameter.path: value})
        for name in parameter.path.split("."):
            stored = getattr(stored, name)
        assert type(stored) is float, parameter.path
        assert stored == value


def test_a_counterweight_is_at_its_joint_and_weighs_nothing_unless_it_is_said() -> None:
    assert Counterweight("b3", 7, mass=1.0).beyond == 0.0
    assert Counterweight("b3", 7, beyond=0.1).mass == 0.0
    places = [Counterweight("b3", 7, beyond).place for beyond in (0.0, 0.1, -0.1)]
    assert [place.split()[-3] for place in places] == ["beyond", "beyond", "before"]
    for joint in (7.0, np.int64(7)):
        assert repr(Counterweight("b3", joint)) == repr(Counterweight("b3", 7))


@given(samples.edge_designs())
def test_a_design_is_printed_as_what_makes_it_without_what_is_the_papers(design: Design) -> None:
    assert repr(Design(name="mine")) == "Design(name='mine')"
    lower = replace(design, geometry=replace(design.geometry, knee=KneeBranch.LOWER))
    printed = repr(lower)
    assert eval(printed, vars(model_design)) == lower
    assert "gravity" in printed or design.gravity == APPENDIX_4.gravity


def test_a_refusal_names_the_ends_in_the_unit_that_is_shown() -> None:
    for parameter in PARAMETERS:
        least, most = possible_range(parameter.unit, parameter.positive)
        if parameter.limits:
            least, most = parameter.limits
        fine = [most, least] if parameter.positive else [most, 0.0]
        wrong = [2 * most, -2 * most] + ([0.5 * least, 0.0] if parameter.positive else [])
        assert all(parameter.refusal(value, parameter.display) is None for value in fine)
        for value in wrong + ([] if parameter.signed else [-most]):
            refused = parameter.refusal(value, parameter.display)
            assert refused
            assert parameter.display.text in refused
