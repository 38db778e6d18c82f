"""The exported MJCF carries the design exactly, loads, stands, and moves as calculated."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.engines import exported, mujoco_model
from paminsa_viz.engines.exported import exported_mjcf
from paminsa_viz.engines.mjcf import TIME_STEP, mjcf_text
from paminsa_viz.engines.mujoco_model import MujocoRobot, play
from paminsa_viz.errors import InvalidInput, UnreachablePose
from paminsa_viz.model.design import APPENDIX_4, Design, KneeBranch
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.load import LoadCase, LoadFrame
from paminsa_viz.model.parameters import Friction
from paminsa_viz.model.statics import static_torques
from tests import oracle
from tests.support import samples
from tests.support.cases import BOTH, PROTOTYPES
from tests.support.samples import prototype_times, with_knee

RANDOM = samples.random_design(np.random.default_rng(7))
EACH = samples.each_robot((7,))


def run(mujoco: Any, text: str, seconds: float, control: Any = None) -> tuple[Any, Any, float]:
    """Load a text and step it; return model, data and the largest gap of a loop after the start.

    Any warning fails.
    """
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    gap = 0.0
    for _ in range(round(seconds / model.opt.timestep)):
        if control is not None:
            data.ctrl[:] = control(data.time)
        mujoco.mj_step(model, data)
        gap = max(gap, float(np.abs(data.efc_pos).max()))
    assert not any(warning.number for warning in data.warning)  # they are counted
    return model, data, gap


def test_masses_are_written_with_all_their_digits() -> None:
    design = RANDOM
    root = ET.fromstring(mjcf_text(design))
    mass = {
        body.attrib["name"]: float(body.find("inertial").attrib["mass"])  # type: ignore[union-attr]
        for body in root.iter("body")
        if body.find("inertial") is not None
    }
    for leg in (1, 2, 3):
        assert mass[f"leg{leg}_B4"] == design.links.b4
        assert mass[f"leg{leg}_joint9"] == design.joints.j9
        assert mass[f"leg{leg}_slider"] == design.joints.j8
    assert mass["payload"] == design.payload.mass
    whole = sum(body.mass for body in oracle.bodies(design, oracle.split(np.zeros(4))))
    assert sum(mass.values()) == pytest.approx(whole, rel=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("servos", [True, False], ids=["servos", "motors"])
@EACH
def test_exported_model_loads_and_holds_its_pose(mujoco: Any, design: Design, servos: bool) -> None:
    pose = samples.random_poses(np.random.default_rng(9), design, 1)[0]
    text = exported_mjcf(design, pose=pose.tolist(), servos=servos)
    # Motors hold by a constant force, and the robot is unstable: what is off grows.
    model, data, gap = run(mujoco, text, 1.0 if servos else 0.5)
    start = MujocoRobot(design, xml=text)
    assert gap < 1e-6
    np.testing.assert_allclose(start.pose(data.qpos), pose, rtol=0, atol=1e-4 if servos else 1e-3)
    np.testing.assert_allclose(start.pose(model.qpos0), pose, rtol=0, atol=1e-14)


@pytest.mark.slow
@PROTOTYPES
def test_default_start_steps_two_seconds_with_motors_too(mujoco: Any, design: Design) -> None:
    _, _, gap = run(mujoco, exported_mjcf(design, servos=False), 2.0)
    assert gap < 1e-6


@pytest.mark.slow
@PROTOTYPES
def test_servos_follow_their_controls(mujoco: Any, design: Design) -> None:
    """The viewer's sliders: all at once, smoothly over half a second."""
    robot = MujocoRobot(design)
    wish = np.array([0.15, -0.1, 0.05, 0.04])
    text = exported_mjcf(design)
    model, data, gap = run(mujoco, text, 1.5, lambda t: wish * min(2 * t, 1.0))
    joints = [model.joint(name).qposadr[0] for name in robot.mechanism.actuated]
    reached = (data.qpos - model.qpos0)[joints]
    np.testing.assert_allclose(reached, wish, rtol=0, atol=2e-3)
    reference = oracle.actuators(APPENDIX_4, robot.pose(data.qpos))
    np.testing.assert_allclose(data.qpos[joints], reference, rtol=0, atol=1e-5)
    assert gap < 1e-5


