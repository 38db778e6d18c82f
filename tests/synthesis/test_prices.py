"""What requirements cost: against closed forms of a case with one length."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis import (
    Effort,
    ObjectiveLimit,
    Regime,
    SearchRange,
    SynthesisCase,
    synthesize,
)
from paminsa_viz.synthesis.answer.prices import (
    _bound,
    _limit,
    _requirables,
    requirement_prices,
)
from paminsa_viz.synthesis.search.outer import refined
from paminsa_viz.synthesis.search.result import outcomes_of
from tests.support.samples import enlarged

HEIGHT, RADIUS = 0.2, 0.1


def one_length(**changes: object) -> SynthesisCase:
    """Return a case whose optimum is the shortest crank that reaches the lowest height."""
    space = Workspace(WorkspaceShape.CYLINDER, (2 * RADIUS, 2 * RADIUS, HEIGHT), (0.0, 0.0, -0.7))
    case = SynthesisCase(
        Requirements((Requirement("condition", high=30.0),), (0.0, 0.0), space),
        (SearchRange("geometry.crank_length", 0.2, 0.8),),
        objective="moving_mass", regimes=(Regime.SMALLER,), effort=Effort(30, 8),
        allow_overlap=True,
    )  # fmt: skip
    return replace(case, **changes)


@pytest.mark.slow
def test_workspace_costs_what_the_closed_form_says():
    case = one_length()
    result = synthesize(case)
    g = result.design.geometry
    wide = g.magnification / (g.magnification - 1)
    far = g.base_radius - g.platform_radius + RADIUS
    low = 0.8 - g.platform_joint_height
    span = np.hypot(wide * far, low)
    assert g.crank_length == pytest.approx(case.margin + span - g.coupler_length, rel=1e-5)
    # 3 (m_B3 + m_B8) per length of the crank, and the lowest height falls by half of the height
    by_crank = 3 * (APPENDIX_4.links.b3 + APPENDIX_4.links.b8) / APPENDIX_4.geometry.crank_length
    by_guide = 3 * APPENDIX_4.links.b10 / APPENDIX_4.geometry.guide_link_length
    expected = {
        "height of the workspace": by_crank * 0.5 * low / span,
        "width of the workspace": 0.5
        * (by_crank * wide**2 * far / span + by_guide / (g.magnification - 1)),
    }
    prices = {item.label: item for item in requirement_prices(result, step=0.01, rounds=6)}
    for label, price in expected.items():
        assert prices[label].price == pytest.approx(price, rel=0.01)
        assert prices[label].relaxed < result.objective < prices[label].tightened
    assert set(prices) == set(expected)


@pytest.mark.slow
def test_an_end_of_a_range_has_its_price_and_can_be_canceled():
    short = one_length(ranges=(SearchRange("geometry.crank_length", 0.6, 0.8),))
    result = synthesize(short)
    asked = []

    def tell(done):
        asked.append(done)
        return done > 3 / 7  # of seven searches, three for the first price

    (price,) = requirement_prices(result, rounds=2, progress=tell)
    assert asked == sorted(asked)
    assert len(asked) > 20
    assert price.label == "least crank_length"
    by_crank = 3 * (APPENDIX_4.links.b3 + APPENDIX_4.links.b8) / APPENDIX_4.geometry.crank_length
    assert price.price == pytest.approx(by_crank, rel=1e-3)


@pytest.mark.slow
def test_range_of_headings_costs_what_the_closed_form_says():
    """A platform turned by t has its joints 5 |R_b - R_pl e^(it)| off those of the base."""
    turn = 0.4
    case = one_length()
    result = synthesize(replace(case, requirements=replace(case.requirements, theta=(-turn, turn))))
    g = result.design.geometry
    wide = g.magnification / (g.magnification - 1)
    apart = np.sqrt(
        g.base_radius**2 + g.platform_radius**2
        - 2 * g.base_radius * g.platform_radius * np.cos(turn)
    )  # fmt: skip
    by_turn = g.base_radius * g.platform_radius * np.sin(turn) / apart
    low, far = 0.8 - g.platform_joint_height, apart + RADIUS
    span = np.hypot(wide * far, low)
    assert g.crank_length == pytest.approx(case.margin + span - g.coupler_length, rel=1e-5)
    by_crank = 3 * (APPENDIX_4.links.b3 + APPENDIX_4.links.b8) / APPENDIX_4.geometry.crank_length
    by_guide = 3 * APPENDIX_4.links.b10 / APPENDIX_4.geometry.guide_link_length
    by_far = by_crank * wide**2 * far / span + by_guide / (g.magnification - 1)
    prices = {item.label: item for item in requirement_prices(result, step=0.05)}
    # a range that is wider by one has ends that are further by a half
    assert prices["range of theta"].price == pytest.approx(0.5 * by_far * by_turn, rel=0.02)


def test_ends_that_an_answer_touches_are_asked_and_no_others():
    path, low, high = "geometry.crank_length", 0.2, 0.8
    result = synthesize(one_length(effort=Effort(1, 4)), relax=False)
    near = 0.002 * (high - low)

    def asked(value: float) -> dict[str, tuple[float, float]]:
        items = _requirables(result, [value])
        found = {item.label: item for item in items if "crank_length" in item.label}
        for item in found.values():
            (moved,) = item.moved(0.5).ranges
            assert moved.path == path
            assert (moved.low, moved.high) == ((0.5, high) if item.tighter > 0 else (low, 0.5))
        return {label: (item.bound, item.tighter) for label, item in found.items()}

    assert asked(low + 0.9 * near) == asked(low) == {"least crank_length": (low, 1.0)}
    assert asked(high - 0.9 * near) == asked(high) == {"largest crank_length": (high, -1.0)}
    assert asked(low + 1.1 * near) == asked(high - 1.1 * near) == asked(0.5) == {}
    ranges = (result.case.ranges[0], SearchRange("geometry.magnification", 2.0, 5.0))
    both = replace(result, case=replace(result.case, ranges=ranges))
    units = {item.label: item.unit for item in _requirables(both, [low, 5.0])}
    assert (units["least crank_length"], units["largest magnification"]) == ("m", "")
    low, high = 1e-300, 1.0  # the distance of a value from such an end is exact
    whole = replace(result.case.ranges[0], low=low, high=high)
    result = replace(result, case=replace(result.case, ranges=(whole,)))
    assert asked(0.002) == {"least crank_length": (low, 1.0)}


def test_sizes_and_headings_move_about_their_middle():
    """Of a box twice as deep as wide, turned from 0.1 to 0.5 rad."""
    result = synthesize(one_length(effort=Effort(1, 4)), relax=False)
    box = Workspace(WorkspaceShape.BOX, (0.1, 0.2, HEIGHT), (0.03, 0.0, -0.7))
    required = replace(result.case.requirements, theta=(0.1, 0.5), workspace=box)
    turned = replace(result, case=replace(result.case, requirements=required))
    items = {item.label: item for item in _requirables(turned, [0.5])}
    heading = items["range of theta"]
    assert heading.bound == pytest.approx(0.4)
    assert heading.tighter == 1.0
    moved = heading.moved(0.6).requirements
    assert moved.theta == pytest.approx((0.0, 0.6))
    assert moved.workspace == box
    for label, bound, size in (
        ("width of the workspace", 0.1, (0.15, 0.3, HEIGHT)),
        ("height of the workspace", HEIGHT, (0.1, 0.2, 0.15)),
    ):
        assert items[label].bound == pytest.approx(bound)
        moved = items[label].moved(0.15).requirements
        assert moved.workspace.size == pytest.approx(size)
        assert moved.workspace.center == box.center
        assert moved.theta == (0.1, 0.5)


@pytest.mark.parametrize(
    ("bound", "value", "end", "tighter"),
    [
        ((None, 3.0), 2.9, {"high": 2.5}, -1.0),
        ((1.0, None), 1.1, {"low": 2.5}, 1.0),
        ((1.0, 3.0), 1.1, {"low": 2.5}, 1.0),
        ((1.0, 3.0), 2.9, {"high": 2.5}, -1.0),
        ((1.0, 3.0), 2.0, {"high": 2.5}, -1.0),
        ((-3.0, 3.0), -2.9, {"low": -2.5, "high": 2.5}, -1.0),
    ],
)
def test_the_end_of_a_requirement_that_is_reached_moves(bound, value, end, tighter):
    item = Requirement("condition", *bound)
    case = one_length()
    case = replace(case, requirements=replace(case.requirements, bounds=(item,)))
    found = _bound(case, 0, value)
    assert found.tighter == tighter
    assert found.bound == (bound[1] if tighter < 0 else bound[0])
    (moved,) = found.moved(2.5).requirements.bounds
    assert moved == replace(item, **end)


def test_limits_of_other_objectives_move_and_only_what_is_active_is_asked():
    """A limit on what is minimized is tightened downward, one on what is maximized upward."""
    limits = (ObjectiveLimit("footprint", 0.5), ObjectiveLimit("volume", 0.2))
    result = synthesize(one_length(effort=Effort(1, 4)), relax=False)
    case = replace(result.case, limits=limits)
    for index, (tighter, unit) in enumerate(((-1.0, "m"), (1.0, "m^3"))):
        found = _limit(case, index)
        assert (found.tighter, found.bound) == (tighter, limits[index].most)
        assert found.unit == unit
        moved = found.moved(0.3).limits
        assert moved[index] == replace(limits[index], most=0.3)
        assert moved[1 - index] == limits[1 - index]
    (bound,) = result.outcomes
    names = [case.requirements.bounds[0].entry.title, *(_limit(case, i).label for i in range(2))]
    outcomes = tuple(replace(bound, value=value) for value in (29.9, 0.5, 0.2))
    for active in ((True, False, False), (False, True, False), (False, False, True)):
        rows = tuple(replace(o, active=a) for o, a in zip(outcomes, active, strict=True))
        items = list(_requirables(replace(result, case=case, outcomes=rows), [0.5]))
        asked = [item.label for item in items if item.label in names]
        assert asked == [names[active.index(True)]]


@pytest.mark.slow
def test_a_search_near_an_answer_may_start_late():
    # as many generations as the search would look for progress over, and more
    late = one_length(effort=Effort(200, 5))
    result = synthesize(late)
    start = result.design.geometry.crank_length + 0.01
    near = refined(late, Regime.SMALLER, [start], rounds=3)
    assert near.objective == pytest.approx(result.objective, rel=1e-4)


def test_an_answer_that_fails_has_no_prices():
    space = Workspace(WorkspaceShape.CYLINDER, (0.2, 0.2, 0.2), (0.0, 0.0, -3.0))
    failing = one_length(requirements=Requirements((), (0.0, 0.0), space), effort=Effort(1, 4))
    assert requirement_prices(synthesize(failing, relax=False)) == ()


def test_outcomes_are_active_within_a_share_of_their_bound():
    """Of 0.5 %, of the clearance within half a millimeter; of a range the nearer side counts.

    Small bodies have less of a clearance.
    """
    bounds = (
        Requirement("condition", high=10.0), Requirement("f_4", low=-100.0, high=400.0),
        Requirement("clearance", low=0.001),
    )  # fmt: skip
    case = one_length(allow_overlap=False, limits=(ObjectiveLimit("volume", 0.2),))
    case = replace(case, requirements=replace(case.requirements, bounds=bounds))
    items = (*case.requirements.bounds, *case.limits)

    def active(*values: float) -> list[bool]:
        rows = outcomes_of(case, SimpleNamespace(values=np.array(values)))
        for row, item, value in zip(rows, items, values, strict=True):
            assert row.bound == item
            np.testing.assert_equal(row.margin, float(item.margin(value)))
        return [row.active for row in rows]

    assert active(9.951, 398.1, 0.00149, 0.2009) == [True] * 4
    assert active(9.949, 397.9, 0.00151, 0.2011) == [False] * 4
    assert active(10.049, -99.6, 0.00051, 0.1991) == [True] * 4
    assert active(10.051, -99.4, 0.00049, 0.1989) == [False] * 4
    assert active(*[np.nan] * 4) == [False] * 4
    case = replace(case, reference=enlarged(case.reference, 0.01))
    assert active(9.951, 398.1, 0.001004, 0.2009) == [True] * 4
    assert active(9.951, 398.1, 0.001006, 0.2009) == [True, True, False, True]
