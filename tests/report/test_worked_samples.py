"""Poses at which worked numbers are checked again: as many as the claims say, and where."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.reach import home_pose
from paminsa_viz.report import worked_claims
from paminsa_viz.report.claims import CLAIMS
from paminsa_viz.trajectory import PRESET
from tests.support.documentation import missing

HALF_TURN = np.radians(30.0)


def even(angle: np.ndarray, slack: float) -> bool:
    """Whether angles are spread over a whole turn."""
    return all(abs(np.exp(1j * k * angle).mean()) < slack for k in range(1, 7))


def test_what_is_allowed_is_a_round_number() -> None:
    """But for the largest errors by tolerances, which have two."""
    odd = [one for one in CLAIMS if float(f"{one.allowed:.0e}") != one.allowed]
    assert [(one.text[:14], one.allowed) for one in odd] == [("Largest errors", 1.2e-2)]


def test_medians_are_over_poses_spread_evenly_over_the_disc(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def sizes(poses: np.ndarray) -> np.ndarray:
        assert poses.shape == (800, 4)
        for part, theta in ((poses[:400], 0.0), (poses[400:], HALF_TURN)):
            x, y, turn, z = part.T
            assert (turn == theta).all()
            assert (z == home_pose(APPENDIX_4.geometry)[3]).all()
            share = (np.hypot(x, y) / (APPENDIX_4.geometry.base_radius / 2)) ** 2
            np.testing.assert_allclose(np.sort(share), (np.arange(400) + 0.5) / 400, atol=1e-12)
            angle = np.arctan2(y, x)
            assert even(angle, 0.02)
            for ring in range(4):  # at every distance
                assert even(angle[100 * ring : 100 * ring + 100], 0.05)
        return np.arange(5.0) + np.linspace(-1.0, 1.0, 800)[:, None]

    monkeypatch.setattr(worked_claims, "_corners", sizes)
    np.testing.assert_allclose(worked_claims._drive_medians(), [2.0, 4.0])


def test_the_rim_of_a_cylinder_is_tried_all_around_and_where_it_fails_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tried: list[np.ndarray] = []

    def met(poses: np.ndarray, lift: float) -> np.ndarray:
        assert lift == 450.0
        tried.append(poses)
        other = np.arange(len(poses)) != 777  # a single pose is enough to break it
        return (np.hypot(poses[:, 0], poses[:, 1]) <= 0.18437) | other

    monkeypatch.setattr(worked_claims, "_met", met)
    assert worked_claims._cylinder() == pytest.approx(2e3 * 0.18437, abs=0.01)
    first = tried[0]
    assert first.shape == (20_000, 4)
    np.testing.assert_allclose(np.hypot(first[:, 0], first[:, 1]), 0.185, rtol=1e-12)
    around, close = first[500:], first[:500]
    assert even(np.arctan2(around[:, 1], around[:, 0]), 0.03)
    ends = np.array([[-HALF_TURN, -0.8], [HALF_TURN, -0.4]])
    np.testing.assert_allclose([around[:, 2:].min(axis=0), around[:, 2:].max(axis=0)], ends,
                               atol=1e-3)  # fmt: skip
    assert (np.abs(around[:, 2]) <= HALF_TURN).all()
    assert (close[:, 3] == -0.6).all()
    assert (around[:, 3] != -0.6).all()
    for off in (np.arctan2(close[:, 1], close[:, 0]) - np.pi / 2, close[:, 2]):
        assert abs(off.mean()) < 0.003
        assert off.std() == pytest.approx(0.02, rel=0.08)


def test_a_volume_is_counted_in_a_box_around_it_at_nine_headings(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    headings: list[float] = []

    def met(poses: np.ndarray, lift: float) -> np.ndarray:
        assert lift == 250.0
        headings.append(float(poses[0, 2]))
        if len(headings) == 1:
            low, high = poses.min(axis=0), poses.max(axis=0)
            np.testing.assert_allclose(low[[0, 1, 3]], [-0.42, -0.42, -1.05], atol=1e-3)
            np.testing.assert_allclose(high[[0, 1, 3]], [0.42, 0.42, 0.0], atol=1e-3)
            assert len(poses) == worked_claims.POINTS == 262_144  # what the claim says
        return np.linalg.norm(poses[:, [0, 1, 3]] - [0.0, 0.0, -0.5], axis=1) <= 0.4

    monkeypatch.setattr(worked_claims, "_met", met)
    assert worked_claims._volume() == pytest.approx(4e3 / 3 * np.pi * 0.4**3, rel=1e-3)
    np.testing.assert_allclose(headings, np.radians(np.linspace(-30.0, 30.0, 9)))


def test_volumes_are_those_of_the_table_with_its_requirements(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def solved(design: Any, requirements: Any, *, resolution: Any) -> Any:
        asked.append((resolution.nodes, resolution.headings, requirements.theta))
        bounds = [(one.quantity, one.low, one.high) for one in requirements.bounds]
        assert bounds == [
            ("condition", None, 10.0), ("max_torque", None, 15.0), ("f_4", None, 250.0),
        ]  # fmt: skip
        return SimpleNamespace(cell=0.0203, volume=0.0921, error=0.00075)

    monkeypatch.setattr(worked_claims, "solve_volume", solved)
    found = worked_claims._volumes()
    np.testing.assert_allclose(found, [20.3, 92.1, 0.75] * len(worked_claims.VOLUMES))
    assert asked == [(nodes, 9, (-HALF_TURN, HALF_TURN)) for nodes in worked_claims.VOLUMES]
    rows = [
        f"| {nodes:,} | {cell:.1f} mm | {volume:.2f} dm³ | {error:.2f} dm³ |"
        for nodes, (cell, volume, error) in worked_claims.VOLUMES.items()
    ]
    said = "κ ≤ 10, max |τ| ≤ 15 N·m, F₄ ≤ 250 N, ±30°, 9 headings:"
    assert missing("requirements", [*rows, said]) == []


def test_factors_of_slower_motions_are_those_of_the_table() -> None:
    rows = [
        f"| {name} | {PRESET[name].build(APPENDIX_4.geometry).duration:.2f} s | "
        + " | ".join(f"{factor:.3f}" for factor in row) + " |"
        for name, row in worked_claims.SLOWER.items()
    ]  # fmt: skip
    assert missing("drives", [*rows, f"so that {worked_claims.PAYLOAD:g} kg change M1..M3"]) == []


def test_the_largest_power_and_torque_are_those_of_either_sign(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(
        worked_claims, "regressor_torques",
        lambda y, c: np.tile([1.0, -7.0, 3.0, -5.0], (len(y), 1)),
    )  # fmt: skip
    velocity = PRESET["paper-like"].build(APPENDIX_4.geometry).sample().velocity[:, 3]
    speed = np.abs(velocity).max() / APPENDIX_4.geometry.magnification
    np.testing.assert_allclose(worked_claims._paper_like(), [-5.0, 5.0 * speed, 7.0] * 2)


def test_errors_by_lengths_add_up_and_their_variances_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tolerances and clearances alike, each evenly within its half width."""
    rng = np.random.default_rng(2)
    slope = rng.normal(size=(6, 3, 14))
    tolerance, clearance = rng.uniform(0.5, 2.0, size=(2, 3, 14))
    monkeypatch.setattr(worked_claims, "_sensitivities", lambda: (slope, tolerance, clearance))
    second = np.degrees(1.0) * 3600
    sizes = np.array([1e6, 1e6, 1e6, second])
    flat = slope.reshape(6, -1)
    drawn = [(width.ravel() ** 2 / 3.0) for width in (tolerance, clearance)]
    variance = [sum(float(s**2 @ part) for part in drawn) for s in flat]
    rms = np.sqrt(variance)
    np.testing.assert_allclose(
        worked_claims._tolerances_rms(),
        [*rms[:4] * sizes, np.hypot(rms[4], rms[5]) * second, rms[4] * second],
    )
    wide = (tolerance + clearance).ravel()
    turns = np.linspace(0.0, np.pi, 20_000)
    tilt = np.abs(np.outer(np.cos(turns), flat[4]) + np.outer(np.sin(turns), flat[5])) @ wide
    part = np.abs(flat[:3]) @ clearance.ravel() * 1e6
    np.testing.assert_allclose(
        worked_claims._tolerances_worst(),
        [*np.abs(flat[:4]) @ wide * sizes, tilt.max() * second, *part], rtol=1e-6,
    )  # fmt: skip