def test_what_is_written_beside_the_robot_is_plain(mujoco: Any) -> None:
    """MuJoCo's own shape of an impedance as stiff as it takes; a sky that is lighter at its top."""
    model = mujoco.MjModel.from_xml_string(mjcf_text(APPENDIX_4))
    given = ET.fromstring(mjcf_text(APPENDIX_4))
    (equality,) = given.iterfind("default/equality")
    impedance = [float(number) for number in equality.attrib["solimp"].split()]
    assert impedance[:2] == [mujoco.mjMAXIMP] * 2
    assert impedance[2:] == [0.001, 0.5, 2.0]  # of MuJoCo's defaults
    assert model.opt.tolerance == 1e-12
    (light,) = given.iterfind("worldbody/light")
    assert np.linalg.norm([float(part) for part in light.attrib["dir"].split()]) == 1.0
    (sky,) = given.iterfind("asset/texture")
    assert {int(sky.attrib[side]) for side in ("width", "height")} == {256}
    colors = np.array([list(map(float, sky.attrib[key].split())) for key in ("rgb1", "rgb2")])
    assert (colors[0] > colors[1]).all()
    assert (np.diff(colors) > 0).all()  # bluish
    assert (colors <= 1.0).all()


def test_geoms_add_no_mass_and_touch_nothing(mujoco: Any) -> None:
    model = mujoco.MjModel.from_xml_string(mjcf_text(APPENDIX_4))
    assert model.ngeom > 20
    assert not model.geom_contype.any()
    assert not model.geom_conaffinity.any()
    whole = sum(body.mass for body in oracle.bodies(APPENDIX_4, oracle.split(np.zeros(4))))
    assert model.body_mass.sum() == pytest.approx(whole, rel=1e-14)


def test_pinocchio_reads_the_exported_model(tmp_path: Path) -> None:
    pinocchio = pytest.importorskip("pinocchio", reason="pinocchio comes with the extra 'verify'")
    if not hasattr(pinocchio, "buildModelFromMJCF"):
        pytest.skip("this Pinocchio is built without its MJCF reader")
    file = tmp_path / "robot.xml"
    file.write_text(mjcf_text(APPENDIX_4), encoding="utf-8")
    model = pinocchio.buildModelFromMJCF(str(file))
    whole = sum(body.mass for body in oracle.bodies(APPENDIX_4, oracle.split(np.zeros(4))))
    assert model.nv == 28
    assert pinocchio.computeTotalMass(model) == pytest.approx(whole, rel=1e-12)


@BOTH
def test_pinocchio_reads_the_loops_too(tmp_path: Path, knee: KneeBranch) -> None:
    """Its constrained dynamics, from nothing but the file, moves as the torques were meant to."""
    pin = pytest.importorskip("pinocchio", reason="pinocchio comes with the extra 'verify'")
    if not hasattr(pin, "buildModelAndLegacyConstraintsFromMJCF"):
        pytest.skip("this Pinocchio does not read closures from MJCF")
    pytest.importorskip("mujoco", reason="it tells the joint positions of a platform state")
    design = RANDOM
    file = tmp_path / "robot.xml"
    file.write_text(mjcf_text(with_knee(design, knee)), encoding="utf-8")
    model, closures = pin.buildModelAndLegacyConstraintsFromMJCF(str(file))
    assert len(closures) == 12
    model.gravity.linear = np.array([0.0, 0.0, -design.gravity])  # its reader leaves 9.81 m/s^2
    platform = [*(f"platform_{n}" for n in ("x", "y", "z", "theta", "roll", "pitch"))]
    names = [*platform, *list(model.names)[2:]]
    robot = MujocoRobot(with_knee(design, knee))
    order = [[robot.model.joint(i).name for i in range(robot.model.njnt)].index(n) for n in names]
    x, u, du = (
        a[0] for a in samples.random_states(np.random.default_rng(11), with_knee(design, knee))
    )
    q, v = (a[order] for a in robot.state(x, u))
    force = np.zeros(model.nv)
    torque = oracle.inverse_dynamics(with_knee(design, knee), x, u, du)
    force[[names.index(n) for n in robot.mechanism.actuated]] = torque
    data, kept = model.createData(), pin.StdVec_RigidConstraintData()
    for closure in closures:
        kept.append(closure.createData())
    pin.initConstraintDynamics(model, data, closures, kept)
    settings = pin.ProximalSettings(1e-14, 1e-10, 200)
    found = pin.constraintDynamics(model, data, q, v, force, closures, kept, settings)
    np.testing.assert_allclose(found[[0, 1, 3, 2]], du, rtol=0, atol=1e-8)


