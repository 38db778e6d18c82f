"""The verdict on the formulas: right ones pass, and nothing wrong gets through."""

from __future__ import annotations

import json
import re
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from paminsa_viz.blocks.data import plain
from paminsa_viz.blocks.verification import misprint_name, verification_data
from paminsa_viz.engines import EngineMissing, poses, verification
from paminsa_viz.engines.mjcf import mjcf_text
from paminsa_viz.engines.poses import workspace_poses
from paminsa_viz.engines.verification import (
    EVERY_MISPRINT,
    Comparison,
    EngineCheck,
    Verification,
    torque_scale,
    verify,
)
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Friction,
    InvalidInput,
    KneeBranch,
    Misprint,
    check_reach,
    measure_singularity,
    singular_rotation,
    static_imbalance,
)
from paminsa_viz.model.parameters import Counterweight
from paminsa_viz.model.reach import home_pose
from paminsa_viz.model.singular_limit import CONDITION_LIMIT
from paminsa_viz.model.statics import static_breakdown
from paminsa_viz.trajectory import ImpossibleTrajectory, Trajectory, paper_like
from tests import oracle
from tests.support import samples
from tests.support.cases import BOTH
from tests.support.documentation import missing
from tests.support.samples import with_knee

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("mujoco")]


RANDOM = samples.random_design(np.random.default_rng(31))
SHARP = 1e-11


def motion(design: Design = APPENDIX_4) -> Trajectory:
    return paper_like(design.geometry).lasting(0.2).sample(50)


def checked(design: Design = APPENDIX_4, **more: Any):
    more.setdefault("poses", 20)
    return verify(design, motion(design), **more)


@cache
def found_of_appendix_4() -> Verification:
    """What several tests look at."""
    return checked()


@BOTH
@pytest.mark.parametrize("design", [APPENDIX_4, RANDOM], ids=["appendix4", "random"])
def test_the_formulas_pass(design: Design, knee: KneeBranch) -> None:
    design = with_knee(design, knee)
    found = checked(design)
    assert found.passed
    assert found.worst < SHARP
    names = [check.engine for check in found.engines]
    assert names[0] == "MuJoCo"
    assert {"MuJoCo", "Pinocchio"} == {*names, *found.missing}
    for check in found.engines:
        at_rest = oracle.static_torques(design, found.poses)
        np.testing.assert_allclose(check.static.reference, at_rest, atol=1e-9)
        t = found.trajectory
        torque = oracle.inverse_dynamics(design, t.pose, t.velocity, t.acceleration)
        np.testing.assert_allclose(check.dynamic.reference, torque, atol=1e-9)


@BOTH
def test_counterweights_pass_too(knee: KneeBranch) -> None:
    weights = (Counterweight("b8", 8, 0.1, 0.8), Counterweight("b4", 9, -0.2, 0.3))
    found = checked(with_knee(replace(RANDOM, counterweights=weights), knee), misprints=())
    assert found.worst < SHARP
    without = oracle.static_torques(with_knee(RANDOM, knee), found.poses)
    assert np.abs(found.engines[0].static.reference - without).max() > 1.0


def test_formulas_as_published_disagree() -> None:
    found = found_of_appendix_4()
    assert set(found.published) == set(EVERY_MISPRINT)
    for item, comparison in found.published.items():
        assert not comparison.agrees(1e-6), misprint_name(item)
        assert comparison.reference is found.engines[0].dynamic.reference
    # Eq. 13's lift speed concerns M4 alone.
    lift = found.published[Misprint.EQ13_LIFT_SPEED].relative
    assert lift[:3].max() < SHARP
    assert lift[3] > 1e-5
    assert misprint_name(Misprint.ALL) == "ALL"
    assert misprint_name(Misprint.APP3_MC4) == "APP3_MC4"


