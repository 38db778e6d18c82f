"""Any documents and states, for tests of what is done with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.state import Document, State, initial_state
from paminsa_viz.model import APPENDIX_4, PARAMETER, Design, KneeBranch
from paminsa_viz.model.parameters import BAR_ENDS, Counterweight
from tests.support.samples import possible_values, random_design, random_poses

COUNTERWEIGHTS = st.builds(
    lambda place, end, beyond, mass: Counterweight(place[0], place[1][end], beyond, mass),
    st.sampled_from(list(BAR_ENDS.items())),
    st.sampled_from([0, 1]),
    st.floats(-0.5, 0.5),
    possible_values(PARAMETER["links.b3"]),
)


@st.composite
def designs(draw: st.DrawFn) -> Design:
    """Draw any robot, with any counterweights and name, and the stroke set or not."""
    design = random_design(np.random.default_rng(draw(st.integers(0, 10**6))))
    if draw(st.booleans()):
        stroke = draw(st.sampled_from([APPENDIX_4.geometry.stroke, 0.2, 0.417]))
        design = design.vary({"geometry.guide_stroke": stroke})
    printable = st.characters(exclude_categories=("C", "Z"))
    weights = tuple(draw(st.lists(COUNTERWEIGHTS, max_size=3)))
    return replace(design, counterweights=weights, name=draw(st.text(printable, max_size=30)))


COORDINATE = st.floats(-3, 3)


def _document(knee: KneeBranch, document: Document) -> Document:
    reference = document.reference
    return replace(
        document,
        design=document.design.with_knee(knee),
        reference=None if reference is None else reference.with_knee(knee),
    )


DOCUMENTS = st.builds(
    Document,
    design=designs(),
    pose=st.tuples(COORDINATE, COORDINATE, COORDINATE, COORDINATE),
    reference=st.none() | designs(),
).flatmap(lambda document: st.sampled_from(KneeBranch).map(lambda k: _document(k, document)))


def state_at_random_pose(seed: int) -> State:
    """Return a state with a random robot at a random pose."""
    rng = np.random.default_rng(seed)
    design = random_design(rng)
    x, y, theta, z = (float(v) for v in random_poses(rng, design)[0])
    state = initial_state(design)
    return actions.move(state, x=x, y=y, theta=theta, z=z)


def assert_same(a: Document, b: Document) -> None:
    """Compare two documents and, what equality leaves out, the names of their designs."""
    assert a == b
    assert a.design.name == b.design.name
    if a.reference is not None:
        assert b.reference is not None
        assert a.reference.name == b.reference.name
