"""Every quantity of the registry from functions of single poses."""

from __future__ import annotations

from typing import Any

import numpy as np

from paminsa_viz.actuation.wrench_capability import TRANSMISSION, capability
from paminsa_viz.clearance import PairGroup, clearance
from paminsa_viz.elastostatics.bar_loads import bar_loads, utilization
from paminsa_viz.elastostatics.drive_stiffness import drive_modes
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, joint_forces
from paminsa_viz.elastostatics.stiffness import platform_stiffness
from paminsa_viz.elastostatics.vibration import first_frequencies
from paminsa_viz.model import (
    Design,
    Limit,
    backend,
    check_reach,
    jacobian,
    measure_singularity,
    static_torques,
)
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.leg import mechanism
from paminsa_viz.precision.drive_errors import drive_errors
from paminsa_viz.precision.manufacture import manufactured_pose, tolerance_errors

CAPABILITIES = (
    "payload", "horizontal_force", "vertical_force", "moment", "speed", "turn_speed",
    "acceleration", "turn_acceleration",
)  # fmt: skip

AXES = {"x": 0, "y": 1, "z": 2, "theta": 5}
"""Axes of a wrench."""


CLEARANCES = ("legs", "same_leg", "arms", "platform", "frame", "payload", "counterweights")
"""Keys of the clearances of the groups of pairs, in their order."""


def pointwise(design: Design, pose: Any) -> dict[str, Any]:
    """Return every quantity at poses (..., 4), each (...)."""
    pose = np.asarray(pose, float)
    torque = static_torques(design, pose)
    reach = check_reach(design.geometry, pose)
    good = (reach.status == Limit.OK) & np.isfinite(torque).all(axis=-1)
    measured = measure_singularity(design.geometry, pose)
    with np.errstate(all="ignore"):
        selective = 1 / np.linalg.norm(jacobian(design.geometry, pose), axis=-1)
    index = backend.over_list(TRANSMISSION, mechanism(design.geometry), pose.reshape(-1, 4))
    index = index.reshape(*pose.shape[:-1], 3)
    able = capability(design, pose)
    stiff = platform_stiffness(design, pose)
    deflection = stiff.deflection()
    further = {
        **{f"stiffness_{name}": stiff.along(i) for name, i in AXES.items()},
        "frequency_1": first_frequencies(design, pose),
        "frequency_drives": drive_modes(design, pose).frequencies[..., 0],
        "clearance": clearance(design, pose).least,
        **{
            f"clearance_{key}": clearance(design, pose, [group]).least
            for key, group in zip(CLEARANCES, PairGroup, strict=True)
        },
        "stiffness_tilt": stiff.tilt,
        "stiffness_horizontal": stiff.horizontal,
        "deflection": np.linalg.norm(deflection[..., :3], axis=-1),
        "deflection_tilt": np.hypot(deflection[..., 3], deflection[..., 4]),
        **{name: getattr(able, name) for name in CAPABILITIES},
        "transmission": index.min(axis=-1),
        **{f"transmission_{leg + 1}": index[..., leg] for leg in range(3)},
        **{f"pressure_{leg + 1}": np.arccos(np.minimum(index[..., leg], 1)) for leg in range(3)},
        "selective_x": selective[..., 0],
        "selective_y": selective[..., 1],
        "selective_theta": selective[..., 2],
        "selective_z": selective[..., 3],
        "conditioning": 1 / measured.condition,
        **_errors(design, pose),
        **by_manufacture(design, pose),
        **_joint_forces(design, pose),
    }  # fmt: skip
    return {
        "tau_1": torque[..., 0],
        "tau_2": torque[..., 1],
        "tau_3": torque[..., 2],
        "f_4": torque[..., 3],
        "max_torque": np.abs(torque[..., :3]).max(axis=-1),
        "rms_torque": np.sqrt((torque[..., :3] ** 2).mean(axis=-1)),
        "condition": measured.condition,
        "determinant": measured.determinant,
        "reach_margin": reach.margins.min(axis=(-1, -2)),
    } | {name: np.where(good, values, np.nan) for name, values in further.items()}


def _errors(design: Design, pose: Any) -> dict[str, Any]:
    """Return the errors from the drives by their keys."""
    found = drive_errors(design.geometry, design.accuracy, pose)
    by_kind = {
        "error": (found.worst, found.horizontal),
        "linear_error": (found.linear, found.linear_horizontal),
        "rms_error": (found.rms, found.rms_horizontal),
    }
    names = ("x", "y", "theta", "z")
    return {
        f"{kind}_{name}": values
        for kind, (pose_errors, horizontal) in by_kind.items()
        for name, values in (
            ("horizontal", horizontal),
            *((name, pose_errors[..., index]) for index, name in enumerate(names)),
        )
    }


def by_manufacture(design: Design, pose: Any) -> dict[str, Any]:
    """Return the errors by tolerances and deviations by their keys."""
    found = tolerance_errors(design, pose)
    moved = manufactured_pose(design, pose)
    change = np.concatenate([moved.pose - pose, moved.tilt], axis=-1)
    horizontal = np.hypot(change[..., 0], change[..., 1])
    tilt = np.hypot(change[..., 4], change[..., 5])
    kinds = {
        "tolerance": (found.worst, found.horizontal, found.tilt),
        "rms_tolerance": (found.rms, found.rms_horizontal, found.rms_tilt),
        "deviation": (change, horizontal, tilt),
    }
    return {
        f"{kind}_{name}": values
        for kind, (pose_errors, plane, lean) in kinds.items()
        for name, values in (
            ("horizontal", plane),
            ("tilt", lean),
            *((name, pose_errors[..., i]) for i, name in enumerate(("x", "y", "theta", "z"))),
        )
    }


def _joint_forces(design: Design, pose: Any) -> dict[str, Any]:
    """Return forces at joints and in bars at rest by their keys."""
    forces = joint_forces(design, pose)
    size = forces.magnitude.max(axis=-2)
    inner = np.abs([bar_loads(forces, bar).extremes() for bar in BARS]).max(axis=(0, -2))
    moment = np.abs(forces.moment).max(axis=-2)
    return {
        "joint_force": size.max(axis=-1),
        **{
            {"m": "force_m", "guide": "guide_force"}.get(joint, f"force_{joint}"): size[..., index]
            for joint, index in JOINT_INDEX.items()
        },
        "bearing_moment": moment[..., JOINT_INDEX["m"]],
        "arm_moment": moment[..., JOINT_INDEX["2"]],
        "bar_axial": inner[..., 0],
        "bar_moment": inner[..., 2],
        "utilization": utilization(forces).max(axis=(-1, -2)),
    }
