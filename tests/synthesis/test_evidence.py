"""What is known of a region, requirement by requirement: parts, ends, defaults, exact limits."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.reach import home_pose
from paminsa_viz.quantities.requirements import Requirement, Requirements, WorkspaceShape
from paminsa_viz.synthesis.proof import certificate, evidence
from paminsa_viz.synthesis.proof.bisection import Nearest
from paminsa_viz.synthesis.proof.evidence import (
    LARGEST,
    Evidence,
    Proof,
    Verdict,
    home_path,
    in_order,
    part_of,
    prove_reach,
    reach_margin,
    reach_scale,
)
from paminsa_viz.synthesis.proof.families import Method
from paminsa_viz.synthesis.proof.regions import PoseRegion, region_margins
from tests.synthesis.robots import cylinder

GEOMETRY = APPENDIX_4.geometry
DISC = PoseRegion(WorkspaceShape.CYLINDER, (0.03, -0.02, -0.6), (0.08, 0.08, 0.1), (-0.2, 0.4))
POSE = np.array([0.01, 0.02, 0.1, -0.6])
ALL = (True, True, True)


def whole(*bounds: Requirement) -> Requirements:
    return Requirements(bounds, DISC.theta)


def test_a_part_has_the_heights_that_a_requirement_and_the_region_share() -> None:
    plain = Requirement("condition", high=9.0)
    assert part_of(whole(plain), plain, DISC) == DISC
    own = replace(plain, theta=(0.0, 0.1))
    assert part_of(whole(own), own, DISC) == replace(DISC, theta=(0.0, 0.1))
    for z, expected in (
        ((-0.65, -0.55), (-0.65, -0.55)), ((-2.0, -0.6), (-0.7, -0.6)),
        ((-0.6, 2.0), (-0.6, -0.5)), ((-2.0, 2.0), (-0.7, -0.5)), ((-0.5, 2.0), (-0.5, -0.5)),
        ((-2.0, -0.7), (-0.7, -0.7)),
    ):  # fmt: skip
        part = part_of(whole(), replace(plain, z=z), DISC)
        assert part is not None
        assert (part.low[2], part.high[2]) == pytest.approx(expected, abs=1e-12)
        assert (part.center[:2], part.half[:2]) == (DISC.center[:2], DISC.half[:2])
    for z in ((-0.499, 1.0), (-2.0, -0.701)):
        assert part_of(whole(), replace(plain, z=z), DISC) is None


def test_what_is_not_said_is_not_known() -> None:
    bound = Requirement("condition", high=9.0)
    for found in (
        Evidence("condition", Method.SAMPLED, Verdict.UNDECIDED),
        Evidence.of(bound, Method.SAMPLED, Verdict.UNDECIDED),
    ):
        assert np.isnan(found.margin)
        assert (found.pose, found.boxes) == (None, 0)
    proof = Proof(Verdict.PROVEN, DISC, ())
    assert (proof.path.shape, proof.remaining.shape) == ((0, 4), (0, 2, 4))
    assert (proof.boxes, proof.seconds, proof.pose, proof.sampled) == (0, 0.0, None, ())


def test_the_bound_that_a_margin_stands_for_is_zero_where_it_is_zero() -> None:
    for bound, value in (
        (Requirement("determinant", high=0.0), -0.25), (Requirement("determinant", low=0.0), 0.25),
        (Requirement("tau_1", high=3.0), 2.75), (Requirement("tau_1", low=-3.0), -2.75),
    ):  # fmt: skip
        assert Evidence.of(bound, Method.BISECTION, Verdict.PROVEN, 0.25).bound == value


def test_a_proof_has_the_first_pose_that_breaks_something_and_names_what_is_sampled() -> None:
    bounds = [Requirement("condition", high=high) for high in (1.0, 2.0, 3.0)]
    items = (
        Evidence("reach", Method.SAMPLED, Verdict.PROVEN, pose=(9.0,) * 4),
        Evidence.of(bounds[0], Method.BISECTION, Verdict.UNDECIDED, pose=POSE),
        Evidence.of(bounds[1], Method.SAMPLED, Verdict.REFUTED, pose=2 * POSE),
        Evidence.of(bounds[2], Method.SAMPLED, Verdict.REFUTED, pose=3 * POSE),
    )
    proof = Proof(Verdict.REFUTED, DISC, items)
    assert proof.pose == tuple(2 * POSE)
    assert proof.sampled == tuple(bounds[1:])
    found = {item.key: item for item in reversed(items)}
    needed = whole(bounds[2], bounds[0], bounds[0])
    assert in_order(found, needed) == (items[0], items[3], items[1])
    found["home"] = Evidence("home", Method.CLOSED_FORM, Verdict.PROVEN)
    assert [item.name for item in in_order(found, needed)][:2] == ["reach", "home"]


def test_reach_is_that_of_the_worst_part() -> None:
    turned = Requirement("condition", high=9.0, theta=(0.7, 0.9))
    needed = whole(turned)
    parts = [region_margins(GEOMETRY, region) for region in (DISC, replace(DISC, theta=(0.7, 0.9)))]
    found = prove_reach(APPENDIX_4, needed, DISC)
    reach = [part.least_reach for part in parts]
    assert found["reach"].margin == min(reach) < max(reach)
    singular = [min(part.circle, part.turn) for part in parts]
    assert found["singularity"].margin == min(singular)
    assert singular[0] != singular[1]


@pytest.mark.parametrize("margin", [0.0, 1e-12])
def test_reach_without_a_margin_is_open(monkeypatch: pytest.MonkeyPatch, margin: float) -> None:
    item = SimpleNamespace(least_reach=margin, circle=1.0, turn=margin, holds=lambda: True)
    monkeypatch.setattr(evidence, "region_margins", lambda *_: item)
    found = prove_reach(APPENDIX_4, whole(), DISC)
    expected = Verdict.PROVEN if margin else Verdict.UNDECIDED
    assert {one.verdict for one in found.values()} == {expected}


def test_only_a_least_margin_of_reach_has_a_closed_form() -> None:
    low, none = Requirement("reach_margin", low=0.03), Requirement("reach_margin", low=0.0)
    both = Requirement("reach_margin", low=0.03, high=0.5)
    high = Requirement("reach_margin", high=0.5)
    other = Requirement("condition", high=9.0)
    found = prove_reach(APPENDIX_4, whole(low, none, both, high, other), DISC)
    assert set(found) == {"reach", "singularity", low, none}
    least = region_margins(GEOMETRY, DISC).least_reach
    assert found[none].margin == least
    assert found[low].margin == pytest.approx(least - 0.03)
    assert reach_margin(APPENDIX_4, whole(), none, DISC) == least
    # nor do others limit the scale
    free = reach_scale(APPENDIX_4, whole(), DISC, ALL, 20)
    for bound in (both, high, other):
        assert reach_scale(APPENDIX_4, whole(bound), DISC, ALL, 20) == free
    assert reach_scale(APPENDIX_4, whole(low), DISC, ALL, 20) < free
    turned = replace(other, theta=(0.7, 0.9))
    assert reach_scale(APPENDIX_4, whole(turned), DISC, ALL, 20) < 0.98 * free


def test_margins_that_are_just_kept_are_proven(monkeypatch: pytest.MonkeyPatch) -> None:
    low = Requirement("reach_margin", low=0.25)
    item = SimpleNamespace(least_reach=0.25, circle=1.0, turn=1.0, holds=lambda: True)
    monkeypatch.setattr(evidence, "region_margins", lambda *_: item)
    found = prove_reach(APPENDIX_4, whole(low), DISC)[low]
    assert (found.verdict, found.margin, found.pose) == (Verdict.PROVEN, 0.0, None)
    step = LARGEST / 0.1 / 2**20
    scale = reach_scale(APPENDIX_4, whole(low), DISC, ALL, 20)
    assert scale == pytest.approx(LARGEST / 0.1 - step)
    item.least_reach = 0.25 - 1e-12
    assert reach_scale(APPENDIX_4, whole(low), DISC, ALL, 20) == 0.0
    # what is broken by rounding alone is open, what a pose breaks is refuted
    for value, verdict in (
        (0.25, Verdict.UNDECIDED), (0.25 + 1e-9, Verdict.UNDECIDED), (0.24, Verdict.REFUTED),
    ):  # fmt: skip
        monkeypatch.setattr(evidence, "lowest", lambda *_, v=value: (POSE, v))
        found = prove_reach(APPENDIX_4, whole(low), DISC)[low]
        assert (found.verdict, found.pose) == (verdict, tuple(POSE))
        assert found.margin == pytest.approx(value - 0.25, abs=1e-15)
    none = replace(low, low=0.0)
    item.least_reach = -1.0
    monkeypatch.setattr(evidence, "lowest", lambda *_: (POSE, -0.5))
    assert prove_reach(APPENDIX_4, whole(none), DISC)[none].margin == -0.5


def test_a_path_of_one_move_is_proven_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Any] = []

    def margins(geometry: Any, region: PoseRegion) -> Any:
        seen.append((region.low[2], region.high[2]))
        return SimpleNamespace(holds=lambda: False)

    monkeypatch.setattr(evidence, "region_margins", margins)
    x, y, _, z = home_pose(GEOMETRY)
    below = replace(DISC, center=(x, y, z - 0.2), theta=(-0.1, 0.1))
    assert home_path(GEOMETRY, below).shape == (0, 4)
    assert seen[0] == pytest.approx((z - 0.2, z))
    # the heading nearest to that of home, which a range may be whole turns away from
    full = 2 * np.pi
    monkeypatch.setattr(
        evidence, "region_margins", lambda *_: SimpleNamespace(holds=lambda: True)
    )  # fmt: skip
    for theta, turn in (
        ((-0.3, -0.1), -0.1), ((0.1, 0.3), 0.1), ((-0.1, 0.3), 0.0),
        ((full - 0.3, full - 0.1), -0.1), ((-full - 0.1, -full + 0.3), 0.0),
    ):  # fmt: skip
        path = home_path(GEOMETRY, replace(below, theta=theta))
        assert path[-1].tolist() == pytest.approx([x, y, turn, z - 0.2])


@pytest.mark.parametrize(
    ("reach", "paths", "sampled", "searched", "verdict"),
    [
        ((Verdict.PROVEN, Verdict.PROVEN), (2, 3), Verdict.SAMPLED, True, Verdict.PROVEN),
        ((Verdict.PROVEN, Verdict.UNDECIDED), (2, 3), None, False, Verdict.UNDECIDED),
        ((Verdict.REFUTED, Verdict.PROVEN), (2, 3), None, False, Verdict.REFUTED),
        ((Verdict.PROVEN, Verdict.PROVEN), (2, 0), Verdict.SAMPLED, True, Verdict.UNDECIDED),
        ((Verdict.PROVEN, Verdict.PROVEN), (2, 3), Verdict.REFUTED, False, Verdict.REFUTED),
    ],
)
def test_a_proof_goes_on_as_long_as_it_may_still_hold(
    monkeypatch: pytest.MonkeyPatch, reach: Any, paths: Any, sampled: Any, searched: bool,
    verdict: Verdict,
) -> None:  # fmt: skip
    """Without reach nothing has a value, and what is refuted needs no search."""
    bisected, turned = Requirement("f_4", high=450.0), Requirement("stiffness_x", low=1.0)
    needed = Requirements((bisected, replace(turned, theta=(0.0, 0.1))), (-0.2, 0.4))
    asked: list[Any] = []

    def search(group: Any, gauge: Any, upper: float, tolerance: Any, control: Any) -> Nearest:
        asked.append((group.requirements, tolerance, control.left))
        return Nearest(upper, upper, None, -1, np.array([0.5]), 4)

    items = {
        name: Evidence(name, Method.CLOSED_FORM, one)
        for name, one in zip(("reach", "singularity"), reach, strict=True)
    }
    lengths = iter(paths)
    monkeypatch.setattr(certificate, "nearest_violation", search)
    monkeypatch.setattr(certificate, "prove_reach", lambda *_: dict(items))
    monkeypatch.setattr(certificate, "home_path", lambda *_: np.zeros((next(lengths), 4)))
    monkeypatch.setattr(
        certificate, "sampled_evidence",
        lambda *_: [Evidence.of(needed.bounds[1], Method.SAMPLED, sampled)],
    )  # fmt: skip
    proof = certificate.prove(APPENDIX_4, needed, cylinder(0.1, 0.1))
    assert proof.verdict is verdict
    assert len(proof.path) == 2
    assert proof.remaining.shape == (0, 2, 4)
    found = {item.name: item for item in proof.evidence}
    home = Verdict.PROVEN if all(paths) else Verdict.UNDECIDED
    assert found["home"].verdict is home
    assert ("stiffness_x" in found) is (sampled is not None)
    assert found["f_4"].verdict is (Verdict.PROVEN if searched else Verdict.UNDECIDED)
    assert len(asked) == searched
    if searched:
        assert asked[0][:2] == ((bisected,), None)
        assert 13.0 < asked[0][2] <= 15.0
