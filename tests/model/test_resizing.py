"""Robots of other lengths: masses, inertias and sections of bars by their powers of the length."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    BarLaw,
    Counterweight,
    InvalidDesign,
    InvalidInput,
    inverse_kinematics,
    lumped_coefficients,
    mass_vector,
    resized,
)
from paminsa_viz.model.elastic import BARS, tube_section
from paminsa_viz.model.parameters import BAR_ENDS, PANTOGRAPH
from paminsa_viz.model.reach import home_pose
from paminsa_viz.model.resizing import resized_coefficients, resized_masses
from tests.support.samples import random_design

LAWS = (BarLaw(), BarLaw(grow=True), BarLaw(tubes=True), BarLaw(grow=True, tubes=True))
KEPT = BarLaw(follow=False)
LENGTHS = (
    "geometry.arm_length", "geometry.shaft_length", "geometry.guide_link_length",
    "geometry.crank_length", "geometry.coupler_length",
)  # fmt: skip


def lengths(design) -> dict[str, float]:
    """Of every bar, those of the pantograph from one joint to the other [m]."""
    g = design.geometry
    points = inverse_kinematics(g, home_pose(g)).points
    found = {"b1": g.arm_length, "b2": g.shaft_length, "b10": g.guide_link_length}
    for bar, (first, last) in BAR_ENDS.items():
        found[bar] = float(np.linalg.norm(points[last][0] - points[first][0]))
    return found


def longer(design, seed: int) -> dict[str, float]:
    shares = np.random.default_rng(seed).uniform(0.9, 1.2, len(LENGTHS))
    return {path: share * design.value(path) for path, share in zip(LENGTHS, shares, strict=True)}


@pytest.mark.parametrize("path", ["links.b4", "inertias.b8_axial", "elastic.b4_outer", "gravity"])
def test_what_is_no_length_is_refused(path: str) -> None:
    for law in (*LAWS, KEPT):
        with pytest.raises(InvalidDesign, match=f"{path} = .*: values of the geometry"):
            resized(APPENDIX_4, {path: 1.0}, law)


@given(seed=st.integers(0, 1000), grow=st.booleans())
def test_bars_follow_in_proportion_as_uniform_bodies_do(seed: int, grow: bool) -> None:
    """Mass as the volume, an inertia as the mass times the square of the size that it is about."""
    design = random_design(np.random.default_rng(seed))
    after = resized(design, longer(design, seed), BarLaw(grow=grow))
    before, now = lengths(design), lengths(after)
    for bar in BARS:
        r = now[bar] / before[bar]
        wide = r if grow else 1.0
        mass = wide**2 * r
        assert after.value(f"links.{bar}") == pytest.approx(mass * design.value(f"links.{bar}"))
        inertias = {
            "b2": {"inertias.b2_vertical": mass * wide**2},
            "b10": {"inertias.b10_vertical": mass * r**2},
        }
        if bar in PANTOGRAPH:
            inertias[bar] = {
                f"inertias.{bar}_axial": mass * wide**2,
                f"inertias.{bar}_transverse": mass * r**2,
            }
        for path, factor in inertias.get(bar, {}).items():
            assert after.value(path) == pytest.approx(factor * design.value(path)), path
        for end in ("outer", "inner"):
            path = f"elastic.{bar}_{end}"
            assert after.value(path) == pytest.approx(wide * design.value(path))
    assert after.joints == design.joints
    assert resized(design, longer(design, seed), KEPT) == design.vary(longer(design, seed))


@pytest.mark.parametrize("grow", [False, True])
def test_tubes_have_the_mass_and_inertia_of_their_rings(grow: bool) -> None:
    design = random_design(np.random.default_rng(3))
    after = resized(design, longer(design, 3), BarLaw(grow=grow, tubes=True))
    for bar, length in lengths(after).items():
        wide = length / lengths(design)[bar] if grow else 1.0
        ends = [design.value(f"elastic.{bar}_{end}") * wide / 2 for end in ("inner", "outer")]
        edges = np.linspace(*ends, 2001)
        radius, rings = (edges[1:] + edges[:-1]) / 2, np.pi * np.diff(edges**2)
        mass = design.elastic.density * length * rings.sum()
        axial = design.elastic.density * length * rings @ radius**2
        across = axial / 2 + mass * length**2 / 12
        assert after.value(f"links.{bar}") == pytest.approx(mass, rel=1e-5)
        for path, value in (
            ("inertias.b2_vertical", axial if bar == "b2" else None),
            ("inertias.b10_vertical", across if bar == "b10" else None),
            (f"inertias.{bar}_axial", axial if bar in PANTOGRAPH else None),
            (f"inertias.{bar}_transverse", across if bar in PANTOGRAPH else None),
        ):
            if value is not None:
                assert after.value(path) == pytest.approx(value, rel=1e-5)


def test_given_sections_grow_as_those_of_tubes_do() -> None:
    outer, inner = 0.05, 0.03
    tube = tube_section(outer, inner, APPENDIX_4.elastic.poisson)
    given = {
        "elastic.b4_outer": outer, "elastic.b4_inner": inner, "elastic.b4_area": tube.area,
        "elastic.b4_inertia_in": tube.inertia_in, "elastic.b4_inertia_out": tube.inertia_out,
        "elastic.b4_torsion": tube.torsion,
    }  # fmt: skip
    design = APPENDIX_4.vary(given)
    values = {"geometry.coupler_length": 1.3 * design.geometry.coupler_length}
    after = resized(design, values, BarLaw(grow=True)).elastic.section("b4")
    expected = tube_section(1.3 * outer, 1.3 * inner, APPENDIX_4.elastic.poisson)
    assert after == pytest.approx(expected)
    assert resized(design, values).elastic.section("b4") == design.elastic.section("b4")


@pytest.mark.parametrize("law", [*LAWS, KEPT])
def test_many_robots_at_once_are_those_one_by_one(law: BarLaw) -> None:
    weights = (Counterweight("b8", 8, 0.1, 1.5), Counterweight("b3", 7, -0.05, 0.4))
    design = replace(random_design(np.random.default_rng(5)), counterweights=weights)
    robots = [resized(design, longer(design, seed), law) for seed in range(3)]
    geometries = [robot.geometry for robot in robots]
    masses = resized_masses(design, geometries, law)
    np.testing.assert_allclose(masses, [mass_vector(robot) for robot in robots], rtol=1e-12)
    np.testing.assert_allclose(
        resized_coefficients(design, geometries, masses),
        [lumped_coefficients(robot) for robot in robots],
        rtol=1e-12, atol=1e-12,
    )  # fmt: skip


def test_bars_that_keep_their_masses_neither_grow_nor_are_tubes() -> None:
    for other in ({"grow": True}, {"tubes": True}):
        with pytest.raises(InvalidInput, match="scale_bars: bars that keep their masses"):
            BarLaw(follow=False, **other)


def test_a_bar_that_had_no_length_keeps_its_mass() -> None:
    none = APPENDIX_4.vary({"geometry.arm_length": 0.0})
    after = resized(none, {"geometry.arm_length": 0.6})
    assert after.links.b1 == APPENDIX_4.links.b1
