"""Least clearance of the robot: symmetry, pairs, reasons."""

from __future__ import annotations

import sys
import threading
from dataclasses import replace
from itertools import combinations, product
from typing import Any

import numpy as np
import pytest

from paminsa_viz.clearance import (
    Clearance,
    Exclusion,
    PairGroup,
    clearance,
    clearance_reason,
    group_clearance,
    kernels,
    nearest_points,
    pair_clearance,
    search,
    shapes_of,
)
from paminsa_viz.clearance.solids import WORLD, BodyPart
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import APPENDIX_4, Counterweight, Design, KneeBranch, Payload
from paminsa_viz.model.reach import home_pose
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.progress import Canceled
from tests.support.samples import random_poses, with_knee

HOME = np.array(home_pose(APPENDIX_4.geometry))
LOADED = replace(
    APPENDIX_4, payload=Payload(mass=2.0), counterweights=(Counterweight("b8", 8, 0.2, 2.0),)
)


@pytest.fixture(autouse=True)
def compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernels, "least_distances", lambda _: kernels.compiled())


def poses(design: Design, count: int) -> Array:
    return random_poses(np.random.default_rng(1), design, count)


@pytest.mark.slow
@pytest.mark.parametrize("knee", list(KneeBranch))
def test_a_turn_by_120_degrees_permutes_the_legs(knee: KneeBranch) -> None:
    design = with_knee(LOADED, knee)
    given = poses(design, 8)
    c, s = np.cos(2 * np.pi / 3), np.sin(2 * np.pi / 3)
    turned = given.copy()
    turned[:, 0] = c * given[:, 0] - s * given[:, 1]
    turned[:, 1] = s * given[:, 0] + c * given[:, 1]
    # leg 1 at 210 degrees comes to -30 degrees, where leg 2 is
    groups = [PairGroup.BETWEEN_LEGS, PairGroup.SAME_LEG, PairGroup.CARRIAGE, PairGroup.PLATFORM]
    before, after = (group_clearance(design, pose, groups) for pose in (given, turned))
    assert before == pytest.approx(after, abs=1e-12)
    shapes = shapes_of(design)
    names = {frozenset(pair): i for i, pair in enumerate(shapes.names)}
    first, second = (pair_clearance(design, pose) for pose in (given, turned))
    follow = {"1": "2", "2": "3", "3": "1"}
    for i, pair in enumerate(shapes.names):
        if shapes.groups[i] in groups:
            image = [n[:-1] + follow[n[-1]] if n[-1] in follow else n for n in pair]
            j = names[frozenset(image)]
            assert first[:, i] == pytest.approx(second[:, j], abs=1e-12), pair


@pytest.mark.slow
def test_the_least_of_all_pairs_is_the_clearance() -> None:
    given = poses(LOADED, 30)
    every, found = pair_clearance(LOADED, given), clearance(LOADED, given)
    assert found.least == pytest.approx(every.min(axis=1), abs=1e-15)
    assert np.take_along_axis(every, found.pair[:, None], 1)[:, 0] == pytest.approx(found.least)
    by_group = group_clearance(LOADED, given)
    assert by_group.min(axis=1) == pytest.approx(found.least)
    names = [shapes_of(LOADED).groups[pair] for pair in found.pair]
    places = [list(PairGroup).index(group) for group in names]
    assert np.take_along_axis(by_group, np.array(places)[:, None], 1)[:, 0] == pytest.approx(
        found.least
    )


@pytest.mark.slow
def test_plain_python_and_compiled_code_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    given = poses(LOADED, 6)
    found = clearance(LOADED, given)
    monkeypatch.setattr(kernels, "least_distances", lambda _: search.least_distances)
    plain = clearance(LOADED, given)
    assert plain.least == pytest.approx(found.least, abs=1e-14)
    assert plain.pair.tolist() == found.pair.tolist()


