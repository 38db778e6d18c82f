"""The USD text in programs by others: OpenUSD's validators and Newton.

They need environments of their own (``nox -s usd_readers``), so the name of this file keeps it out
of the other tests.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import newton
import numpy as np
import pytest
from pxr import Usd, UsdValidation
from scipy.spatial.transform import Rotation

from paminsa_viz.engines.exported import exported_usd
from paminsa_viz.engines.mechanism import build_mechanism
from paminsa_viz.engines.poses import start_values, workspace_poses, world_frames
from paminsa_viz.engines.rigid_bodies import rigid_bodies
from paminsa_viz.model import APPENDIX_4, Drive, KneeBranch
from tests.support.samples import random_design

DRIVE = Drive(rotor_inertia=2e-5, gear_ratio=80.0)

DESIGNS = {
    "appendix-4": APPENDIX_4,
    "upper-knee": APPENDIX_4.with_knee(KneeBranch.UPPER),
    "random": replace(random_design(np.random.default_rng(7)), drives=(DRIVE, None, DRIVE, None)),
}
EACH = pytest.mark.parametrize("name", DESIGNS)
POSES = 100
CLOSE = 2e-6
"""Newton computes in single precision [m]."""


@pytest.fixture
def file(name: str, tmp_path: Path) -> str:
    path = tmp_path / "robot.usda"
    path.write_text(exported_usd(DESIGNS[name]), encoding="utf-8")
    return str(path)


@EACH
def test_no_validator_finds_anything(name: str, file: str) -> None:
    stage = Usd.Stage.Open(file)
    every = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    names = {validator.GetMetadata().name for validator in every}
    assert {f"usdPhysicsValidators:{n}" for n in _PHYSICS} <= names
    errors = UsdValidation.ValidationContext(every).Validate(stage)
    assert not [(error.GetName(), error.GetMessage()) for error in errors]


_PHYSICS = ("RigidBodyChecker", "PhysicsJointChecker", "ArticulationChecker", "ColliderChecker")


def short(label: str) -> str:
    return label.rpartition("/")[2]


@EACH
def test_newton_has_all_bodies_and_loops_with_their_inertias(name: str, file: str) -> None:
    builder = newton.ModelBuilder()
    builder.add_usd(file)
    loops = [
        short(label)
        for label, kind in zip(builder.joint_label, builder.joint_type, strict=True)
        if kind == newton.JointType.BALL
    ]
    assert len(loops) == 12
    assert sum(articulation < 0 for articulation in builder.joint_articulation) == 11
    model = builder.finalize(device="cpu")
    design = DESIGNS[name]
    wanted = rigid_bodies(build_mechanism(design))
    found = dict(zip(map(short, builder.body_label), range(model.body_count), strict=True))
    assert found.keys() == {"base", *wanted}
    mass, inertia, center = (
        a.numpy() for a in (model.body_mass, model.body_inertia, model.body_com)
    )
    for link, body in wanted.items():
        at = found[link]
        assert mass[at] == pytest.approx(body.mass, rel=1e-6)
        np.testing.assert_allclose(center[at], body.center, atol=1e-6)
        np.testing.assert_allclose(inertia[at], np.diag(body.inertia), rtol=2e-6, atol=1e-9)
    moving = mass.sum() - mass[found["base"]]
    assert moving == pytest.approx(sum(body.mass for body in wanted.values()), rel=1e-6)
    assert model.gravity.numpy().ravel()[2] == pytest.approx(-design.gravity)
    armature = dict(zip(map(short, builder.joint_label), builder.joint_qd_start, strict=True))
    driven = model.joint_armature.numpy()[armature["leg1_theta"]]
    drive = design.drives[0]
    assert driven == pytest.approx(drive.reflected_inertia if drive else 0.0)


@EACH
def test_newton_places_all_bodies_at_many_poses(name: str, file: str) -> None:
    builder = newton.ModelBuilder()
    builder.add_usd(file)
    model, design = builder.finalize(device="cpu"), DESIGNS[name]
    state = model.state()
    start = dict(zip(map(short, builder.joint_label), builder.joint_q_start, strict=True))
    mechanism = build_mechanism(design)
    chain = [
        joint.name for link in mechanism.links if link.leg is not None for joint in link.joints
    ]
    for pose in workspace_poses(design.geometry, POSES, seed=3):
        values = start_values(design, pose)
        wanted: dict[str, tuple[Any, Rotation]] = world_frames(mechanism, values)
        q = model.joint_q.numpy()
        for joint in (*chain, "lift"):
            q[start[joint]] = values[joint]
        held = wanted["leg1_B4"][1].inv() * wanted["platform"][1]
        q[start["leg1_pin5"] : start["leg1_pin5"] + 4] = held.as_quat()
        model.joint_q.assign(q)
        newton.eval_fk(model, model.joint_q, model.joint_qd, state)
        placed = state.body_q.numpy()
        for label, at in zip(builder.body_label, placed, strict=True):
            if short(label) == "base":
                continue
            place, turn = wanted[short(label)]
            np.testing.assert_allclose(at[:3], place, atol=CLOSE, err_msg=label)
            off = (turn.inv() * Rotation.from_quat(at[3:])).magnitude()
            assert off < 1e-5, label