def changed(body: str, factor: float) -> str:
    """Appendix 4's exported model with another mass of one body."""
    root = ET.fromstring(mjcf_text(APPENDIX_4))
    inertial = root.find(f".//body[@name='{body}']/inertial")
    assert inertial is not None
    inertial.set("mass", repr(factor * float(inertial.attrib["mass"])))
    return ET.tostring(root, encoding="unicode")


def test_a_wrong_mass_in_an_exported_model_is_caught() -> None:
    right = checked(xml=changed("platform", 1.0), misprints=())
    assert right.passed
    assert [check.engine for check in right.engines] == ["MuJoCo"]
    for body in ("leg1_joint4", "leg2_B4", "platform", "leg3_slider"):
        wrong = checked(xml=changed(body, 1.01), misprints=())
        assert not wrong.passed, body
        assert wrong.worst > 10 * wrong.tolerance, body


def test_a_balanced_robot_is_measured_by_what_its_bodies_weigh() -> None:
    """Its torques at rest are rounding errors, which differ by all of themselves."""
    design = APPENDIX_4.vary({"joints.j7": APPENDIX_4.joints.j7 + 3 * 0.1})
    for _ in range(3):
        more = static_imbalance(design) * design.geometry.magnification / design.gravity
        design = design.vary({"joints.j7": design.joints.j7 + more})
    found = checked(design)
    static = found.engines[0].static
    assert np.abs(static.reference[:, :3]).max() < 1e-12
    assert (static.scale[:3] > 0.1).all()
    assert found.passed


def test_without_weight_and_with_friction() -> None:
    """Nothing at rest to compare by; and friction, which no engine here has, is left out."""
    design = APPENDIX_4.vary({"gravity": 0.0, "friction.coulomb_rotary": 0.3})
    found = checked(design)
    assert found.passed
    assert found.design.friction == Friction()


def test_figures_of_a_comparison() -> None:
    reference = np.array([[1.0, -8.0, 0.0, 100.0], [2.0, 4.0, 0.0, 50.0]])
    computed = reference + np.array([[0.0, 0.4, 0.0, -3.0], [0.1, 0.3, 0.0, 4.0]])
    found = Comparison(computed, reference, np.array([2.0, 8.0, 1.0, 100.0]))
    np.testing.assert_allclose(found.largest, [0.1, 0.4, 0.0, 4.0])
    np.testing.assert_allclose(found.rms, np.sqrt([0.005, 0.125, 0.0, 12.5]))
    np.testing.assert_allclose(found.relative, [0.05, 0.05, 0.0, 0.04])
    np.testing.assert_allclose(found.relative_rms, found.rms / found.scale)
    assert found.agrees(0.0501)
    assert not found.agrees(0.0499)
    assert found.summary()[3] == {
        "actuator": "F_4",
        "unit": "N",
        "largest_torque": 100.0,
        "max_difference": 4.0,
        "rms_difference": pytest.approx(12.5**0.5),
        "max_relative": 0.04,
        "rms_relative": pytest.approx(12.5**0.5 / 100),
    }


def test_torques_are_measured_by_the_largest_or_by_what_a_single_body_weighs() -> None:
    """Of either sign, at any of the poses; without weight and torque, by a millionth."""
    poses = samples.random_poses(np.random.default_rng(4), n=5)
    weighed = np.abs(static_breakdown(APPENDIX_4, poses).per_leg).max(axis=(0, 2, 3))
    torques = np.zeros((5, 4))
    np.testing.assert_allclose(torque_scale(APPENDIX_4, poses, torques), weighed)
    torques[2] = [1e5, -2e5, 0.0, -3e5]
    wanted = [1e5, 2e5, weighed[2], 3e5]
    np.testing.assert_allclose(torque_scale(APPENDIX_4, poses, torques), wanted)
    afloat = APPENDIX_4.vary({"gravity": 0.0})
    assert torque_scale(afloat, poses, 0 * torques).tolist() == [1e-6] * 4