def test_batches_have_any_shape_and_unreachable_poses_no_value() -> None:
    given = np.tile(HOME, (2, 3, 1))
    given[1, 2, 0] = 5.0
    found = clearance(APPENDIX_4, given)
    assert found.least.shape == found.pair.shape == (2, 3)
    assert found.points.shape == (2, 3, 2, 3)
    assert np.isnan(found.least[1, 2])
    assert found.pair[1, 2] == -1
    assert found.reason((1, 2)) == ""
    assert np.isfinite(found.least[0]).all()
    assert nearest_points(APPENDIX_4, given[1, 2]) is None
    assert clearance(APPENDIX_4, np.zeros((0, 4))).least.shape == (0,)
    with pytest.raises(InvalidInput, match="one pose"):
        nearest_points(APPENDIX_4, given)
    with pytest.raises(InvalidInput, match="PAYLOAD"):
        clearance(APPENDIX_4, HOME, ["payload"])  # type: ignore[list-item]


def test_groups_of_pairs_are_switched() -> None:
    found = clearance(LOADED, HOME, [PairGroup.PAYLOAD])
    assert "the payload" in found.pairs[int(found.pair)]
    assert np.isnan(clearance(APPENDIX_4, HOME, [PairGroup.PAYLOAD]).least)
    assert np.isnan(clearance(APPENDIX_4, HOME, []).least)


def test_nearest_points_are_those_of_the_bodies() -> None:
    found = nearest_points(APPENDIX_4, HOME)
    assert found is not None
    assert np.linalg.norm(found.points[1] - found.points[0]) == pytest.approx(found.distance)
    assert found.names == clearance(APPENDIX_4, HOME).pairs[int(clearance(APPENDIX_4, HOME).pair)]


def test_a_heavy_counterweight_runs_into_its_neighbors() -> None:
    def at(mass: float) -> Clearance:
        design = replace(APPENDIX_4, counterweights=(Counterweight("b3", 7, 0.2, mass),))
        return clearance(design, HOME, [PairGroup.COUNTERWEIGHTS])

    light, heavy = at(0.1), at(10.0)
    assert heavy.least < 0 < light.least
    assert light.reason() == ""
    assert "counterweight 1 of leg" in heavy.reason()
    assert "overlap by" in heavy.reason()


def test_every_pair_is_checked_or_has_a_reason() -> None:
    shapes = shapes_of(LOADED)
    count = len(shapes.bodies)
    assert len(shapes.pairs) + len(shapes.excluded) == count * (count - 1) // 2
    reasons = {
        frozenset((shapes.bodies[i].name, shapes.bodies[j].name)): why
        for i, j, why in shapes.excluded
    }
    assert reasons[frozenset(("B4 of leg 1", "B8 of leg 1"))] is Exclusion.JOINED
    assert reasons[frozenset(("B3 of leg 1", "B8 of leg 1"))] is Exclusion.LAYERS
    assert reasons[frozenset(("the payload", "the platform"))] is Exclusion.RIGID
    assert reasons[frozenset(("M2", "shaft B2 of leg 2"))] is Exclusion.GUIDED
    assert frozenset(("M1", "shaft B2 of leg 2")) not in reasons


def test_pairs_are_those_of_the_bodies_that_are_there() -> None:
    """What is kept of the pairs of one robot is none of a robot with other bodies."""
    none, some = Payload(mass=0.0), Payload(mass=1e-3)
    on_b8, on_b7 = Counterweight("b8", 8, 0.2, 1e-3), Counterweight("b7", 8, 0.2, 1e-3)
    bare = len(shapes_of(APPENDIX_4).bodies)
    for payload, weights, more in (
        (none, (), 0), (some, (), 1), (none, (on_b8,), 3), (none, (on_b7,), 3),
        (some, (on_b7, on_b8), 7), (none, (replace(on_b8, mass=0.0),), 0), (none, (on_b8,), 3),
    ):  # fmt: skip
        shapes = shapes_of(replace(APPENDIX_4, payload=payload, counterweights=weights))
        count = len(shapes.bodies)
        assert count == bare + more
        assert len(shapes.pairs) + len(shapes.excluded) == count * (count - 1) // 2
        carriers = {
            shapes.bodies[i].key
            for i, j, why in shapes.excluded
            if why is Exclusion.RIGID and shapes.bodies[j].key == "counterweight1"
        }
        assert carriers == ({weights[0].bar} if weights and weights[0].mass else set())


