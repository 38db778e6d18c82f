"""Random designs, poses and motions for the tests: reachable, and away from the singularities."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
import pytest
from hypothesis import assume
from hypothesis import strategies as st

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.model.design import APPENDIX_4, PARAMETER, Design, Geometry, KneeBranch
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.parameters import (
    Inertias,
    JointMasses,
    LinkMasses,
    Parameter,
    Payload,
    Platform,
    possible_range,
)
from tests import oracle

MARGIN = 0.05
"""Share of a length that random poses keep from every limit."""


def possible_values(parameter: Parameter) -> st.SearchStrategy[float]:
    """Draw any number that a design takes at a place, if it contradicts no other one."""
    low, high = possible_range(parameter.unit, parameter.positive)
    if parameter.path == "geometry.magnification":
        low += 1.0
    numbers = st.floats(-high if parameter.signed else low, high)
    return numbers if parameter.positive else st.just(0.0) | numbers


@st.composite
def edge_designs(draw: st.DrawFn, paths: tuple[str, ...] = tuple(PARAMETER)) -> Design:
    """Draw a robot with one to three numbers at an end of their range, or equal to another."""
    robot = random_design(np.random.default_rng(draw(st.integers(0, 99))))
    base = draw(st.sampled_from([APPENDIX_4, robot]))
    changes = {}
    for path in draw(st.lists(st.sampled_from(paths), unique=True, min_size=1, max_size=3)):
        item = PARAMETER[path]
        low, high = item.limits or possible_range(item.unit, item.positive)
        ends = [low, high, 10 * low, 1e-3, 0.5 * item.default, 2.0 * item.default]
        ends += [] if item.positive else [0.0]
        ends += [-high] if item.signed else []
        ends += {
            "geometry.magnification": [1 + 1e-6, 1.001, 1.35, 50.0],
            "geometry.platform_radius": [base.geometry.base_radius],
            "geometry.crank_length": [base.geometry.coupler_length],
        }.get(path, [])
        changes[path] = draw(st.sampled_from(ends))
    try:
        return base.vary(changes)
    except InvalidDesign:
        assume(False)
        raise


LOADS = ("gravity", *MASS_PATHS)
"""Design values that torques are proportional to; they contradict no other ones."""


@st.composite
def possible_designs(draw: st.DrawFn, paths: tuple[str, ...] = tuple(PARAMETER)) -> Design:
    """Draw Appendix 4's robot with some numbers changed to anything that a design takes."""
    chosen = draw(st.lists(st.sampled_from(paths), unique=True))
    try:
        return APPENDIX_4.vary({path: draw(possible_values(PARAMETER[path])) for path in chosen})
    except InvalidDesign:
        assume(False)
        raise


def random_design(rng: np.random.Generator, *, payload: bool = True) -> Design:
    """Draw a robot: k from 1.6 to 5, other lengths, masses, inertias, payload and gravity."""
    k = rng.uniform(1.6, 5.0)
    base = 0.35 * rng.uniform(0.5, 2.0)
    platform = base * rng.uniform(0.15, 0.5)
    span = k / (k - 1) * (base - platform)
    bars = span * rng.uniform(1.6, 2.4)
    share = rng.uniform(0.35, 0.5)
    geometry = Geometry(
        magnification=k,
        base_radius=base,
        platform_radius=platform,
        arm_length=base * rng.uniform(0.5, 1.0),
        shaft_length=rng.uniform(0.2, 0.8),
        crank_length=share * bars,
        coupler_length=(1 - share) * bars,
        platform_joint_height=rng.uniform(0.0, 0.06),
        guide_link_length=base / (k - 1) * rng.uniform(1.2, 2.0),
    )
    inertias = {}
    for bar in ("b3", "b4", "b7", "b8"):
        across = rng.uniform(0.002, 0.06)
        inertias[f"{bar}_transverse"] = across
        inertias[f"{bar}_axial"] = across * rng.uniform(0.02, 0.9)
    return Design(
        geometry=geometry,
        joints=JointMasses(**{f"j{i}": rng.uniform(0.05, 0.6) for i in (2, 3, 4, 5, 7, 8, 9)}),
        links=LinkMasses(**{f"b{i}": rng.uniform(0.1, 1.5) for i in (1, 2, 3, 4, 7, 8, 10)}),
        inertias=Inertias(
            **inertias,
            b2_vertical=rng.uniform(0.001, 0.01),
            b10_vertical=rng.uniform(0.005, 0.05),
        ),
        platform=Platform(mass=rng.uniform(0.5, 5.0), inertia=rng.uniform(0.005, 0.05)),
        payload=Payload(rng.uniform(0.0, 10.0), rng.uniform(0.0, 0.1), rng.uniform(-0.2, 0.2))
        if payload
        else Payload(),
        gravity=rng.uniform(1.6, 12.0),
        name="random",
    )