def test_one_engine_that_disagrees_or_one_kind_of_torques_fails() -> None:
    good, bad = (Comparison(np.full((2, 4), x), np.ones((2, 4)), np.ones(4)) for x in (1.0, 2.0))
    other = EngineCheck("other", "1", good, good)
    whole = checked(misprints=(), poses=1)
    for static, dynamic, agrees in (
        (good, good, True), (good, bad, False), (bad, good, False), (bad, bad, False),
    ):  # fmt: skip
        check = EngineCheck("engine", "1", static, dynamic)
        assert check.agrees(0.5) == agrees
        found = replace(whole, engines=(check, other), tolerance=0.5)
        assert found.passed == agrees
        assert found.worst == (0.0 if agrees else 1.0)


def test_a_torque_that_is_missing_fails() -> None:
    whole = np.ones((3, 4))
    holed = whole.copy()
    holed[1, 2] = np.nan
    assert not Comparison(whole, holed, np.ones(4)).agrees(1.0)
    poses = np.tile([0.0, 0.0, 0.0, -0.5], (3, 1))
    assert np.isfinite(torque_scale(APPENDIX_4, poses, holed)).all()
    beyond = np.vstack([workspace_poses(APPENDIX_4.geometry, 3), [0.0, 0.0, 0.0, -3.0]])
    found = checked(poses=beyond)
    assert not found.passed
    assert np.isnan(found.worst)


def test_simulated_drift_is_reported() -> None:
    assert missing("verification", ["once the platform has strayed by 2 % of R_b"]) == []
    assert verification.STRAY_LIMIT == 0.02
    found = found_of_appendix_4()
    played = found.played
    assert played.until == found.wanted.size == 201 > found.trajectory.size  # 0.2 s at 1 kHz
    assert played.stray[-1] < 1e-3
    drift = played.drift[-1]
    reach = np.linalg.norm(drift[[0, 1, 3]]) + 0.1 * abs(drift[2])
    assert played.stray[-1] == pytest.approx(reach)
    stated = verification_data(found)["simulation"]
    assert stated["complete"]
    assert stated["until_s"] == pytest.approx(found.trajectory.duration)
    assert stated["stray_m"] == played.stray[-1]


def test_a_simulation_that_strays_ends_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verification, "STRAY_LIMIT", 1e-6)
    found = checked()
    played = found.played
    assert 1 < played.until < found.wanted.size
    assert played.stray[played.until - 1] > 1e-6 * 0.35 >= played.stray[played.until - 2]
    assert np.isnan(played.poses[played.until :]).all()
    stated = verification_data(found)["simulation"]
    assert not stated["complete"]
    assert stated["until_s"] < found.trajectory.duration
    assert np.isfinite([stated["stray_m"], stated["largest_gap_m"]]).all()


def test_the_result_is_json_and_repeatable() -> None:
    one, two, other = found_of_appendix_4(), checked(), checked(seed=4, misprints=(), poses=5)
    said, again = (plain(verification_data(each)) for each in (one, two))
    assert json.loads(json.dumps(said, allow_nan=False)) == said == again
    assert not np.array_equal(one.poses[:5], other.poses)
    assert (said["static_poses"], said["dynamic_states"]) == (20, one.trajectory.size)
    assert said["worst_relative"] == one.worst
    assert set(said["as_published"]) == {misprint_name(item) for item in EVERY_MISPRINT}


def test_long_trajectories_are_thinned(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verification, "MOST_STATES", 11)
    whole = motion()
    found: Verification = verify(APPENDIX_4, whole, poses=5, misprints=())
    assert found.trajectory.size == 11
    assert found.trajectory.t[[0, -1]].tolist() == whole.t[[0, -1]].tolist()
    assert np.isin(found.trajectory.t, whole.t).all()
    assert found.passed


def test_a_long_motion_is_simulated_with_fewer_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verification, "MOST_SIMULATED", 40)
    found = checked(poses=1, misprints=(), tolerance=0.1)
    assert found.wanted.size == 41


