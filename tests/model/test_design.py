"""What a design refuses, and how it is compared, hashed and varied."""

from __future__ import annotations

import math
from dataclasses import FrozenInstanceError, fields, replace
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETERS,
    Design,
    Friction,
    Geometry,
    Inertias,
    InvalidDesign,
    InvalidInput,
    JointMasses,
    KneeBranch,
    LinkMasses,
    PaminsaError,
    Payload,
    Platform,
)
from paminsa_viz.model.parameters import Parameter
from tests.support import samples

EACH = pytest.mark.parametrize("parameter", PARAMETERS, ids=lambda p: p.path)
GROUPS = (Geometry, JointMasses, LinkMasses, Inertias, Platform, Payload, Friction)
NO_NUMBERS = [math.nan, math.inf, -math.inf, 10**400, -(10**400), True, False, "0.3", "", [0.3]]
NO_NUMBERS += [0.3 + 0.0j, Fraction(1, 3), Decimal("0.3"), np.array(0.3), np.True_, {}]


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
        assert f"[{parameter.unit}]" in error.allowed or not parameter.unit
        assert str(error) == f"{path} = {value!r} is not possible: {error.allowed}"
        assert isinstance(error, PaminsaError)
        assert isinstance(error, ValueError)


@EACH
@pytest.mark.parametrize("value", NO_NUMBERS, ids=lambda v: f"{type(v).__name__} {v!r:.8}")
def test_what_is_no_finite_number_is_refused(parameter: Parameter, value: Any) -> None:
    expect_refusal(parameter, value)


@EACH
def test_none_is_refused_but_for_the_stroke(parameter: Parameter) -> None:
    if parameter.path == "geometry.guide_stroke":
        assert set_value(parameter, None).geometry.stroke == 0.3635
    else:
        expect_refusal(parameter, None)


@EACH
@given(value=st.floats(max_value=0.0, exclude_max=True, allow_infinity=False))
def test_negative_values_are_refused_where_no_sign_is_possible(
    parameter: Parameter, value: float
) -> None:
    if parameter.signed and value >= -parameter.largest:
        assert set_value(parameter, value).value(parameter.path) == value
    else:
        expect_refusal(parameter, value)


@EACH
def test_zero_is_refused_where_no_machine_can_have_it(parameter: Parameter) -> None:
    if parameter.positive:
        expect_refusal(parameter, 0.0)
        expect_refusal(parameter, -0.0)
        expect_refusal(parameter, 0)
    else:
        assert set_value(parameter, 0.0).value(parameter.path) == 0.0


@EACH
@given(value=st.floats(1e-3, 10.0))
def test_any_other_value_is_kept_to_the_last_bit(parameter: Parameter, value: float) -> None:
    if parameter.group == "geometry":
        value = parameter.default * (1 + value / 100)
    design = set_value(parameter, value)
    assert design.value(parameter.path) == value
    assert design == APPENDIX_4.vary({parameter.path: value})
    others = [p.path for p in PARAMETERS if p.path != parameter.path]
    if parameter.path == "geometry.guide_link_length":
        others.remove("geometry.guide_stroke")  # follows it
        assert design.value("geometry.guide_stroke") == value
    assert [design.value(p) for p in others] == [APPENDIX_4.value(p) for p in others]


@given(ratio=st.floats(1e-6, 1.0))
@example(ratio=1.0)
def test_a_pantograph_magnifies(ratio: float) -> None:
    with pytest.raises(InvalidDesign, match="greater than 1") as caught:
        Geometry(magnification=ratio)
    assert caught.value.field == "geometry.magnification"
    assert caught.value.value == ratio


