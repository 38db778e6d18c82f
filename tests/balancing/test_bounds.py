"""Arguments that are just possible and just not, gaps, and the words of places and springs."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing import (
    AddedMass,
    Changes,
    CounterweightRange,
    MassChange,
    MassRange,
    Optimum,
    Spring,
    SpringFit,
    SpringPlace,
    along,
    at_joint,
    balance,
    fit_springs,
    length_tolerance,
    mass_tolerance,
    on_bar,
    on_guide,
    on_slider,
    optimize,
    pareto_front,
    tornado,
)
from paminsa_viz.balancing.changes import MOST, mass_space
from paminsa_viz.balancing.optimum import LARGEST, WIDER, WIDER_TIMES
from paminsa_viz.balancing.paper_balance import (
    MASSES_IN_MP2,
    MOST_ADDED,
    MOST_TIMES,
    paper_changes,
)
from paminsa_viz.balancing.program import Solution
from paminsa_viz.balancing.springs import STIFFEST, Anchor, springs_of
from paminsa_viz.model import (
    APPENDIX_4,
    Grid,
    InvalidDesign,
    InvalidInput,
    static_imbalance,
)
from paminsa_viz.model.parameters import LARGEST as LARGEST_BY_UNIT
from tests.support.documentation import defaults_of, missing
from tests.support.samples import prototype_times

POSE = [0.02, 0.01, 0.1, -0.5]
FEW = Grid.over((0.0, 0.0, 0.0, -0.5), x=np.array([-0.05, 0.05]))
LONGEST = LARGEST_BY_UNIT["m"]
MASSES = Changes((MassRange("joints.j9", 0.1, 0.3), MassRange("joints.j7", 0.28, 0.5)))
SPRING = partial(SpringPlace, on_slider(0.2), at_joint(9))
BELOW_1 = float(np.nextafter(1.0, 0.0))


def above(value: float) -> float:
    return float(np.nextafter(value, np.inf))


@pytest.mark.parametrize(
    ("make", "possible", "impossible"),
    [
        (lambda v: MassRange("joints.j7", v, 1.0), [0.0, 1.0], [-1e-12, above(1.0), np.nan]),
        (lambda v: MassRange("joints.j7", 0.0, v), [0.0, MOST], [-1e-12, above(MOST), np.nan]),
        (lambda v: CounterweightRange("b8", 8, v, 0.1, 1.0), [0.0, 0.1], [above(0.1), np.nan]),
        (lambda v: CounterweightRange("b8", 8, 0.0, 0.1, 1.0, v), [0.0, 1.0], [above(1.0), -1e-9]),
        (SPRING, [0.0, STIFFEST], [-1e-9, above(STIFFEST), np.nan]),
        (lambda v: SPRING(1.0, v, 0.2), [0.0, 0.2], [-1e-9, above(0.2), np.nan]),
        (lambda v: SPRING(1.0, 0.0, v), [0.0, LONGEST], [-1e-9, above(LONGEST), np.inf]),
        (at_joint, [2, 3, 4, 5, 7, 8, 9], [1, 6, 10]),
        (lambda v: on_guide(v, 0.0), [-LONGEST, LONGEST], [above(LONGEST), -np.inf, np.nan]),
        (lambda v: on_guide(0.0, v), [-LONGEST, LONGEST], [above(LONGEST), -np.inf, np.nan]),
        (on_slider, [-LONGEST, LONGEST], [above(LONGEST), np.nan]),
        (
            lambda v: optimize(APPENDIX_4, Changes(), [(v, AddedMass())]),
            [0.0, LARGEST], [-1e-12, above(LARGEST), np.nan],
        ),
        (
            lambda v: optimize(APPENDIX_4, Changes(), AddedMass(), limits=[(AddedMass(), v)]),
            [0.0, LARGEST], [above(LARGEST), -above(LARGEST), np.nan],
        ),
        (lambda v: mass_tolerance(APPENDIX_4, v, POSE), [0.0, BELOW_1], [-1e-12, 1.0, [0.1]]),
        (lambda v: length_tolerance(APPENDIX_4, 0.01, POSE, samples=v), [1], [0]),
        (lambda v: tornado(APPENDIX_4, FEW, change=v, paths=["joints.j9"]),
         [1e-3, BELOW_1], [0.0, 1.0, 1.5]),
        (lambda v: pareto_front(APPENDIX_4, MASSES, AddedMass(), MassChange(), points=v), [2], [1]),
    ],
    ids=range(17),
)  # fmt: skip
def test_what_is_just_possible_is_done_and_what_is_just_not_is_refused(
    make: Callable[[Any], Any], possible: Any, impossible: Any
) -> None:
    for value in possible:
        make(value)
    for value in impossible:
        with pytest.raises((InvalidInput, InvalidDesign)):
            make(value)


def test_numbers_of_the_documentation_are_those_of_the_program() -> None:
    sentences = [
        f"each only upward and by {MOST_ADDED:g} kg at most, in a heavier robot by "
        f"{MOST_TIMES:g} times what they weigh together on a leg",
        f"least movement, by up to {WIDER:g} kg, in a heavier robot by {WIDER_TIMES:g} times what "
        "joints and links of a leg weigh, would do",
    ]
    assert missing("balancing", sentences) == []


@pytest.mark.parametrize(
    ("function", "defaults"),
    [
        (optimize, {"limits": (), "tolerance": 1e-9}),
        (balance, {"changes": None, "criterion": None, "exact": False}),
        (pareto_front, {"points": 12, "limits": ()}),
        (tornado, {"change": 0.05, "trajectory": None}),
        (length_tolerance, {"samples": 200, "seed": 0}),
        (fit_springs, {"measure": "peak"}),
        (SpringPlace, {"max_stiffness": 1e5, "min_free_length": 0.0, "max_free_length": 0.0}),
        (Spring, {"free_length": 0.0}),
        (MassRange, {"inertia_follows": True}),
        (CounterweightRange, {"low": 0.0}),
        (Changes, {"masses": (), "counterweights": ()}),
        (Anchor, {"joint": 0, "bar": "", "beyond": 0.0, "radius": 0.0, "height": 0.0}),
    ],
)
def test_defaults_are_those_of_the_descriptions(function: Any, defaults: dict[str, Any]) -> None:
    """A front of twelve points, a twentieth to both sides, two hundred robots, springs to 1e5."""
    assert defaults_of(function, defaults) == defaults


def test_a_gap_is_what_is_above_the_bound_and_never_negative() -> None:
    for value, bound, gap in ((3.0, 2.5, 0.5), (3.0, 3.0, 0.0), (3.0, 3.0 + 1e-12, 0.0)):
        fit = SpringFit((), 4.0, value, bound, (), 0.0)
        best = Optimum(APPENDIX_4, APPENDIX_4, (), value, bound, (), 1, 0.0)
        none = np.zeros(0)
        solution = Solution(none, none, [], value, bound, none, none, none, 1)
        assert fit.gap == best.gap == solution.gap == gap


def test_springs_and_places_are_named_with_their_lengths() -> None:
    assert at_joint(7).name == "joint 7"
    assert on_slider(0.25).name == "mast on slider 8, 250 mm above"
    assert on_guide(-0.2, 0.1).name == "post on the guide link, -200 mm from the axis, 100 mm above"
    assert on_bar("b3", 7, 0.1).name == "B3, 100 mm beyond joint 7"
    ranged = CounterweightRange("b8", 9, 0.0, 0.1, 1.0)
    assert ranged.name == "counterweight on B8 from joint 9"


def test_springs_of_an_answer_have_the_length_that_it_holds_however_soft_they_are() -> None:
    places = [SpringPlace(on_slider(0.2), at_joint(9), 1e3, low, 0.4) for low in (0.1, 0.15, 0.0)]
    stiffness, free = np.array([0.5, 0.0, 800.0]), [0.3, 0.15, 0.0]  # without K the shortest
    found = springs_of(places, np.column_stack([stiffness, stiffness * free]).ravel())
    for spring, place, k, length in zip(found, places, stiffness, free, strict=True):
        assert (spring.first, spring.second) == (place.first, place.second)
        assert (spring.stiffness, spring.free_length) == pytest.approx((k, length))


def test_a_bar_carries_a_weight_all_along_it_from_its_first_joint() -> None:
    """Back from there to the other one: the ends of the range are the bar's joints."""
    g = APPENDIX_4.geometry
    lengths = {"b3": g.crank_length, "b4": g.coupler_length, "b8": g.crank_length}
    lengths["b7"] = g.short_coupler_length
    for bar, length in lengths.items():
        found = along(g, bar, 2.5)
        assert (found.nearest, found.farthest) == pytest.approx((-length, 0.0))
        assert (found.low, found.high) == (0.0, 2.5)
        other = CounterweightRange(bar, {"b3": 7, "b4": 5, "b7": 7, "b8": 9}[bar], 0.0, 0.0, 1.0)
        here, there = (
            mass_space(APPENDIX_4, Changes((), (one,))).variables[0] for one in (found, other)
        )
        np.testing.assert_allclose(here.column(found.nearest), there.column(0.0), atol=1e-12)
    with pytest.raises(InvalidInput, match="b3, b4, b7, b8 is needed"):
        along(g, "b10", 1.0)


