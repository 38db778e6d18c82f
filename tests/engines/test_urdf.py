"""The URDF in Pinocchio's reader: bodies where the robot's are, and loops that the table closes."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.engines.mechanism import build_mechanism
from paminsa_viz.engines.poses import start_values, world_frames
from paminsa_viz.engines.urdf import _text, closure_table, urdf_text
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.reach import home_pose
from tests.support import samples

EACH = samples.each_robot((7,))


def read(pin: Any, design: Design, pose: Any) -> tuple[Any, Any]:
    """Let Pinocchio read the file and place the links; mimicking joints get no value of ours."""
    model = pin.buildModelFromXML(urdf_text(design), mimic=True)
    values = start_values(design, pose)
    q = pin.neutral(model)
    for name, joint in zip(model.names, model.joints, strict=True):
        if name == "universe" or joint.shortname() == "JointModelMimic":
            continue
        value = values[name]
        turns = joint.nq == 2  # a continuous joint
        q[joint.idx_q : joint.idx_q + joint.nq] = (
            [np.cos(value), np.sin(value)] if turns else [value]
        )
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    return model, data


def test_actuated_joints_have_the_limits_of_their_drives() -> None:
    """Through gear and screw, with their losses; what no drive limits is as without drives."""
    rotary = Drive(
        gear_ratio=50.0, efficiency=0.8, top_speed=300.0,
        envelope=((0.0, 2.0), (200.0, 2.0), (400.0, 0.5)),
    )  # fmt: skip
    weak_gear = replace(rotary, gear_peak_torque=70.0, gear_top_speed=250.0)
    screw = Drive(gear_ratio=2.0, peak_torque=1.5, transmission="screw", lead=0.01)
    design = replace(
        APPENDIX_4, drives=(rotary, weak_gear, replace(rotary, top_speed=None, envelope=()), screw)
    )

    def limits(design: Design) -> dict[str, dict[str, float]]:
        joints = ET.fromstring(urdf_text(design)).iter("joint")
        return {
            joint.attrib["name"]: {key: float(value) for key, value in limit.attrib.items()}
            for joint in joints
            for limit in joint.iter("limit")
        }

    bare, found = limits(APPENDIX_4), limits(design)
    m1, m2, m3, m4 = build_mechanism(design).actuated
    assert found.pop(m1) == pytest.approx({"effort": 80.0, "velocity": 6.0})
    assert found.pop(m2) == pytest.approx({"effort": 70.0, "velocity": 5.0})
    assert m3 not in found  # without peak and top speed
    force = 1.5 * 2.0 * 2 * np.pi / 0.01
    assert found.pop(m4) == pytest.approx(bare.pop(m4) | {"effort": force})
    assert found == bare
    pin = pytest.importorskip("pinocchio", reason="pinocchio comes with the extra 'verify'")
    model, _ = read(pin, design, home_pose(design.geometry))
    joint = model.joints[model.getJointId(m1)]
    assert joint.nq == 2  # a turn has no end
    assert model.effortLimit[joint.idx_v] == pytest.approx(80.0)
    assert model.velocityLimit[joint.idx_v] == pytest.approx(6.0)


@pytest.mark.slow
@EACH
def test_a_foreign_reader_places_all_links_and_closes_the_loops(design: Design) -> None:
    pin = pytest.importorskip("pinocchio", reason="pinocchio comes with the extra 'verify'")
    table = closure_table(design)
    whole = sum(part.mass for link in build_mechanism(design).links for part in link.parts)
    for pose in samples.random_poses(np.random.default_rng(5), design, 4):
        model, data = read(pin, design, pose)
        assert pin.computeTotalMass(model) == pytest.approx(whole)
        wanted = world_frames(build_mechanism(design), start_values(design, pose))

        def frame(name: str, model: Any = model, data: Any = data) -> Any:
            return data.oMf[model.getFrameId(name, pin.FrameType.BODY)]

        for name, (place, turn) in wanted.items():
            np.testing.assert_allclose(frame(name).translation, place, atol=1e-12, err_msg=name)
            np.testing.assert_allclose(frame(name).rotation, turn.as_matrix(), atol=1e-12)
        assert len(table["closures"]) == 12
        for closure in table["closures"]:
            first, second = (
                frame(link).act(np.array(point))
                for link, point in zip(closure["links"], closure["points"], strict=True)
            )
            np.testing.assert_allclose(first, second, atol=1e-12, err_msg=closure["name"])


@EACH
def test_mujoco_reads_it_with_the_masses_of_the_robot(design: Design) -> None:
    """It refuses a moving link without mass, such as those between the platform's joints."""
    mujoco = pytest.importorskip("mujoco", reason="mujoco comes with the extra 'verify'")
    model = mujoco.MjModel.from_xml_string(urdf_text(design))
    whole = sum(part.mass for link in build_mechanism(design).links for part in link.parts)
    assert model.body_mass.sum() == pytest.approx(whole, rel=1e-8)


def test_parallel_bars_are_mimicked() -> None:
    text = urdf_text(APPENDIX_4)
    assert text.startswith("<?xml version")
    assert _text((-0.0, 1)) == "0.0 1.0"  # a zero has no sign
    robot = ET.fromstring(text)
    mimics = {
        joint.attrib["name"]: (mimic.attrib["joint"], float(mimic.attrib["multiplier"]))
        for joint in robot.iter("joint")
        if (mimic := joint.find("mimic")) is not None
    }
    assert mimics == {
        f"leg{leg}_{bar}": (f"leg{leg}_bar4", factor)
        for leg in (1, 2, 3)
        for bar, factor in (("bar7", 1.0), ("bar3", -1.0))
    }
    mimicked = [c["name"] for c in closure_table(APPENDIX_4)["closures"] if c["by_mimic"]]
    assert mimicked == ["leg1_pin7", "leg2_pin7", "leg3_pin7"]
