"""What proofs are put together from: closed forms of regions, scales, paths, groups, verdicts."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.reach import home_pose
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis.proof import certificate, evidence, families, regions
from paminsa_viz.synthesis.proof.bisection import Nearest
from paminsa_viz.synthesis.proof.certificate import region_of, sampled_evidence
from paminsa_viz.synthesis.proof.evidence import (
    LARGEST,
    Evidence,
    Proof,
    Verdict,
    home_path,
    prove_reach,
    reach_margin,
    reach_scale,
    regions_of,
)
from paminsa_viz.synthesis.proof.families import (
    EVERYWHERE,
    FAMILIES,
    SLACK,
    Family,
    Method,
    Symmetry,
    groups,
    method,
)
from paminsa_viz.synthesis.proof.regions import (
    PoseRegion,
    RegionMargins,
    box,
    freedom,
    least_free,
    region_margins,
)
from paminsa_viz.synthesis.search.region import reach_margins, spans

GEOMETRY = APPENDIX_4.geometry
TURN = 0.4
DISC = PoseRegion(WorkspaceShape.CYLINDER, (0.03, -0.02, -0.6), (0.08, 0.08, 0.1), (-0.2, TURN))
BOXES = replace(DISC, shape=WorkspaceShape.BOX, half=(0.08, 0.05, 0.1))
CLEAR = replace(GEOMETRY, axis_clearance=0.01)
CONDITION, STIFFNESS = Requirement("condition", high=9.0), Requirement("stiffness_x", low=1.0)


@pytest.mark.parametrize("region", [DISC, BOXES, replace(DISC, center=(0.03, -0.02, 0.02))])
@pytest.mark.parametrize("swap", [False, True])
def test_margins_of_a_region_are_attained(region: PoseRegion, swap: bool) -> None:
    """Reach as the search of lengths has it, by spans; singularities over many headings."""
    g = CLEAR
    if swap:
        g = replace(g, base_radius=g.platform_radius, platform_radius=g.base_radius)
    found = region_margins(g, region)
    size = (2 * region.half[0], 2 * region.half[1], 2 * region.half[2])
    space = Workspace(region.shape, size, region.center)
    (expected,) = reach_margins([g], spans([g], [space], region.theta))
    assert found.reach.min(axis=0) == pytest.approx(expected, abs=1e-12)
    assert (found.reach.min(axis=0) <= expected + 1e-16).all()
    theta = np.linspace(*region.theta, 100_001)
    theta[np.argmin(np.abs(theta))] = 0.0
    rb, rp = g.base_radius, g.platform_radius
    circle = np.sqrt(rb**2 + rp**2 - 2 * rb * rp * np.cos(theta)).min()
    corner = np.hypot(*(np.abs(region.center[:2]) + region.half[:2]))
    round_ = np.hypot(*region.center[:2]) + region.half[0]
    farthest = round_ if region.shape is WorkspaceShape.CYLINDER else corner
    assert found.circle == pytest.approx(circle - farthest, abs=1e-9)
    assert found.turn == pytest.approx((np.sign(rb - rp) * (rb * np.cos(theta) - rp)).min())
    if swap:  # R_pl - R_b cos theta, which is least at theta = 0
        assert found.turn == pytest.approx(rp - rb, abs=1e-12)


def test_margins_are_taken_off_what_rounding_of_their_lengths_may_change(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    unit = 1e-7
    assert 500 * 2.0**-53 <= regions.ROUND <= 520 * 2.0**-53
    found = []
    for value in (unit, 0.0):
        monkeypatch.setattr(regions, "ROUND", value)
        found.append(region_margins(CLEAR, BOXES))
    more, none = found
    g, arms = CLEAR, CLEAR.base_radius + CLEAR.platform_radius
    height = 0.7 - g.platform_joint_height
    lengths = g.crank_length + g.coupler_length + g.stroke + height
    lengths += g.span_ratio * (BOXES.farthest + arms)
    assert (none.reach - more.reach) / unit == pytest.approx(np.full((3, 4), lengths), rel=1e-6)
    assert (none.turn - more.turn) / unit == pytest.approx(arms + BOXES.farthest, rel=1e-6)
    # the circle's radius is a root: of what is under it, the square of the arms may be off
    radius = none.circle + BOXES.farthest
    expected = arms + BOXES.farthest + 0.5 * arms**2 / radius
    assert (none.circle - more.circle) / unit == pytest.approx(expected, rel=1e-5)


def test_the_least_free_pose_says_what_it_is_free_of(monkeypatch: pytest.MonkeyPatch) -> None:
    pose = np.array([0.01, 0.02, 0.1, -0.6])
    monkeypatch.setattr(regions, "lowest", lambda value, region: (pose, value(pose[None])[0]))
    for reach, singular, name in (
        (0.1, 0.2, "reach"),
        (0.2, 0.2, "reach"),
        (0.3, 0.2, "singularity"),
    ):
        monkeypatch.setattr(
            regions, "freedom", lambda g, p, a=reach, b=singular: np.array([[a], [b]])
        )  # fmt: skip
        assert least_free(GEOMETRY, DISC)[1:] == (min(reach, singular), name)


@pytest.mark.parametrize("value", [-0.01, 0.0, 0.01])
@pytest.mark.parametrize("name", ["reach", "singularity"])
def test_reach_is_refuted_by_a_pose_and_else_open(
    monkeypatch: pytest.MonkeyPatch, value: float, name: str
) -> None:
    """A guide may be used to its end; a singular pose is none that a robot may take."""
    pose = np.array([0.01, 0.02, 0.1, -0.6])
    needed = Requirements((), DISC.theta)
    fine = prove_reach(APPENDIX_4, needed, DISC)
    margins = region_margins(GEOMETRY, DISC)
    assert {(item.verdict, item.boxes) for item in fine.values()} == {(Verdict.PROVEN, 0)}
    assert fine["reach"].margin == margins.least_reach
    assert fine["singularity"].margin == min(margins.circle, margins.turn)
    far = replace(DISC, half=(0.4, 0.4, 0.7))
    monkeypatch.setattr(evidence, "least_free", lambda *_: (pose, value, name))
    found = prove_reach(APPENDIX_4, needed, far)
    broken = value < 0.0 or (value == 0.0 and name == "singularity")
    assert found[name].verdict is (Verdict.REFUTED if broken else Verdict.UNDECIDED)
    assert found[name].pose == (tuple(pose) if broken else None)
    if broken:
        assert found[name].margin == value


def test_a_margin_of_reach_is_over_its_own_part() -> None:
    high = Requirement("reach_margin", low=0.02, z=(-0.55, 0.0), theta=(0.0, 0.1))
    needed = Requirements((high,), DISC.theta)
    part = replace(DISC, center=(0.03, -0.02, -0.525), half=(0.08, 0.08, 0.025), theta=(0.0, 0.1))
    expected = region_margins(GEOMETRY, part).least_reach - 0.02
    assert reach_margin(APPENDIX_4, needed, high, DISC) == pytest.approx(expected, abs=1e-14)
    whole, own = regions_of(needed, DISC)
    assert (whole, own.theta, own.shape) == (DISC, part.theta, part.shape)
    assert (own.center, own.half) == (pytest.approx(part.center), pytest.approx(part.half))
    loose = replace(high, low=0.0)
    assert reach_margin(APPENDIX_4, needed, loose, DISC) == pytest.approx(expected + 0.02)
    far = replace(DISC, half=(0.4, 0.4, 0.1))
    found = prove_reach(APPENDIX_4, Requirements((loose,), DISC.theta), far)[loose]
    assert found.margin == pytest.approx(freedom(GEOMETRY, np.array([found.pose]))[0, 0])
    assert len(regions_of(Requirements((high, high), DISC.theta), DISC)) == 2
    elsewhere = replace(high, z=(0.0, 1.0))
    assert reach_margin(APPENDIX_4, needed, elsewhere, DISC) == np.inf
    assert regions_of(Requirements((elsewhere,), DISC.theta), DISC) == [DISC]
    found = prove_reach(APPENDIX_4, needed, DISC)[high]
    assert (found.verdict, found.margin) == (Verdict.PROVEN, pytest.approx(expected))
    assert found.boxes == 0
    touching = replace(high, z=(DISC.high[2], 0.0))  # at a single height
    top = replace(part, center=(0.03, -0.02, DISC.high[2]), half=(0.08, 0.08, 0.0))
    assert regions_of(Requirements((touching,), DISC.theta), DISC) == [DISC, top]
    steep = replace(high, low=0.02 + expected + 1e-3)
    found = prove_reach(APPENDIX_4, Requirements((steep,), DISC.theta), DISC)[steep]
    assert found.verdict is Verdict.REFUTED
    assert found.margin == pytest.approx(-1e-3, abs=1e-5)
    assert found.pose is not None


def test_a_margin_of_nothing_is_kept_if_it_is_asked_for_and_else_open(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Reach is proven above zero; a bound on its margin is kept where just met."""
    none = np.empty((0, 4))
    plain = Proof(Verdict.PROVEN, DISC, ())
    assert (plain.path.shape, plain.remaining.shape) == (none.shape, (0, 2, 4))
    assert (plain.boxes, plain.seconds, plain.pose, plain.sampled) == (0, 0.0, None, ())
    items = (
        Evidence("reach", Method.SAMPLED, Verdict.PROVEN, 0.1, (9.0,) * 4),
        Evidence.of(CONDITION, Method.BISECTION, Verdict.REFUTED, -0.1, np.arange(4.0)),
        Evidence.of(STIFFNESS, Method.SAMPLED, Verdict.SAMPLED, 0.1, np.arange(4.0) + 1.0),
    )
    full = replace(plain, evidence=items)
    assert (full.pose, full.sampled) == ((0.0, 1.0, 2.0, 3.0), (STIFFNESS,))
    pose, low = np.array([0.01, 0.02, 0.1, -0.6]), Requirement("reach_margin", low=0.02)
    needed = Requirements((low,), DISC.theta)
    monkeypatch.setattr(evidence, "least_free", lambda *_: (pose, 1e-9, "reach"))
    for reach, circle, name in ((0.0, 0.1, "reach"), (0.1, 0.0, "singularity")):
        made = RegionMargins(np.full((3, 4), reach), circle, 0.1)
        monkeypatch.setattr(evidence, "region_margins", lambda *_, m=made: m)
        found = prove_reach(APPENDIX_4, needed, DISC)
        assert found[name].verdict is Verdict.UNDECIDED
        assert found[low].verdict is (Verdict.PROVEN if reach else Verdict.UNDECIDED)
    monkeypatch.setattr(evidence, "freedom", lambda g, poses: np.full((2, len(poses)), 0.02))
    for margin, verdict in ((0.0, Verdict.PROVEN), (-1e-300, Verdict.UNDECIDED)):
        monkeypatch.setattr(evidence, "reach_margin", lambda *_, m=margin: m)
        item = prove_reach(APPENDIX_4, needed, DISC)[low]
        assert (item.verdict, item.margin) == (verdict, 0.0)
    monkeypatch.setattr(
        evidence, "region_margins", lambda *_: RegionMargins(np.full((3, 4), 0.1), 0.1, 0.1)
    )
    for margin, scale in ((0.0, 50.0 / 0.1), (-1e-300, 0.0)):  # half the longest bar, or nothing
        monkeypatch.setattr(evidence, "reach_margin", lambda *_, m=margin: m)
        found_scale = reach_scale(APPENDIX_4, needed, DISC, (True,) * 3, 40)
        assert found_scale == pytest.approx(scale, rel=1e-9)


