"""The USD text, read by light means: bodies, joints that fit, loops. Its readers have a session."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from paminsa_viz.engines.exported import exported_usd
from paminsa_viz.engines.mjcf import Servos
from paminsa_viz.engines.poses import start_values
from paminsa_viz.engines.usd import usd_text
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, Drive
from paminsa_viz.model.design import Design
from tests import oracle
from tests.support import samples

EACH = samples.each_robot((7,))


def prims(text: str, depth: str) -> dict[str, tuple[str, str, dict[str, Any]]]:
    """Return kind, metadata and attributes of the prims at an indentation, by name."""
    found = {}
    pattern = (
        rf'^{depth}def (\w+) "(\w+)"( \((?:\n{depth} .*)*\n{depth}\))?\n'
        rf"{depth}{{\n((?:{depth} .*\n)*){depth}}}"
    )
    for kind, name, about, inside in re.findall(pattern, text, re.MULTILINE):
        lines = re.findall(rf"^{depth}    (?:\w+ )*(?:\w+(?:\[\])?) ([\w:]+) = (.*)$", inside, re.M)
        found[name] = kind, about, {key: value_of(value) for key, value in lines}
    return found


def value_of(text: str) -> Any:
    numbers = [float(word) for word in re.findall(r"-?[\d.]+(?:e-?\d+)?", text)]
    if text.startswith("("):
        return np.array(numbers)
    if text.startswith("</"):
        return text.strip("<>").rpartition("/")[2]
    return text.strip('"') if text[0] in '"[' else numbers[0]


def frame(prim: tuple[str, str, dict[str, Any]]) -> tuple[Any, Rotation]:
    own = prim[2]
    turn = Rotation.from_quat(own["xformOp:orient"], scalar_first=True)
    return own["xformOp:translate"], turn


def at(body: tuple[Any, Rotation], joint: dict[str, Any], side: int) -> tuple[Any, Rotation]:
    place = body[0] + body[1].apply(joint[f"physics:localPos{side}"])
    turn = Rotation.from_quat(joint[f"physics:localRot{side}"], scalar_first=True)
    return place, body[1] * turn


@EACH
def test_joints_join_the_bodies_where_they_stand(design: Design) -> None:
    pose = samples.random_poses(np.random.default_rng(9), design, 1)[0]
    text = usd_text(design, pose=pose.tolist())
    bodies, joints = prims(text, "    "), prims(text, "        ")
    assert frame(bodies["platform"])[0] == pytest.approx([pose[0], pose[1], pose[3]])
    assert frame(bodies["platform"])[1].as_euler("zyx")[0] == pytest.approx(pose[2])
    values = start_values(design, pose)
    count: dict[str, int] = {}
    for name, (kind, _, joint) in joints.items():
        if not kind.endswith("Joint"):
            continue
        count[kind] = count.get(kind, 0) + 1
        if kind == "PhysicsFixedJoint":  # the base to the world, where both are
            assert (joint["physics:body1"], "physics:body0" in joint) == ("base", False)
            for side in (0, 1):
                assert joint[f"physics:localPos{side}"].tolist() == [0.0, 0.0, 0.0]
            continue
        (p0, r0), (p1, r1) = (
            at(frame(bodies[joint[f"physics:body{side}"]]), joint, side) for side in (0, 1)
        )
        if kind == "PhysicsSphericalJoint":
            np.testing.assert_allclose(p0, p1, atol=1e-13, err_msg=name)
            continue
        over = [0.0, 1.0, 0.0, 0.0] if joint["physics:axis"] == "Y" else [1.0, 0.0, 0.0, 0.0]
        np.testing.assert_allclose(joint["physics:localRot1"], over, atol=1e-15)
        axis = np.eye(3)["XYZ".index(joint["physics:axis"])]
        np.testing.assert_allclose(r0.apply(axis), r1.apply(axis), atol=1e-13, err_msg=name)
        off = p1 - p0
        if kind == "PhysicsRevoluteJoint":  # between the frames there is the joint's own value
            wrong = (r0.inv() * r1).inv() * Rotation.from_rotvec(values[name] * axis)
            assert wrong.magnitude() == pytest.approx(0, abs=1e-12), name
        if kind == "PhysicsPrismaticJoint":
            assert off @ r0.apply(axis) == pytest.approx(values[name], abs=1e-13)
            assert (r0.inv() * r1).magnitude() == pytest.approx(0, abs=1e-13)
            off = off - off @ r0.apply(axis) * r0.apply(axis)
        np.testing.assert_allclose(off, 0, atol=1e-13, err_msg=name)
    assert count == {
        "PhysicsFixedJoint": 1,
        "PhysicsRevoluteJoint": 15,
        "PhysicsPrismaticJoint": 7,
        "PhysicsSphericalJoint": 12,
    }
    assert text.count("physics:excludeFromArticulation = 1") == 11
    outside = [name for name, own in joints.items() if "physics:excludeFromArticulation" in own[2]]
    assert "leg1_pin5" not in outside  # the platform's place in the tree
    assert len(outside) == 11
    # one text for a turn and for a zero
    turns = [own[key] for every in (bodies, joints) for _, _, own in every.values() for key in own
             if key.startswith(("xformOp:orient", "physics:localRot"))]  # fmt: skip
    assert len(turns) > 24 + 2 * 35  # of bodies, joints and rods
    assert (np.array(turns)[:, 0] >= 0.0).all()
    assert not re.search(r"-0\.0\b(?!e)", text)


@EACH
def test_all_mass_is_in_bodies_with_inertia(design: Design) -> None:
    bodies = prims(usd_text(design), "    ")
    moving = {name: own for name, (kind, _, own) in bodies.items() if "physics:mass" in own}
    base = moving.pop("base")
    assert base["physics:mass"] == 1.0
    assert base["physics:centerOfMass"].tolist() == [0.0, 0.0, 0.0]
    assert base["physics:diagonalInertia"].tolist() == [1.0, 1.0, 1.0]
    assert frame(("", "", base))[0].tolist() == [0.0, 0.0, 0.0]
    assert len(moving) == 23
    whole = sum(body.mass for body in oracle.bodies(design, oracle.split(np.zeros(4))))
    assert sum(own["physics:mass"] for own in moving.values()) == pytest.approx(whole, rel=1e-14)
    assert all((own["physics:diagonalInertia"] > 0).all() for own in moving.values())


def test_servos_stand_where_the_robot_does_and_drives_have_inertia() -> None:
    drive = Drive(rotor_inertia=2e-5, gear_ratio=80.0)
    design = replace(APPENDIX_4, drives=(drive, None, None, None))
    text = exported_usd(design, pose=[0.05, -0.03, 0.2, -0.55])
    joints = prims(text, "        ")
    theta = joints["leg1_theta"][2]
    wanted = np.degrees(oracle.actuators(design, np.array([0.05, -0.03, 0.2, -0.55])))
    assert theta["drive:angular:physics:targetPosition"] == pytest.approx(wanted[0])
    assert theta["drive:angular:physics:stiffness"] > 0
    assert theta["newton:armature"] == theta["physxJoint:armature"] == pytest.approx(0.128)
    assert "newton:armature" not in joints["leg2_theta"][2]
    assert "PhysicsDriveAPI:linear" in joints["lift"][1]
    still = prims(exported_usd(design, servos=False), "        ")
    assert still["lift"][2]["drive:linear:physics:stiffness"] == 0


def test_drives_have_the_gains_of_the_servos_for_a_degree_or_a_meter() -> None:
    servos = Servos((10.0, 20.0, 30.0, 400.0), (1.0, 2.0, 3.0, 40.0))
    pose = [0.05, -0.03, 0.2, -0.55]
    degree = np.pi / 180
    wanted = oracle.actuators(APPENDIX_4, np.array(pose)) / [degree] * np.array([1, 1, 1, degree])
    for chosen in (servos, None):
        joints = prims(usd_text(APPENDIX_4, pose=pose, servos=chosen), "        ")
        for j, name in enumerate(("leg1_theta", "leg2_theta", "leg3_theta", "lift")):
            way, per = ("angular", degree) if j < 3 else ("linear", 1.0)
            own = {
                what: joints[name][2][f"drive:{way}:physics:{what}"]
                for what in ("stiffness", "damping", "targetPosition")
            }
            gains = (0.0, 0.0) if chosen is None else (servos.stiffness[j], servos.damping[j])
            assert own["stiffness"] == pytest.approx(gains[0] * per)
            assert own["damping"] == pytest.approx(gains[1] * per)
            assert own["targetPosition"] == pytest.approx(wanted[j])


def test_a_singular_pose_is_refused() -> None:
    singular = float(np.arccos(0.1 / 0.35))
    with pytest.raises(InvalidInput, match="singular"):
        exported_usd(APPENDIX_4, pose=[0, 0, singular, -0.55])
