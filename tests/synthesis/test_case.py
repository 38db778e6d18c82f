"""Cases: what is searched and held, what follows from it, and what contradicts itself."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, KneeBranch
from paminsa_viz.model.geometry import BODY_SCALE
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis import Effort, ObjectiveLimit, Regime, SearchRange, SynthesisCase
from paminsa_viz.synthesis.search.case import Guide

BOX = Workspace(WorkspaceShape.BOX, (0.3, 0.2, 0.4), (0.0, 0.02, None))
CRANK = SearchRange("geometry.crank_length", 0.3, 0.8)
COUPLER = SearchRange("geometry.coupler_length", 0.3, 0.9)
CASE = SynthesisCase(Requirements((), (-0.5, 0.5), BOX), (CRANK, COUPLER))


def test_the_height_is_searched_as_far_as_the_longest_bars_reach() -> None:
    assert CASE.paths == ("geometry.crank_length", "geometry.coupler_length", "workspace.z")
    offset = APPENDIX_4.geometry.platform_joint_height
    low, high = CASE.bounds[-1] + offset
    assert (low, high) == pytest.approx((-1.7, -0.2))  # the top is where the guides are
    upper = replace(CASE, reference=APPENDIX_4.with_knee(KneeBranch.UPPER), ranges=(CRANK, COUPLER))
    assert upper.bounds[-1] + offset == pytest.approx([0.2, 1.7])
    free = replace(CASE, above_guides=True, ranges=(CRANK,))
    longest = 0.8 + APPENDIX_4.geometry.coupler_length
    assert free.bounds[-1] == pytest.approx([-longest, longest])
    given = replace(CASE, ranges=(CRANK, SearchRange("workspace.z", -0.9, -0.4)))
    assert given.bounds[-1] == pytest.approx([-0.9, -0.4])
    fixed = replace(CASE.requirements, workspace=replace(BOX, center=(0.0, 0.0, -0.6)))
    assert replace(CASE, requirements=fixed, ranges=(CRANK,)).paths == ("geometry.crank_length",)


def test_a_place_that_is_left_free_is_on_the_axis() -> None:
    """As the robot is alike about it; a place that is given stays."""
    for place, kept in (
        ((None, None), (0.0, 0.0)), ((None, 0.1), (0.0, 0.1)), ((0.2, None), (0.2, 0.0)),
        ((0.2, 0.1), (0.2, 0.1)),
    ):  # fmt: skip
        space = replace(BOX, center=(*place, -0.5))
        case = SynthesisCase(Requirements((), (0.0, 0.0), space), (CRANK,))
        assert case.workspace == replace(space, center=(*kept, -0.5))
    # a workspace that is taller than all bars has a height all the same, hardly any
    tall = replace(BOX, size=(0.3, 0.2, 9.0), center=(0.0, 0.0, None))
    case = SynthesisCase(Requirements((), (0.0, 0.0), tall), (CRANK, COUPLER))
    offset = APPENDIX_4.geometry.platform_joint_height
    low, high = case.bounds[-1] + offset
    assert low == pytest.approx(-1.7)
    assert -1.7 < high < -1.69


def test_signs_of_regimes_and_what_tells_cases_apart() -> None:
    assert [regime.sign for regime in Regime] == [1.0, -1.0]
    assert replace(CASE, name="other") == CASE
    assert replace(CASE, seed=1) != CASE


def test_what_is_not_searched_is_held() -> None:
    case = replace(CASE, ranges=(CRANK, SearchRange("workspace.width", 0.1, 0.5)))
    assert (case.least("geometry.crank_length"), case.most("geometry.crank_length")) == (0.3, 0.8)
    held = APPENDIX_4.geometry.coupler_length
    assert case.least("geometry.coupler_length") == case.most("geometry.coupler_length") == held
    assert (case.least("workspace.width"), case.most("workspace.width")) == (0.1, 0.5)
    assert case.most("workspace.height") == 0.4
    assert CASE.most("workspace.width") == 0.3  # the larger of both sides
    deep = replace(CASE.requirements, workspace=replace(BOX, size=(0.3, 0.7, 0.4)))
    assert replace(CASE, requirements=deep).most("workspace.width") == 0.7
    assert math.isnan(CASE._held("workspace.z"))


def test_numbers_of_a_trial_are_its_lengths_and_its_workspace() -> None:
    ranges = (
        SearchRange("geometry.base_radius", 0.2, 0.9), SearchRange("workspace.width", 0.1, 0.5),
        SearchRange("workspace.height", 0.1, 0.5), SearchRange("workspace.z", -0.9, -0.4),
    )  # fmt: skip
    case, numbers = replace(CASE, ranges=ranges), np.array([0.5, 0.15, 0.2, -0.6])
    assert case.split(numbers) == (
        {"geometry.base_radius": 0.5},
        {"workspace.width": 0.15, "workspace.height": 0.2, "workspace.z": -0.6},
    )
    space = case.workspace_of(numbers)
    assert space.size == pytest.approx((0.15, 0.1, 0.2))  # as deep for its width as the case's
    assert space.center == (0.0, 0.02, -0.6)
    deep = replace(CASE, ranges=(CRANK, SearchRange("workspace.height", 0.1, 0.5)))
    space = deep.workspace_of(np.array([0.4, 0.25, -0.7]))
    assert (space.size, space.center) == ((0.3, 0.2, 0.25), (0.0, 0.02, -0.7))
    own = APPENDIX_4.geometry
    grown = case.geometry(numbers)
    assert grown.base_radius == 0.5
    assert grown.arm_length == pytest.approx(own.arm_length + 0.5 - own.base_radius)
    assert replace(case, arm_follows=False).geometry(numbers).arm_length == own.arm_length
    small = replace(case, ranges=(SearchRange("geometry.base_radius", 0.01, 0.9),))
    assert small.geometry(np.array([0.01, -0.5])).arm_length == 0.0
    kept = replace(APPENDIX_4, geometry=replace(own, guide_stroke=0.1))
    for guide, stroke in ((Guide.FOLLOWS, None), (Guide.KEPT, 0.1)):
        found = replace(case, reference=kept, guide=guide).geometry(numbers)
        assert found.guide_stroke == stroke
    assert case.design(grown).geometry == grown
    assert case.design(grown).links.b1 > APPENDIX_4.links.b1


def test_bodies_are_apart_unless_the_case_says_otherwise() -> None:
    apart = Requirement("clearance", low=0.001)
    assert CASE.requirements.bounds == (apart,)
    assert CASE.clear
    assert CASE.title == "synthesis"
    loose = replace(CASE, allow_overlap=True)
    assert loose.requirements.bounds == ()
    assert not loose.clear
    assert loose.title == "synthesis, overlap allowed"
    assert replace(loose, allow_overlap=False) == CASE
    own = Requirement("clearance", low=0.005)
    for allowed in (False, True):
        required = Requirements((own,), (0.0, 0.0), BOX)
        case = SynthesisCase(required, (CRANK,), allow_overlap=allowed)
        assert case.requirements.bounds == (own,)
        assert case.clear
    touching = Requirement("clearance", low=0.0)
    case = SynthesisCase(Requirements((touching,), (0.0, 0.0), BOX), (CRANK,))
    assert case.clear
    assert case.requirements.bounds == (touching,)
    near = Requirement("clearance", low=-0.002)
    case = SynthesisCase(Requirements((near,), (0.0, 0.0), BOX), (CRANK,), clearance=0.0)
    assert case.requirements.bounds == (near, replace(apart, low=0.0))


def test_margins_of_limits_are_toward_what_is_better() -> None:
    least = ObjectiveLimit("moving_mass", 3.0)
    assert (least.margin(2.5), least.margin(3.5)) == (0.5, -0.5)
    largest = ObjectiveLimit("volume", 3.0)
    assert (largest.margin(2.5), largest.margin(3.5)) == (-0.5, 0.5)


def changed(**changes: Any) -> SynthesisCase:
    return replace(CASE, ranges=changes.pop("ranges", (CRANK, COUPLER)), **changes)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: changed(requirements=Requirements((), (0.0, 0.0))), "workspace: a workspace is"),
        (lambda: changed(ranges=()), "ranges: at least one length"),
        (lambda: changed(ranges=(CRANK, CRANK)), "geometry.crank_length: it is searched twice"),
        (
            lambda: changed(
                requirements=Requirements((), (0, 0), replace(BOX, center=(0.0, 0.0, -0.6))),
                ranges=(CRANK, SearchRange("workspace.z", -0.9, -0.4)),
            ),
            "workspace.z: it is given",
        ),
        (
            lambda: changed(ranges=(SearchRange("geometry.guide_link_length", 0.1, 0.2),)),
            'guide_link_length: it is searched only with guide = "kept"',
        ),
        (
            lambda: changed(ranges=(SearchRange("geometry.arm_length", 0.1, 0.2),)),
            "arm_length: it is searched only with arm_follows = false",
        ),
        (lambda: changed(margin=-1e-6), "margin: at least 0 is needed"),
        (lambda: changed(margin=math.inf), "margin: at least 0 is needed"),
        (lambda: changed(clearance=-1e-6), "clearance: at least 0 is needed"),
        (lambda: changed(clearance=math.nan), "clearance: at least 0 is needed"),
        (lambda: changed(seed=-1), "seed: a whole number of at least 0"),
        (lambda: changed(margin="1"), "margin: at least 0 is needed, not '1'"),
        (lambda: changed(seed=1.5), "seed: a whole number of at least 0 is needed, not 1.5"),
        (lambda: changed(regimes=()), "regimes: at least one of"),
        (lambda: changed(objective="beauty"), "beauty"),
        (lambda: SearchRange("links.b3", 0.1, 0.2), "links.b3: only lengths can be searched"),
        (lambda: SearchRange(BODY_SCALE, 0.1, 0.2), f"{BODY_SCALE}: only lengths can be searched"),
        (lambda: SearchRange("geometry.crank_length", 0.2, 0.2), "a range with low < high"),
        (lambda: SearchRange("geometry.crank_length", 0.2, math.inf), "a range with low < high"),
        (lambda: SearchRange("geometry.crank_length", "0.2", 0.3), "not '0.2' to 0.3"),  # type: ignore
        (lambda: SearchRange("geometry.crank_length", 0.0, 0.2), "above 0, not 0.0"),
        (lambda: ObjectiveLimit("moving_mass", math.nan), "moving_mass: a finite limit"),
        (lambda: Effort(0, 8), "effort.generations: 1 to 100000 is possible, not 0"),
        (lambda: Effort(1, 3), "effort.population: 4 to 100000 is possible, not 3"),
        (lambda: Effort(100_001, 8), "effort.generations"),
        (lambda: Effort(1.5, 8), "effort.generations"),  # type: ignore[arg-type]
    ],
    ids=count(),
)
def test_cases_that_contradict_themselves_are_refused(make: Any, words: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        make()
    assert words in str(caught.value)


def test_what_is_just_possible_is_taken() -> None:
    assert changed(margin=0.0, clearance=0.0, seed=0).margin == 0.0
    assert Effort(1, 4) == Effort(generations=1, population=4)
    assert Effort(100_000, 100_000).population == 100_000
    assert SearchRange("workspace.z", -0.5, 0.0).low == -0.5