@pytest.mark.parametrize("digits", [12, 26])
@pytest.mark.parametrize("grows", [(True, True, True), (True, True, False), (False, False, True)])
def test_the_scale_of_reach_is_known_to_its_digits(digits: int, grows: Any) -> None:
    low = Requirement("reach_margin", low=0.01)
    extent = max(np.extract(grows, DISC.half))
    step = LARGEST / extent / 2**digits
    for needed in (Requirements((), DISC.theta), Requirements((low,), DISC.theta)):

        def holds(scale: float, needed: Requirements = needed) -> bool:
            margins = region_margins(GEOMETRY, DISC.scaled(scale, grows))
            return margins.holds() and (not needed.bounds or margins.least_reach >= 0.01)

        found = reach_scale(APPENDIX_4, needed, DISC, grows, digits)
        assert found / step == pytest.approx(round(found / step), abs=1e-6)
        assert holds(found)
        assert not holds(found + step)


def test_a_path_from_home_goes_straight_one_coordinate_after_the_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Heights first where all is free; each leg of it lies in the box that is proven."""
    seen: list[PoseRegion] = []
    refused: list[int] = []

    def margins(geometry: Any, region: PoseRegion) -> Any:
        seen.append(region)
        return SimpleNamespace(holds=lambda: len(seen) not in refused)

    monkeypatch.setattr(evidence, "region_margins", margins)
    home = np.array(home_pose(GEOMETRY))
    region = replace(DISC, center=(0.03, -0.05, -0.3), theta=(0.1, 0.3))
    goal = np.array([0.03, -0.05, 0.1, -0.3])

    def moves_of(path: Any) -> list[list[int]]:
        assert path[0].tolist() == home.tolist()
        return [np.flatnonzero(step).tolist() for step in np.diff(path, axis=0)]

    def moves(path: Any) -> list[list[int]]:
        assert path[-1] == pytest.approx(goal)
        return moves_of(path)

    path = home_path(GEOMETRY, region)
    assert moves(path) == [[3], [0, 1], [2]]
    for part, first, last in zip(seen, path[:-1], path[1:], strict=True):
        both = np.array([first, last])
        ends = np.array([[*part.low[:2], part.theta[0], part.low[2]],
                         [*part.high[:2], part.theta[1], part.high[2]]])  # fmt: skip
        np.testing.assert_allclose(ends, [both.min(axis=0), both.max(axis=0)], atol=1e-15)
    # in the first order that is free
    seen.clear()
    refused[:] = [2]
    assert moves(home_path(GEOMETRY, region)) == [[3], [2], [0, 1]]
    seen.clear()
    refused[:] = [2, 4, 6]
    assert moves(home_path(GEOMETRY, region))[0] != [3]
    seen.clear()
    refused[:] = range(100)
    assert home_path(GEOMETRY, region).shape == (0, 4)
    # straight up, by a single box
    seen.clear()
    refused[:] = []
    above = replace(region, center=(home[0], home[1], home[3] + 0.1), theta=(-0.1, 0.1))
    assert moves_of(home_path(GEOMETRY, above)) == [[3]]
    (only,) = seen
    assert (only.low[2], only.high[2]) == pytest.approx((home[3], home[3] + 0.1))
    # already there: home itself is what is proven
    seen.clear()
    refused[:] = []
    here = replace(region, center=(home[0], home[1], home[3]), theta=(-0.1, 0.1))
    assert home_path(GEOMETRY, here).tolist() == [home.tolist()]
    assert len(seen) == 1


def test_a_box_between_two_corners() -> None:
    found = box((-1.0, 2.0, 3.0), (3.0, 2.5, 4.0), (0.1, 0.2))
    assert (found.low, found.high) == ((-1.0, 2.0, 3.0), (3.0, 2.5, 4.0))
    assert (found.shape, found.theta) == (WorkspaceShape.BOX, (0.1, 0.2))


def test_how_a_requirement_is_answered_for() -> None:
    """By bisection where its sides have bounds; those of one family and place together."""
    both = ("tau_1", "tau_2", "tau_3", "f_4", "determinant")
    sides = dict.fromkeys(both, (Method.BISECTION,) * 3)
    upper = (Method.SAMPLED, Method.BISECTION, Method.SAMPLED)
    sides |= dict.fromkeys(("condition", "max_torque", "rms_torque"), upper)
    sides["conditioning"] = (Method.BISECTION, Method.SAMPLED, Method.SAMPLED)
    sides["reach_margin"] = (Method.CLOSED_FORM, Method.SAMPLED, Method.SAMPLED)
    sides["stiffness_x"] = (Method.SAMPLED,) * 3
    for name, expected in sides.items():
        bounds = ({"low": 0.1}, {"high": 0.2}, {"low": 0.1, "high": 0.2})
        assert tuple(method(Requirement(name, **one)) for one in bounds) == expected, name
    torque, lift = Requirement("max_torque", high=5.0), Requirement("f_4", low=-300.0, high=20.0)
    others = (
        Requirement("condition", high=10.0), Requirement("determinant", low=-2.0),
        replace(torque, z=(-0.6, -0.5)), replace(lift, theta=(0.0, 0.1)),
        Requirement("stiffness_x", low=1.0),
    )  # fmt: skip
    found = groups(APPENDIX_4, Requirements((torque, *others, lift), (-0.2, TURN)))
    rows = [(FAMILIES.index(g.family), g.requirements, g.theta, g.z) for g in found]
    whole = (-0.2, TURN)
    assert rows == [
        (0, others[:1], whole, EVERYWHERE), (1, others[1:2], whole, EVERYWHERE),
        (2, (torque, lift), whole, EVERYWHERE), (2, others[2:3], whole, (-0.6, -0.5)),
        (2, others[3:4], (0.0, 0.1), EVERYWHERE),
    ]  # fmt: skip
    assert found[2].sizes.tolist() == [5.0, 300.0]
    assert groups(APPENDIX_4, Requirements((lift,), whole))[0].sizes.tolist() == [300.0]
    small = (Requirement("tau_1", low=-0.25), Requirement("f_4", high=-0.5))
    assert groups(APPENDIX_4, Requirements(small, whole))[0].sizes.tolist() == [0.25, 0.5]


@pytest.mark.parametrize("index", range(3))
def test_margins_of_boxes_without_size_are_those_of_their_poses(index: int) -> None:
    family = FAMILIES[index]
    bounds = []
    for name, (low, high) in family.keys.items():
        value = {"f_4": 300.0, "condition": 4.0, "conditioning": 0.3}.get(name, 0.7)
        bounds += [Requirement(name, low=-value)] if low else []
        bounds += [Requirement(name, high=value)] if high else []
        bounds += [Requirement(name, low=-value, high=2 * value)] if low and high else []
    (group,) = groups(APPENDIX_4, Requirements(tuple(bounds), (-0.2, TURN)))
    poses = np.random.default_rng(2).uniform(
        [-0.1, -0.1, -0.2, -0.7], [0.1, 0.1, 0.4, -0.5], (50, 4)
    )
    exact = group.pose_margins(poses)
    found = group.margins(poses, np.zeros_like(poses))
    assert exact.shape == (50, len(bounds))
    np.testing.assert_allclose(found, exact, rtol=1e-9, atol=1e-9)
    wide = group.margins(poses, np.full_like(poses, 1e-3))
    assert (wide <= exact + 1e-12).all()


@pytest.mark.parametrize("family", FAMILIES)
def test_values_depend_on_the_height_where_the_family_says_so(family: Family) -> None:
    low, high = (family.values(APPENDIX_4, np.array([[0.05, 0.02, 0.1, z]])) for z in (-0.7, -0.5))
    changed = max(abs(float(high[key][0] - low[key][0])) for key in family.keys)
    assert changed > 0.1 if family.by_height else changed == pytest.approx(0.0, abs=1e-12)


def test_a_mean_square_that_is_rounded_down_has_its_root_rounded_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    high = np.array([[1.0, 2.0, 3.0, 9.0, 4.0], [-1.0, -0.5, 0.0, 9.0, 2.0]])
    low = np.array([[-5.0, 2.0, 3.0, 9.0, 0.0], [-1.0, -3.0, -2.0, 9.0, 0.0]])
    monkeypatch.setattr(families, "static_bounds", lambda *_: (low, high))
    found = families._static_ranges(APPENDIX_4, low, high)
    roots = np.sqrt([4.0, 2.0])
    assert (found["rms_torque"][1] > roots).all()
    assert found["rms_torque"][1] == pytest.approx(roots, rel=2e-15)
    assert found["max_torque"][1].tolist() == [5.0, 3.0]


def test_boxes_of_a_third_are_those_within_sixty_degrees_of_the_y_axis() -> None:
    third = Symmetry(True, False)
    rng = np.random.default_rng(4)
    middle, half = rng.uniform(-1, 1, (4000, 4)), 0.1 * rng.uniform(size=(4000, 4))
    share = rng.uniform(-1, 1, (60, 4000, 4))
    share[:4, :, :2] = np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]])[:, None]
    x, y = np.moveaxis(middle + half * share, -1, 0)[:2]
    within = (np.abs(np.arctan2(x, y)) <= np.pi / 3).any(axis=0)
    kept = third.kept(middle, half)
    assert kept[within].all()
    assert (kept & ~within).mean() < 0.01  # those that hold the axis between two corners
    assert 0.3 < kept.mean() < 0.4
    # poses on the edge count, with what rounding may do to them
    edge = np.array(
        [[np.sin(np.pi / 3), np.cos(np.pi / 3) - by * SLACK, 0, 0] for by in (0.9, 1.1)]
    )
    assert third.kept(edge, np.zeros_like(edge)).tolist() == [True, False]
    assert Symmetry(False, True).kept(middle, half).all()
    assert [Symmetry(*two).any for two in ((True, False), (False, True), (False, False))] == [
        True, True, False,
    ]  # fmt: skip


def test_a_workspace_is_a_region_about_its_center_or_zero() -> None:
    space = Workspace(WorkspaceShape.BOX, (0.2, 0.4, 0.6), (None, 0.1, None))
    found = region_of(space, Requirements((), (-0.1, 0.2)))
    assert (found.shape, found.center, found.theta) == (space.shape, (0.0, 0.1, 0.0), (-0.1, 0.2))
    assert found.half == pytest.approx((0.1, 0.2, 0.3))


def test_what_a_bisection_says_of_each_requirement() -> None:
    """Proven where nothing is left, refuted at the pose that breaks one, else undecided."""
    bounds = (Requirement("condition", high=2.0), Requirement("conditioning", low=0.01))
    (group,) = groups(APPENDIX_4, Requirements(bounds, (-0.2, TURN)))
    pose, margins = np.array([0.1, 0.0, 0.0, -0.6]), np.array([0.5, 0.25])
    value = group.pose_margins(pose[None])[0]

    def said(*, lower: float = 1.0, remaining: int = 0, **more: Any) -> list[Any]:
        found = Nearest(lower, 1.0, more.get("pose"), more.get("broken", -1), margins, 9,
                        np.zeros((remaining, 2, 4)))  # fmt: skip
        items = certificate._bisected(group, found)
        assert {item.boxes for item in items} == {9}
        return [(item.verdict, item.margin, item.pose is None) for item in items]

    nothing = (Verdict.UNDECIDED, pytest.approx(np.nan, nan_ok=True), True)
    assert said() == [(Verdict.PROVEN, 0.5, True), (Verdict.PROVEN, 0.25, True)]
    assert said(remaining=1) == said(lower=0.9) == [nothing, nothing]
    refuted = (Verdict.REFUTED, pytest.approx(value[0]), False)
    assert said(pose=pose, broken=0) == [refuted, nothing]
    assert said(pose=pose, broken=1)[0] == nothing


@pytest.mark.parametrize(
    ("margins", "worst", "verdict"),
    [
        ([0.5, 0.1, 0.3], 0.1, Verdict.SAMPLED), ([0.5, 0.0], 0.0, Verdict.SAMPLED),
        ([0.5, -0.1, -0.05], -0.1, Verdict.REFUTED), ([], np.inf, Verdict.SAMPLED),
        ([0.2, np.nan, -5.0], np.nan, Verdict.REFUTED),
    ],
)  # fmt: skip
def test_the_worst_sample_is_what_is_known(
    monkeypatch: pytest.MonkeyPatch, margins: list[float], worst: float, verdict: Verdict
) -> None:
    sampled, proven = Requirement("stiffness_x", low=1.0), Requirement("condition", high=10.0)
    poses = np.arange(4.0 * len(margins)).reshape(-1, 4)
    monkeypatch.setattr(
        certificate, "sample_requirement", lambda *_: (poses, np.array(margins, float))
    )
    needed = Requirements((proven, sampled), (-0.2, TURN))
    (found,) = sampled_evidence(APPENDIX_4, needed, DISC)
    assert (found.requirement, found.method, found.verdict) == (sampled, Method.SAMPLED, verdict)
    assert found.margin == pytest.approx(worst, nan_ok=True)
    if margins:
        row = int(np.argmin(np.nan_to_num(margins, nan=-np.inf)))
        assert found.pose == tuple(poses[row])
    else:
        assert found.pose is None