def usable(design: Design, poses: Any) -> Any:
    """True where a pose keeps `MARGIN` from every limit of reach and both kinds of singularity."""
    g = design.geometry
    poses = np.asarray(poses, float)
    good = np.ones(poses.shape[:-1], bool)
    for index in range(3):
        angle = oracle.AXIS_ANGLES[index]
        across = [
            poses[..., 0]
            + g.platform_radius * np.cos(poses[..., 2] + angle)
            - g.base_radius * np.cos(angle),
            poses[..., 1]
            + g.platform_radius * np.sin(poses[..., 2] + angle)
            - g.base_radius * np.sin(angle),
        ]
        near = np.hypot(*across)
        span = np.hypot(
            g.magnification / (g.magnification - 1) * near, poses[..., 3] + g.platform_joint_height
        )
        longest = g.crank_length + g.coupler_length
        room = MARGIN * longest
        good &= near > max(g.axis_clearance, MARGIN * g.base_radius)
        good &= near / (g.magnification - 1) < (1 - MARGIN) * g.stroke
        good &= (span < longest - room) & (span > abs(g.coupler_length - g.crank_length) + room)
    theta, radius = poses[..., 2], np.hypot(poses[..., 0], poses[..., 1])
    ratio = g.platform_radius / g.base_radius
    locus = g.base_radius * np.sqrt(np.maximum(1 + ratio**2 - 2 * ratio * np.cos(theta), 0.0))
    good &= np.abs(np.cos(theta) - ratio) > 2 * MARGIN
    good &= np.abs(radius - locus) > MARGIN * g.base_radius
    with np.errstate(all="ignore"):
        jacobian = oracle.actuator_jacobian(design, poses)[..., :3, :3]
    scaled = jacobian * np.array([g.base_radius, g.base_radius, 1.0])
    scaled = np.where(good[..., None, None], scaled, 0.0)
    return good & (np.linalg.svd(scaled, compute_uv=False)[..., -1] > MARGIN)


def random_poses(
    rng: np.random.Generator,
    design: Design = APPENDIX_4,
    n: int = 1,
    *,
    natural: bool = True,
) -> Any:
    """Draw n usable poses (n, 4).

    ``natural`` keeps the platform on the natural side: hanging (z < 0) with the lower knee,
    standing (z > 0) with the upper one. Without it both signs occur with both.

    Raises:
        RuntimeError: If the design leaves almost no such poses.
    """
    g = design.geometry
    longest = g.crank_length + g.coupler_length
    found = np.empty((0, 4))
    for _ in range(200):
        if len(found) >= n:
            return found[:n]
        count = max(4 * n, 64)
        radius = 0.8 * g.base_radius * np.sqrt(rng.uniform(size=count))
        angle = rng.uniform(0, 2 * np.pi, count)
        height = rng.uniform(0.02 if natural else -1.0, 1.0, count) * longest
        if natural:
            height = -g.knee.sign * (height + g.platform_joint_height)
        turn = rng.uniform(-1.2, 1.2, count)
        drawn = np.stack([radius * np.cos(angle), radius * np.sin(angle), turn, height], axis=-1)
        found = np.concatenate([found, drawn[usable(design, drawn)]])
    raise RuntimeError(f"only {len(found)} of {n} usable poses found for {design}")


def random_states(
    rng: np.random.Generator,
    design: Design = APPENDIX_4,
    n: int = 1,
) -> tuple[Any, Any, Any]:
    """Draw n poses with their rates and accelerations, each (n, 4).

    Of the size of Appendix 4's robot: up to 1 m/s, 2 rad/s, 5 m/s^2, 10 rad/s^2; lengths in
    proportion to the robot.
    """
    poses = random_poses(rng, design, n)
    size = design.geometry.base_radius / APPENDIX_4.geometry.base_radius
    rates = rng.uniform(-1, 1, (n, 4)) * [size, size, 2.0, size]
    seconds = rng.uniform(-1, 1, (n, 4)) * [5.0 * size, 5.0 * size, 10.0, 5.0 * size]
    return poses, rates, seconds


def each_robot(seeds: Iterable[int]) -> pytest.MarkDecorator:
    """Run a test with Appendix 4's robot and random ones, each on both branches of the knee."""
    robots = [("appendix4", APPENDIX_4)]
    robots += [(f"random{seed}", random_design(np.random.default_rng(seed))) for seed in seeds]
    return pytest.mark.parametrize(
        "design",
        [
            pytest.param(robot.with_knee(knee), id=f"{name}-{knee.value}")
            for name, robot in robots
            for knee in KneeBranch
        ],
    )


Robot = TypeVar("Robot", Design, Geometry)


def resized(design: Design, times: float) -> Design:
    """Return a design with all lengths of its geometry so many times as long."""
    lengths = {
        name: times * getattr(design.geometry, name)
        for name in (
            "base_radius", "platform_radius", "arm_length", "shaft_length", "crank_length",
            "coupler_length", "platform_joint_height", "guide_link_length",
        )
    }  # fmt: skip
    return replace(design, geometry=replace(design.geometry, **lengths))


def with_knee(robot: Robot, knee: KneeBranch) -> Robot:
    """The same robot with its knees on a branch."""
    if isinstance(robot, Design):
        return robot.with_knee(knee)
    return replace(robot, knee=knee)


def prototype_times(factor: float) -> Design:
    """Return Appendix 4's robot with lengths times a factor, masses and inertias in proportion.

    Its bodies stay as large as the prototype's, see `enlarged`.
    """
    return enlarged(APPENDIX_4, factor).vary({"geometry.body_scale": 1.0})


def enlarged(design: Design, factor: float) -> Design:
    """Return a robot with all lengths, bodies included, times a factor, masses in proportion."""
    powers = {"m": 1, "kg": 3, "kg m^2": 5}
    groups = ("geometry", "joints", "links", "inertias", "platform", "payload")
    changes = {
        path: design.value(path) * factor ** powers[item.unit]
        for path, item in PARAMETER.items()
        if path.split(".")[0] in groups and item.unit in powers
    }
    changes["geometry.body_scale"] = factor * design.geometry.body_scale
    weights = tuple(
        replace(weight, beyond=factor * weight.beyond, mass=factor**3 * weight.mass)
        for weight in design.counterweights
    )
    return replace(design.vary(changes), counterweights=weights)
