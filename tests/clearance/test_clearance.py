"""Least clearance of the robot: symmetry, pairs, reasons."""

from __future__ import annotations

from dataclasses import replace

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
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import APPENDIX_4, Counterweight, Design, KneeBranch, Payload
from paminsa_viz.model.reach import home_pose
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


def test_reasons_say_which_bodies_and_by_how_much() -> None:
    names = ("B4 of leg 1", "the mast")
    assert clearance_reason(-0.0032, names) == "B4 of leg 1 and the mast overlap by 3.2 mm"
    assert clearance_reason(0.004, names) == ""
    text = clearance_reason(0.004, names, 0.005)
    assert text == "B4 of leg 1 and the mast are 4 mm apart; 5 mm is required"
    assert clearance_reason(np.nan, names, 0.005) == ""