MASSLESS = {
    "joints.j2": 0.0, "joints.j8": 0.0, "links.b7": 0.0, "links.b10": 0.0,
    "inertias.b7_axial": 0.0, "inertias.b7_transverse": 0.0, "inertias.b10_vertical": 0.0,
    "platform.inertia": 0.0,
}  # fmt: skip


@pytest.mark.slow
def test_bodies_without_mass_step_too(mujoco: Any) -> None:
    least = {"links.b1": 0.00034, "joints.j7": 1e-4, "links.b2": 0.0, "joints.j3": 1.1e-3}
    for change in (MASSLESS, MASSLESS | least):
        _, _, gap = run(mujoco, exported_mjcf(APPENDIX_4.vary(change)), 1.0)
        assert gap < 1e-4


@pytest.mark.parametrize(
    ("change", "link"),
    [
        ({"links.b1": 0.0}, "lift"),
        ({"joints.j7": 0.0}, "leg1_B7"),
        ({"links.b2": 0.0, "joints.j3": 0.0}, "leg1_B2"),
    ],
)
def test_links_without_mass_are_refused(change: dict[str, float], link: str) -> None:
    with pytest.raises(InvalidInput, match=f"{link} with its joints has 0 "):
        exported_mjcf(APPENDIX_4.vary(MASSLESS | change))


def test_a_gram_at_a_slide_or_a_gram_square_meter_in_a_thousand_at_a_hinge_is_enough() -> None:
    """1e-3 kg and 1e-6 kg m^2: joint 3 on the shaft, and joint 7 at the end of B7."""
    short = APPENDIX_4.geometry.short_coupler_length
    masses = MASSLESS | {"links.b1": 0.1, "joints.j7": 1.0, "links.b2": 0.0, "joints.j3": 1.0}
    for path, least, unit in (
        ("joints.j3", 1e-3, "0.001 kg"),
        ("joints.j7", 1e-6 / short**2, r"1e-06 kg·m²"),
    ):
        exported_mjcf(APPENDIX_4.vary(masses | {path: least * (1 + 1e-9)}))
        with pytest.raises(InvalidInput, match=f"MuJoCo cannot move less than {unit}$"):
            exported_mjcf(APPENDIX_4.vary(masses | {path: least * (1 - 1e-9)}))
    exported_mjcf(APPENDIX_4.vary(masses | {"joints.j3": 1e-3}))


def test_a_robot_of_a_tenth_of_the_lengths_stands_as_the_prototype_does(mujoco: Any) -> None:
    """Its links are light, but not beside each other: nothing moves by a micrometer."""
    moved = []
    for design in (APPENDIX_4, prototype_times(0.1)):
        model = mujoco.MjModel.from_xml_string(exported_mjcf(design))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        start = data.qpos.copy()
        for _ in range(100):
            mujoco.mj_step(model, data)
        moved.append(np.abs(data.qpos - start).max())
    assert moved[1] < 1e-6 > moved[0]


def test_torques_and_loads_are_linear_between_the_times(mujoco: Any) -> None:
    """More times on the same lines change nothing, where steps are as long."""
    rng = np.random.default_rng(3)
    few, many = np.linspace(0.0, 0.02, 3), np.linspace(0.0, 0.02, 21)
    pose = np.array([0.02, 0.01, 0.1, -0.5])
    torque = oracle.static_torques(APPENDIX_4, pose) + rng.normal(size=(3, 4))
    load = 20.0 * rng.normal(size=(3, 6))

    def played(times: Any) -> Any:
        def between(values: Any) -> Any:
            return np.stack([np.interp(times, few, column) for column in values.T], axis=1)

        poses = np.tile(pose, (len(times), 1))
        found = play(
            APPENDIX_4, times, poses, 0 * poses, between(torque), step=1e-3, loads=between(load)
        )
        return found.poses

    one, other = played(few), played(many)[::10]
    assert np.abs(one[-1] - pose).max() > 1e-3
    np.testing.assert_allclose(one, other, atol=1e-9)


