"""Any documents and states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.explorer.state.motion import Kind, Motion, Timing
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import APPENDIX_4, PARAMETER, Design, KneeBranch
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.load import LoadCase, LoadFrame
from paminsa_viz.model.parameters import BAR_ENDS, Counterweight
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirements import (
    Requirement,
    Requirements,
    Workspace,
    WorkspaceShape,
)
from paminsa_viz.trajectory import PRESETS, MotionLimits, Profile
from tests.support.samples import possible_values, random_design, random_poses

COUNTERWEIGHTS = st.builds(
    lambda place, end, beyond, mass: Counterweight(place[0], place[1][end], beyond, mass),
    st.sampled_from(list(BAR_ENDS.items())),
    st.sampled_from([0, 1]),
    st.floats(-0.5, 0.5),
    possible_values(PARAMETER["links.b3"]),
)
LOADS = st.builds(
    LoadCase,
    force_x=st.floats(-100, 100),
    moment_z=st.floats(-10, 10),
    point_y=st.floats(-1, 1),
    frame=st.sampled_from(LoadFrame),
)
DRIVE = Drive("motor", 1e-6, envelope=((0.0, 1.0), (9.0, 0.5)))


@st.composite
def designs(draw: st.DrawFn) -> Design:
    """Draw any robot, with any counterweights, load, drives and name, and the stroke set or not."""
    design = random_design(np.random.default_rng(draw(st.integers(0, 10**6))))
    if draw(st.booleans()):
        stroke = draw(st.sampled_from([APPENDIX_4.geometry.stroke, 0.2, 0.417]))
        design = design.vary({"geometry.guide_stroke": stroke})
    printable = st.characters(exclude_categories=("C", "Z"))
    return replace(
        design,
        counterweights=tuple(draw(st.lists(COUNTERWEIGHTS, max_size=3))),
        load=draw(st.just(LoadCase()) | LOADS),
        drives=draw(st.sampled_from([(None,) * 4, (DRIVE, None, None, None)])),
        name=draw(st.text(printable, max_size=30)),
    )


COORDINATE = st.floats(-3, 3)
POSES = st.tuples(COORDINATE, COORDINATE, COORDINATE, COORDINATE)
LIMIT = st.none() | st.floats(0.01, 100)
MOTIONS = st.builds(
    Motion,
    kind=st.sampled_from([kind for kind in Kind if kind is not Kind.TABLE]),
    preset=st.sampled_from([preset.key for preset in PRESETS]),
    start=st.none() | POSES,
    goal=st.none() | POSES,
    height=st.floats(0, 1),
    waypoints=st.lists(POSES, max_size=5).map(tuple),
    center=st.none() | POSES,
    radius=st.floats(0.001, 1),
    profile=st.sampled_from(Profile),
    timing=st.sampled_from(Timing),
    duration=st.floats(0.1, 100),
    limits=st.builds(MotionLimits, speed=LIMIT, turn_jerk=LIMIT, torque=LIMIT, force=LIMIT),
    back=st.booleans(),
    rate=st.floats(50, 10_000),
)

RANGES = st.tuples(COORDINATE, COORDINATE).map(lambda ends: (min(ends), max(ends)))
BOUNDS = st.builds(
    lambda quantity, ends, kept, theta, z: Requirement(
        quantity, ends[0] if kept != 1 else None, ends[1] if kept != 2 else None, theta, z
    ),
    st.sampled_from(list(QUANTITIES)),
    RANGES,
    st.integers(0, 2),
    st.none() | RANGES,
    st.none() | RANGES,
)
SIZE = st.floats(0.01, 2)
WORKSPACES = st.builds(
    lambda shape, x, y, z, center: Workspace(
        shape, (x, x if shape is WorkspaceShape.CYLINDER else y, z), center
    ),
    st.sampled_from(WorkspaceShape),
    SIZE,
    SIZE,
    SIZE,
    st.tuples(*(st.none() | COORDINATE,) * 3),
)
REQUIREMENTS = st.builds(
    Requirements,
    bounds=st.lists(BOUNDS, max_size=4).map(tuple),
    theta=RANGES,
    workspace=st.none() | WORKSPACES,
)


@st.composite
def documents(draw: st.DrawFn) -> Document:
    """Draw any document; design and reference have the same knee."""
    knee = draw(st.sampled_from(KneeBranch))
    with_knee = designs().map(lambda design: design.with_knee(knee))
    return Document(
        design=draw(with_knee),
        pose=draw(POSES),
        reference=draw(st.none() | with_knee),
        motion=draw(st.just(Motion()) | MOTIONS),
        requirements=draw(st.just(Requirements()) | REQUIREMENTS),
    )


def state_at_random_pose(seed: int) -> State:
    """Return a state with a random robot at a random pose."""
    rng = np.random.default_rng(seed)
    design = random_design(rng)
    x, y, theta, z = (float(v) for v in random_poses(rng, design)[0])
    return actions.move(initial_state(design), x=x, y=y, theta=theta, z=z)


def assert_same(a: Document, b: Document) -> None:
    """Compare two documents and, what equality leaves out, the names of their designs."""
    assert a == b
    assert a.design.name == b.design.name
    if a.reference is not None:
        assert b.reference is not None
        assert a.reference.name == b.reference.name