def test_robots_are_drawn_at_home_and_their_errors_are_mean_squares(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    signs = np.array([1.0, -1.0, 1.0, -1.0, np.nan])[:, None]

    def drawn(design: Any, pose: Any, *, robots: int) -> Any:
        assert robots == 2000
        assert pose == home_pose(APPENDIX_4.geometry)
        return SimpleNamespace(errors=1e-6 * signs * [1.0, 2.0, 3.0, 4.0, 3.0, 4.0])

    monkeypatch.setattr(worked_claims, "monte_carlo", drawn)
    second = np.degrees(1e-6) * 3600
    np.testing.assert_allclose(
        worked_claims._drawn_robots(), [1.0, 2.0, 4.0, 3.0 * second, 5.0 * second]
    )


def test_requirements_of_a_volume_are_met_pose_by_pose(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each bound to its own number, from which on it is broken."""
    poses = np.array([[0.0, 0.0, 0.0, -0.55]] * 2)

    def met(**changes: Any) -> bool:
        values: dict[str, Any] = {
            "condition": 10.0, "torque": [15.0, -15.0, 15.0, 250.0], "distance": 1e-9, "ok": True,
        } | changes  # fmt: skip
        found = SimpleNamespace(
            rotation_distance=np.full(2, values["distance"]),
            condition=np.full(2, values["condition"]),
        )
        monkeypatch.setattr(worked_claims, "measure_singularity", lambda g, p: found)
        monkeypatch.setattr(
            worked_claims, "static_torques", lambda g, p: np.array([values["torque"]] * 2)
        )
        monkeypatch.setattr(
            worked_claims, "check_reach", lambda g, p: SimpleNamespace(ok=np.full(2, values["ok"]))
        )
        return bool(worked_claims._met(poses, 250.0).all())

    assert met()
    assert met(torque=[0.0, 0.0, 0.0, -900.0])
    for wrong in (
        {"condition": 10.01}, {"distance": -1e-9}, {"ok": False}, {"torque": [0, 0, 0, 250.01]},
        *({"torque": [sign * 15.01 * (i == j) for i in range(3)] + [0.0]}
          for j in range(3) for sign in (1.0, -1.0)),
    ):  # fmt: skip
        assert not met(**wrong)