def test_blocks_of_poses_are_told_and_can_end_the_work(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.modules[Clearance.__module__], "BLOCK", 2)
    told: list[float] = []

    def progress(done: float, /, **_: Any) -> bool:
        told.append(done)
        return done > 0.5

    with pytest.raises(Canceled):
        clearance(APPENDIX_4, np.tile(HOME, (5, 1)), progress=progress)
    assert told == [0.0, 0.4, 0.8]


def test_the_search_is_compiled_once_that_pays(monkeypatch: pytest.MonkeyPatch) -> None:
    """After thirty poses in all; while a thread compiles it, for thirty poses at once."""
    compiled = object()
    monkeypatch.setattr(kernels, "_compile", lambda: compiled)
    few = kernels._Search()
    assert [few.get(poses) for poses in (29, 0)] == [search.least_distances] * 2
    assert few.get(1) is few.get(1) is few.compiled() is compiled
    busy = threading.Event()
    waiting = kernels._Search()
    waiting.thread = threading.Thread(target=busy.wait)
    waiting.thread.start()
    assert [waiting.get(29) for _ in range(3)] == [search.least_distances] * 3
    assert waiting.get(30) is waiting.get(1) is compiled
    busy.set()
    waiting.thread.join()
    done = kernels._Search()
    done.thread = waiting.thread
    assert [done.get(29), done.get(1)] == [search.least_distances, compiled]


def test_the_search_is_compiled_in_a_thread_that_nothing_waits_for() -> None:
    thread = kernels.compile_in_background()
    assert thread.daemon
    thread.join()


ONE_BODY = (
    {"guide", "quill"}, {"shaft", "shaft_end"}, {"b8", "counterweight1"},
    {"b4", "counterweight2"}, {"carriage", "arm"}, {"arm"}, {"platform", "payload"},
)  # fmt: skip
"""Bodies that are fixed to each other, besides those that stand."""

AT_A_JOINT = (
    {"arm", "shaft"},  # 2
    {"shaft_end", "b3"}, {"b3", "b4"}, {"b4", "swivel"}, {"swivel", "platform"},  # 3, 4, 5
    {"b3", "b7"}, {"slider", "b7"}, {"slider", "b8"}, {"guide", "slider"}, {"b8", "b4"},  # 7, 8, 9
)  # fmt: skip
"""Bodies that a joint holds together."""