def test_impossible_arguments_are_refused() -> None:
    for tolerance in (0.0, -1e-6, 0.11, 1e300, float("nan"), float("inf")):
        with pytest.raises(InvalidInput, match="tolerance"):
            checked(tolerance=tolerance)
    with pytest.raises(InvalidInput, match="poses"):
        checked(poses=np.empty((0, 4)))
    with pytest.raises(InvalidInput, match="poses"):
        checked(poses=0)
    with pytest.raises(InvalidInput, match="seed"):
        checked(seed=-1)
    near = motion()
    beyond = near.pose - np.array([0.0, 0.0, 0.0, 1.0])
    far = Trajectory(near.t, beyond, near.velocity, near.acceleration)
    with pytest.raises(ImpossibleTrajectory):
        verify(APPENDIX_4, far)


def test_engines_that_are_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pinocchio", None)
    found = checked(misprints=())
    assert found.missing == ("Pinocchio",)
    assert [check.engine for check in found.engines] == ["MuJoCo"]
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(EngineMissing, match="MuJoCo"):
        checked()


@pytest.mark.parametrize("seed", range(4))
def test_workspace_poses_are_usable_everywhere(seed: int) -> None:
    design = APPENDIX_4 if not seed else samples.random_design(np.random.default_rng(seed))
    g = design.geometry
    poses = workspace_poses(g, 300, seed)
    assert poses.shape == (300, 4)
    assert check_reach(g, poses).ok.all()
    height = poses[:, 3] + g.platform_joint_height
    assert 0.3 < (height > 0).mean() < 0.7
    determinant = measure_singularity(g, poses).determinant
    home = measure_singularity(g, np.array(home_pose(g))).determinant
    assert set(np.sign(determinant)) == {np.sign(home)}
    if np.isfinite(turn := singular_rotation(g)):  # what is beyond is behind a singularity
        assert np.abs(poses[:, 2]).max() < turn
    assert np.array_equal(poses, workspace_poses(g, 300, seed))
    assert np.array_equal(poses[:50], workspace_poses(g, 50, seed))


def test_poses_are_drawn_up_to_where_torques_grow_without_bound() -> None:
    """A tenth of R_b from stretched and folded legs, and up to the largest condition number."""
    g = APPENDIX_4.geometry
    found = measure_singularity(g, workspace_poses(g, 4000))
    assert 0.1 <= found.serial_distance.min() / g.base_radius < 0.101
    assert 0.95 * CONDITION_LIMIT < found.condition.max() <= CONDITION_LIMIT
    assert len(workspace_poses(g, 1)) == 1
    with pytest.raises(InvalidInput, match="at least 1 is needed, not 0"):
        workspace_poses(g, 0)


def test_a_workspace_too_small_to_draw_from_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(poses, "_ROUNDS", 1)
    with pytest.raises(InvalidInput, match=r"only \d+ of 5000 found in a workspace this small"):
        workspace_poses(APPENDIX_4.geometry, 5000)


def test_as_many_poses_as_all_rounds_find_are_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("paminsa_viz.engines.poses._DRAWN", 40)
    monkeypatch.setattr("paminsa_viz.engines.poses._ROUNDS", 2)
    with pytest.raises(InvalidInput, match=r"only \d+ of 80 found") as refused:
        workspace_poses(APPENDIX_4.geometry, 80)
    (found,) = re.findall(r"only (\d+) of", str(refused.value))
    assert len(workspace_poses(APPENDIX_4.geometry, int(found))) == int(found) > 3
    with pytest.raises(InvalidInput, match=f"only {found} of"):
        workspace_poses(APPENDIX_4.geometry, int(found) + 1)


def test_states_are_compared_up_to_the_number_the_documentation_names() -> None:
    stated = f"every sample of a trajectory (at most {verification.MOST_STATES:,} of them)"
    assert not missing("verification", [stated])
