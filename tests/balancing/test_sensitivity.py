"""Tornado bars and derivatives against changed and analyzed designs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.balancing import OUTPUTS, tornado
from paminsa_viz.balancing.sensitivity import LENGTHS, MASSES, STEP
from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    Design,
    Grid,
    InvalidInput,
    static_imbalance,
)
from paminsa_viz.model.grids import solve_field
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.reach import Limit
from paminsa_viz.progress import Canceled
from tests.balancing.robots import measured, trajectory, workspace

pytestmark = pytest.mark.slow


WEIGHTED = replace(APPENDIX_4, counterweights=(Counterweight("b3", 7, 0.1, 0.8),))


def outputs(design: Design) -> np.ndarray:
    """All outputs of a design, from the functions that analyze designs."""
    found = measured(design)
    names = ("peak static torque", "RMS static torque")
    names += ("peak torque of M1-M3 on the trajectory", "RMS torque of M1-M3 on the trajectory")
    return np.array([static_imbalance(design), *(found[name] for name in names)])


def changed(design: Design, path: str, factor: float) -> Design:
    """A value times a factor; a link's inertias follow its mass."""
    numbers: dict[str, float | None] = {path: factor * design.value(path)}
    if path.startswith("links."):
        inertias = f"inertias.{path.removeprefix('links.')}_"
        for other in MASS_PATHS:
            if other.startswith(inertias):
                numbers[other] = factor * design.value(other)
    return design.vary(numbers)


@pytest.mark.parametrize(
    "path",
    [
        "links.b4", "joints.j7", "joints.j2", "platform.mass", "counterweights.0.mass",
        "geometry.base_radius", "geometry.magnification", "geometry.coupler_length",
        "geometry.platform_joint_height",
    ],
)  # fmt: skip
def test_bars_agree_with_changed_designs(path: str) -> None:
    paths = (path,) if path in MASSES + LENGTHS else ()
    result = tornado(WEIGHTED, workspace(), trajectory(), change=0.04, paths=paths)
    bar = next(bar for bar in result.bars if bar.path == path)
    assert bar.lost == 0
    np.testing.assert_allclose(result.base, outputs(WEIGHTED), rtol=1e-10)
    np.testing.assert_allclose(bar.base, result.base, rtol=1e-12)
    for found, factor in ((bar.minus, 0.96), (bar.plus, 1.04)):
        np.testing.assert_allclose(
            found, outputs(changed(WEIGHTED, path, factor)), rtol=1e-8, atol=1e-10
        )
    h = 1e-4
    slope = outputs(changed(WEIGHTED, path, 1 + h)) - outputs(changed(WEIGHTED, path, 1 - h))
    slope /= 2 * h * WEIGHTED.value(path)
    size = np.abs(slope).max()
    np.testing.assert_allclose(bar.derivative, slope, rtol=1e-3, atol=1e-3 * size + 1e-6)


def test_every_mass_and_length_has_a_bar() -> None:
    result = tornado(WEIGHTED, workspace(), trajectory())
    assert [bar.path for bar in result.bars] == [*MASSES, "counterweights.0.mass", *LENGTHS]
    assert len(result.base) == len(OUTPUTS)
    ranked = result.ranked(0)
    swings = [bar.swing(0) for bar in ranked]
    assert swings == sorted(swings, reverse=True)
    assert all(bar.path != "joints.j2" for bar in ranked)


def test_each_length_is_told_and_can_end_the_work() -> None:
    paths, told = ["joints.j9", *LENGTHS[:4]], []

    def progress(done: float) -> bool:
        told.append(done)
        return done == 0.5

    with pytest.raises(Canceled):
        tornado(APPENDIX_4, workspace(), paths=paths, progress=progress)
    assert told == [0.0, 0.25, 0.5]


def test_without_a_motion_its_outputs_are_empty() -> None:
    result = tornado(APPENDIX_4, workspace(), paths=["joints.j9"])
    assert np.isnan(result.base[3:]).all()
    assert np.isfinite(result.base[:3]).all()
    assert np.isnan(result.bars[0].swing(3))
    assert result.ranked(3) == []


def test_lost_poses_and_failing_variants_are_reported() -> None:
    """A workspace up to where the bars are stretched: shorter bars lose some of it."""
    deep = Grid.over((0.05, 0.02, 0.2, -0.9), z=np.linspace(-0.98, -0.5, 49))
    result = tornado(APPENDIX_4, deep, paths=["geometry.coupler_length", "joints.j9"])
    mass, bar = result.bars
    assert bar.lost > 0
    assert mass.lost == 0
    reached = [
        solve_field(APPENDIX_4.vary({"geometry.coupler_length": factor * bar.value}).geometry, deep)
        for factor in (1.0, 0.95, 1.05, 1 - STEP, 1 + STEP)
    ]
    shared = np.all([found.status == Limit.OK for found in reached], axis=0)
    assert bar.lost == (reached[0].status == Limit.OK).sum() - shared.sum()
    assert bar.base[1] < result.base[1]
    assert np.isfinite(bar.derivative[:3]).all()
    nearly = APPENDIX_4.vary({"geometry.base_radius": 0.78})
    far = Grid.over((0, 0, 0, -0.1), z=np.linspace(-0.12, -0.08, 3))
    nearly = nearly.vary({"geometry.guide_stroke": 0.5})
    (broken,) = tornado(nearly, far, change=0.1, paths=["geometry.base_radius"]).bars
    assert broken.problem
    assert np.isnan(broken.plus).all()


@pytest.mark.parametrize(
    ("kwargs", "named"), [({"change": 0.0}, "change"), ({"paths": ["gravity"]}, "gravity")]
)
def test_impossible_requests_are_rejected(kwargs, named) -> None:
    with pytest.raises(InvalidInput, match=named):
        tornado(APPENDIX_4, workspace(), **kwargs)