INSIDE = ({"shaft", "quill"}, {"shaft", "guide"}, {"column", "carriage"}, {"column", "arm"})
"""Bodies of which one turns or slides inside the other, besides what turns in motor and base."""


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_pairs_are_left_out_by_how_the_robot_is_built(knee: KneeBranch) -> None:
    weights = (*LOADED.counterweights, Counterweight("b4", 9, -0.1, 1.0))
    shapes = shapes_of(with_knee(replace(LOADED, counterweights=weights), knee))
    reasons = {frozenset((i, j)): why for i, j, why in shapes.excluded}
    names = {"counterweight": PairGroup.COUNTERWEIGHTS, "payload": PairGroup.PAYLOAD}
    groups = dict(zip(map(frozenset, shapes.pairs), shapes.groups, strict=True))
    for (i, one), (j, other) in combinations(enumerate(shapes.bodies), 2):
        pair, legs = {one.key, other.key}, {one.leg, other.leg} - {0}
        turns = [f"m{leg}" for leg in legs] + ["base"]
        stand = one.frame == other.frame == WORLD
        expected = None
        if stand or (pair in ONE_BODY and (len(legs) <= 1 or pair == {"arm"})):
            expected = Exclusion.RIGID
        elif pair in AT_A_JOINT and len(legs) == 1:
            expected = Exclusion.JOINED
        elif (pair in INSIDE and len(legs) <= 1) or any(
            pair in ({"quill", place}, {"shaft", place}) for place in turns
        ):
            expected = Exclusion.GUIDED
        elif pair == {"carriage", "m4"} and knee is KneeBranch.UPPER:
            expected = Exclusion.GUIDED  # the ram
        elif one.leg == other.leg > 0 and "arm" not in pair:
            apart = [
                a.extent[0, 1] >= b.extent[1, 1] or b.extent[0, 1] >= a.extent[1, 1]
                for a, b in product(one.solids, other.solids)
                if a.joint not in other.joints and b.joint not in one.joints
            ]
            expected = Exclusion.LAYERS if all(apart) else None
        found = reasons.get(frozenset((i, j)))
        assert found is expected, (one.name, other.name)
        if found is None:
            text = f"{one.name}, {other.name}"
            group = next((names[name] for name in names if name in text), None)
            parts = {one.part, other.part}
            for part in (BodyPart.FRAME, BodyPart.PLATFORM, BodyPart.CARRIAGE):
                group = group or (PairGroup[part.name] if part in parts else None)
            group = group or (PairGroup.SAME_LEG if len(legs) == 1 else PairGroup.BETWEEN_LEGS)
            assert groups[frozenset((i, j))] is group


def test_reasons_say_which_bodies_and_by_how_much() -> None:
    names = ("B4 of leg 1", "the mast")
    assert clearance_reason(-0.0032, names) == "B4 of leg 1 and the mast overlap by 3.2 mm"
    assert clearance_reason(0.004, names) == ""
    text = clearance_reason(0.004, names, 0.005)
    assert text == "B4 of leg 1 and the mast are 4 mm apart; 5 mm is required"
    assert clearance_reason(np.nan, names, 0.005) == ""
    # what touches does not overlap, and what is required is enough
    assert clearance_reason(0.0, names) == clearance_reason(0.005, names, 0.005) == ""


@pytest.mark.slow
def test_most_room_of_the_prototype_is_that_of_b4_above_the_platforms_plate() -> None:
    """13.9 mm: its end is 23.5 mm above the plate and 36 mm beside joint 5, a corner's center."""
    most = np.hypot(0.0235, 0.036 - 0.025) - 0.012
    assert most == pytest.approx(0.0139, abs=5e-5)
    assert np.nanmax(clearance(APPENDIX_4, poses(APPENDIX_4, 3000)).least) <= most
    roomy = clearance(APPENDIX_4, (0.0608, -0.1889, -0.9575, -0.6240))
    assert roomy.least == pytest.approx(most, abs=2e-5)


@pytest.mark.slow
def test_bodies_of_two_legs_of_the_prototype_meet_from_28_degrees_on() -> None:
    """Or from 39 degrees on, where the platform is 0.20 m or more below the guides."""
    pairs = [PairGroup.BETWEEN_LEGS]
    meeting = [(-0.1709, -0.2043, 0.4964, -0.0472), (-0.1875, -0.2079, 0.6877, -0.2015)]
    assert (group_clearance(APPENDIX_4, meeting, pairs) < 0.0).all()
    geometry, draw, n = APPENDIX_4.geometry, np.random.default_rng(2), 3000
    for most, low, high in ((28.0, -0.1, -geometry.platform_joint_height), (39.0, -0.6, -0.2)):
        theta = np.radians(draw.uniform(-most, most, n))
        radius = singular_radius(geometry, theta) * np.sqrt(draw.uniform(0.0, 1.0, n))
        around = draw.uniform(0.0, 2 * np.pi, n)
        place = radius * np.cos(around), radius * np.sin(around)
        drawn = np.column_stack([*place, theta, draw.uniform(low, high, n)])
        least = group_clearance(APPENDIX_4, drawn, pairs)
        assert np.isfinite(least).sum() > n / 4
        assert np.nanmin(least) > 0.0