@given(seed=st.integers(0, 2**32 - 1), short=st.floats(1e-3, 1.0, exclude_max=True))
def test_bars_that_can_not_close_the_pantograph_are_refused(seed: int, short: float) -> None:
    """Of any robot: bars that add up to less than the distance they have to bridge at home."""
    geometry = samples.random_design(np.random.default_rng(seed)).geometry
    k = geometry.magnification
    span = k / (k - 1) * abs(geometry.base_radius - geometry.platform_radius)
    scale = short * span / (geometry.crank_length + geometry.coupler_length)
    with pytest.raises(InvalidDesign, match="cannot close the pantograph") as caught:
        replace(
            geometry,
            crank_length=scale * geometry.crank_length,
            coupler_length=scale * geometry.coupler_length,
        )
    assert caught.value.field == "geometry.coupler_length"
    assert caught.value.value == scale * geometry.coupler_length
    assert f"{span:.6g} m apart" in caught.value.allowed
    scale *= 1.001 / short
    replace(
        geometry,
        crank_length=scale * geometry.crank_length,
        coupler_length=scale * geometry.coupler_length,
    )


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
    wanted = type(getattr(APPENDIX_4, group)).__name__
    with pytest.raises(InvalidDesign, match=wanted) as caught:
        Design(**{group: value})
    assert caught.value.field == group
    assert caught.value.value is value


def test_designs_are_frozen_all_the_way_down() -> None:
    for item in (APPENDIX_4, *(getattr(APPENDIX_4, f.name) for f in fields(Design))):
        if isinstance(item, (Design, *GROUPS)):
            with pytest.raises(FrozenInstanceError):
                item.__setattr__(fields(item)[0].name, 1.0)


@given(seed=st.integers(0, 2**32 - 1))
def test_equal_numbers_make_equal_designs(seed: int) -> None:
    one = samples.random_design(np.random.default_rng(seed))
    other = samples.random_design(np.random.default_rng(seed))
    assert one is not other
    assert one == other
    assert hash(one) == hash(other)
    assert one != APPENDIX_4
    assert len({one, other, APPENDIX_4}) == 2


def test_the_name_is_no_part_of_a_design() -> None:
    named = replace(APPENDIX_4, name="mine")
    assert named.name == "mine"
    assert named == APPENDIX_4
    assert hash(named) == hash(APPENDIX_4)
    assert APPENDIX_4.name == "Appendix 4"


@EACH
def test_every_number_is_a_part_of_a_design(parameter: Parameter) -> None:
    changed = APPENDIX_4.vary({parameter.path: parameter.default * 1.01 + 0.001})
    assert changed != APPENDIX_4
    assert changed.vary({parameter.path: parameter.default}) == replace(
        APPENDIX_4,
        geometry=replace(APPENDIX_4.geometry, guide_stroke=0.3635)
        if parameter.path == "geometry.guide_stroke"
        else APPENDIX_4.geometry,
    )


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
    with pytest.raises(InvalidDesign, match="no design value"):
        upper.vary({"geometry.knee": 1.0})


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
    assert design.name == APPENDIX_4.name
    assert APPENDIX_4.vary({}) == APPENDIX_4


@pytest.mark.parametrize(
    "path", ["", ".", "links", "links.", "links.b99", "b3", "links.b3.real", "name", "legs.b3"]
)
def test_vary_refuses_a_value_that_does_not_exist(path: str) -> None:
    with pytest.raises(InvalidDesign, match="no design value") as caught:
        APPENDIX_4.vary({path: 1.0})
    assert (caught.value.field, caught.value.value) == (path, 1.0)


@EACH
@pytest.mark.parametrize("kind", [int, np.float64, np.float32, np.int64])
def test_whole_and_numpy_numbers_become_floats(parameter: Parameter, kind: Any) -> None:
    """The compiled formulas are made for floats; another type would compile all of them again."""
    value = kind(round(parameter.default) + 3)
    changes = {parameter.path: value}
    if parameter.group == "geometry":
        changes = {
            "geometry.crank_length": kind(90),
            "geometry.coupler_length": kind(90),
            **changes,
        }
    stored: Any = APPENDIX_4.vary(changes)
    for name in parameter.path.split("."):
        stored = getattr(stored, name)
    assert type(stored) is float
    assert stored == value


@pytest.mark.parametrize("path", ["links.b99", "links", "nothing", "links.b3.mass", "name", ""])
def test_there_is_no_value_of_that_name(path: str) -> None:
    with pytest.raises(InvalidInput, match="there is no design value"):
        APPENDIX_4.value(path)