def test_the_papers_balance_may_add_to_the_masses_in_m_p2_alone() -> None:
    """Each of them upward by so much as is said, but not beyond what a design may have."""
    heavy = APPENDIX_4.vary({"joints.j7": MOST - 1.0})
    for most in (MOST_ADDED, 3.5):
        found = paper_changes(APPENDIX_4, most)
        assert tuple(item.path for item in found.masses) == MASSES_IN_MP2
        for item in found.masses:
            held = APPENDIX_4.value(item.path)
            assert (item.low, item.high) == pytest.approx((held, held + most))
            assert not item.inertia_follows
    assert paper_changes(APPENDIX_4) == paper_changes(APPENDIX_4, MOST_ADDED)
    assert {item.path: item.high for item in paper_changes(heavy).masses}["joints.j7"] == MOST
    assert balance(APPENDIX_4).after == balance(APPENDIX_4, paper_changes(APPENDIX_4)).after


def test_a_robot_of_ten_times_the_lengths_is_balanced_within_the_default_bounds() -> None:
    """Its masses are 1000 times Appendix 4's, as is the mass that has to be added."""
    large = prototype_times(10.0)
    added = [found.values[1].after for found in (balance(APPENDIX_4), balance(large))]
    assert added[1] == pytest.approx(1e3 * added[0])
    assert static_imbalance(balance(large).after) == pytest.approx(0.0, abs=1e-9)


def test_masses_count_as_often_as_the_robot_has_them() -> None:
    paths = {"platform.mass": 1, "payload.mass": 1, "joints.j7": 3, "links.b4": 3}
    space = mass_space(
        APPENDIX_4,
        Changes(
            tuple(MassRange(path, 0.0, 1.0) for path in paths),
            (CounterweightRange("b8", 8, 0.0, 0.1, 1.0),),
        ),
    )
    assert space.counts.tolist() == [*paths.values(), 3]