def test_a_simulation_that_overflows_ends_before_it(
    mujoco: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Arms without mass cannot be stepped; what comes back is what was before."""
    monkeypatch.chdir(tmp_path)  # where MuJoCo writes its log
    design = APPENDIX_4.vary({"links.b1": 0.0})
    times = np.linspace(0.0, 0.05, 51)
    motion = quintic([0.0, 0.0, 0.0, -0.5], [0.01, 0.0, 0.0, -0.5], times)
    torque = oracle.inverse_dynamics(design, *motion)
    found = play(design, times, *motion[:2], torque)
    assert 1 <= found.until < times.size
    assert np.isfinite(found.poses[: found.until]).all()
    assert np.isnan(found.poses[found.until :]).all()
    assert np.isnan(found.stray[found.until :]).all()


def test_an_export_that_nothing_holds_is_refused() -> None:
    with pytest.raises(UnreachablePose, match="over-stretched"):
        exported_mjcf(APPENDIX_4, pose=(0.0, 0.0, 0.0, -2.0))
    turn = float(np.arccos(0.1 / 0.35))
    with pytest.raises(InvalidInput, match="singular"):
        exported_mjcf(APPENDIX_4, pose=(0.0, 0.0, turn, -0.6))


def quintic(first: Any, last: Any, times: Any) -> tuple[Any, Any, Any]:
    """Poses, rates and accelerations (n, 4) of a move that starts and ends at rest."""
    whole = times[-1]
    s = (times / whole)[:, None]
    way = np.asarray(last) - np.asarray(first)
    return (
        first + way * s**3 * (10 - 15 * s + 6 * s**2),
        way * 30 * s**2 * (1 - s) ** 2 / whole,
        way * 60 * s * (1 - s) * (1 - 2 * s) / whole**2,
    )


@pytest.mark.slow
@BOTH
def test_simulated_motion_follows_the_calculated_torques(mujoco: Any, knee: KneeBranch) -> None:
    """Feed-forward alone, through an unstable robot: close, and closer with a smaller step."""
    times = np.linspace(0.0, 0.5, 126)
    motion = quintic(
        [-0.05, -0.03, -0.2, -0.5 * knee.sign], [0.05, 0.04, 0.3, -0.6 * knee.sign], times
    )
    torque = oracle.inverse_dynamics(with_knee(APPENDIX_4, knee), *motion)
    coarse = play(with_knee(APPENDIX_4, knee), times, *motion[:2], torque, step=4 * TIME_STEP)
    fine = play(with_knee(APPENDIX_4, knee), times, *motion[:2], torque, step=TIME_STEP / 2)
    assert np.abs(fine.drift).max() < 1e-3
    assert np.abs(fine.drift[:, [0, 1, 3]]).max() < 0.5 * np.abs(coarse.drift[:, [0, 1, 3]]).max()
    assert fine.gap.max() < 1e-6
    np.testing.assert_allclose(fine.poses - motion[0], fine.drift)
    wrong = play(with_knee(APPENDIX_4, knee), times, *motion[:2], 1.01 * torque, step=TIME_STEP)
    assert np.abs(wrong.drift).max() > 10 * np.abs(fine.drift).max()


@pytest.mark.slow
def test_a_robot_that_falls_is_played_until_it_strays(mujoco: Any) -> None:
    """Without torques; and a motion of one instant is where it starts."""
    times = np.linspace(0.0, 0.2, 21)
    poses = np.tile([0.02, 0.01, 0.1, -0.5], (21, 1))
    still = np.zeros((21, 4))
    whole, part = (play(APPENDIX_4, times, poses, still, still, limit=m) for m in (np.inf, 0.02))
    assert whole.until == 21
    radius = APPENDIX_4.geometry.platform_radius
    away = np.linalg.norm(whole.drift[:, [0, 1, 3]], axis=1) + radius * np.abs(whole.drift[:, 2])
    np.testing.assert_allclose(whole.stray, away)
    assert 0 < part.until < 21
    assert part.until == 1 + np.flatnonzero(whole.stray > 0.02)[0]
    kept = slice(part.until)
    np.testing.assert_array_equal(part.poses[kept], whole.poses[kept])
    np.testing.assert_array_equal(part.gap[kept], whole.gap[kept])
    for rest in (part.poses, part.drift, part.stray, part.gap):
        assert np.isnan(rest[part.until :]).all()
    for turn in (0.5, -0.5):  # to either side
        assert mujoco_model._stray(np.array([0.2, 0.0, turn, -0.15]), 0.1) == pytest.approx(0.3)
    alone = play(APPENDIX_4, times[:1], poses[:1], still[:1], still[:1])
    assert alone.until == 1
    assert alone.stray[0] < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("frame", LoadFrame)
def test_a_simulation_stands_under_the_load_and_what_is_put_on_top_of_it(frame: LoadFrame) -> None:
    """Held by the calculated torques; a newton more would move it a hundred times as far."""
    load = LoadCase(40.0, 0.0, -60.0, moment_z=3.0, point_x=0.05, frame=frame)
    design, more = replace(APPENDIX_4, load=load), np.array([0.0, 25.0, 0.0, 0.0, 0.0, -2.0])
    whole = design.vary({"load.force_y": 25.0, "load.moment_z": 1.0})
    times = np.linspace(0.0, 0.02, 3)
    poses = np.tile([0.02, 0.01, 0.3, -0.5], (3, 1))
    for held, on_top in ((design, None), (whole, more), (whole, np.tile(more, (3, 1)))):
        torque = np.tile(static_torques(held, poses[0]), (3, 1))
        found = play(design, times, poses, 0 * poses, torque, loads=on_top)
        assert found.stray.max() < 1e-7
        pushed = np.eye(6)[0] + (0.0 if on_top is None else on_top)
        off = play(design, times, poses, 0 * poses, torque, loads=pushed)
        assert off.stray.max() > 1e-5


@pytest.mark.parametrize(
    ("wait", "step", "count"),
    [(1e-3, 1e-4, 10), (1.5e-4, 1e-4, 2), (0.5e-4, 1e-4, 1), (3e-4, 1.5e-4, 2)],
)
def test_steps_divide_the_times_and_loops_are_as_stiff_as_they_allow(
    mujoco: Any, wait: float, step: float, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And the gap is the largest distance along an axis of two points that belong together.

    Each step has the torque of its middle.
    """
    robots: list[MujocoRobot] = []
    controls: list[Any] = []
    step_of = mujoco.mj_step

    def stepped(model: Any, data: Any) -> None:
        controls.append(data.ctrl.copy())
        step_of(model, data)

    class Noted(MujocoRobot):
        def __init__(self, *args: Any, **options: Any) -> None:
            super().__init__(*args, **options)
            robots.append(self)

    monkeypatch.setattr(mujoco_model, "MujocoRobot", Noted)
    monkeypatch.setattr(mujoco, "mj_step", stepped)
    pose = np.tile([0.02, 0.01, 0.3, -0.5], (2, 1))
    torque = np.array([[0.5, -0.5, 0.2, 200.0], [1.0, 2.0, -3.0, 400.0]])
    found = play(APPENDIX_4, [0.0, wait], pose, 0 * pose, torque, step=step)
    (robot,) = robots
    middles = (np.arange(count) + 0.5) / count
    wanted = [np.interp(middles, (0.0, 1.0), column) for column in torque.T]
    np.testing.assert_allclose(controls, np.transpose(wanted), rtol=1e-13)
    assert robot.model.opt.timestep == pytest.approx(wait / count)
    np.testing.assert_allclose(robot.model.eq_solref, np.tile([2 * step, 1.0], (12, 1)))
    pairs = zip(robot.model.eq_obj1id, robot.model.eq_obj2id, strict=True)
    apart = [robot.data.site_xpos[one] - robot.data.site_xpos[two] for one, two in pairs]
    assert found.gap[1] == pytest.approx(np.abs(apart).max(), rel=1e-6)


def test_what_is_singular_for_an_export_has_a_condition_of_ten_thousand(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for condition, refused in ((9999.0, False), (1e4, True), (np.nan, True)):
        measured = SimpleNamespace(condition=condition)
        monkeypatch.setattr(exported, "measure_singularity", lambda *_, m=measured: m)
        if refused:
            with pytest.raises(InvalidInput, match="singular"):
                exported_mjcf(APPENDIX_4)
        else:
            assert exported_mjcf(APPENDIX_4)


def test_play_names_unusable_input() -> None:
    pose = np.array([[0.0, 0.0, 0.0, -0.5]])
    with pytest.raises(InvalidInput, match="times: increasing numbers are needed"):
        play(APPENDIX_4, [], pose[:0], pose[:0], pose[:0])
    with pytest.raises(InvalidInput, match="torques"):
        play(APPENDIX_4, [0.0], pose, 0 * pose, pose[:, :3])
    with pytest.raises(InvalidInput, match="times: increasing numbers are needed"):
        play(APPENDIX_4, [[0.0]], pose, 0 * pose, 0 * pose)
    two = np.repeat(pose, 2, axis=0)
    with pytest.raises(InvalidInput, match="times"):
        play(APPENDIX_4, [0.0, 0.0], two, 0 * two, 0 * two)


@pytest.mark.parametrize("frame", LoadFrame)
@pytest.mark.parametrize("servos", [True, False])
def test_exported_model_stands_under_its_load(mujoco: Any, frame: LoadFrame, servos: bool) -> None:
    """The load is an actuator on a site of the platform: MJCF has no ``xfrc_applied``."""
    load = LoadCase(40.0, -30.0, -60.0, 2.0, -1.0, 3.0, 0.05, -0.04, 0.03, frame)
    design, pose = replace(APPENDIX_4, load=load), np.array([0.03, -0.02, 0.4, -0.55])
    text = exported_mjcf(design, pose=pose.tolist(), servos=servos)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    if not servos:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    # the actuator's force on the joints is that of xfrc_applied
    robot = MujocoRobot(design)
    moment = data.qfrc_actuator.copy()
    data.ctrl[4] = -1.0
    mujoco.mj_forward(model, data)
    moment -= data.qfrc_actuator
    data.xfrc_applied[model.body("platform").id] = 0
    robot.data.qpos[:] = data.qpos
    mujoco.mj_fwdPosition(robot.model, robot.data)
    robot.push(np.array(load.wrench))
    mujoco.mj_fwdAcceleration(robot.model, robot.data)
    pushed = robot.data.qfrc_smooth + robot.data.qfrc_bias - robot.data.qfrc_passive
    np.testing.assert_allclose(moment, pushed, rtol=1e-10, atol=1e-10)
    data.ctrl[4] = 0.0
    for _ in range(round((1.0 if servos else 0.3) / model.opt.timestep)):
        mujoco.mj_step(model, data)
    moved = robot.pose(data.qpos) - pose
    assert np.abs(moved).max() < (1e-4 if servos else 1e-3)
    assert "load" not in exported_mjcf(APPENDIX_4)


def test_of_drives_the_file_has_the_inertia_alone() -> None:
    """As docs/machine.md says: neither friction nor limits."""
    bare = replace(APPENDIX_4, drives=(Drive(rotor_inertia=1e-5, gear_ratio=50.0),) * 3 + (None,))
    limited = Drive(rotor_inertia=1e-5, gear_ratio=50.0, coulomb=0.01, peak_torque=2.0)
    rough = replace(bare, drives=(limited,) * 3 + (None,), friction=Friction(0.5, 0.7, 30.0, 6.0))
    assert exported_mjcf(rough) == exported_mjcf(bare)
    joints = {
        joint.get("name"): joint for joint in ET.fromstring(exported_mjcf(bare)).iter("joint")
    }
    for leg in (1, 2, 3):
        assert float(joints[f"leg{leg}_theta"].get("armature", "0")) == 50.0**2 * 1e-5
