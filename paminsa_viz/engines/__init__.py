"""The same robot in physics engines written by others, to check the model against.

The robot is described once as a tree of links with loop closures (`mechanism`), and each engine
builds its own model from that: MuJoCo from an MJCF text (`mjcf`, `mujoco_model`), Pinocchio joint
by joint (`pinocchio_model`). Mass matrices, bias forces and constraint Jacobians are the engines'
own; `closed_loop` only eliminates the dependent joints, and `play` simulates in MuJoCo. From the
model come the design and the joint values at a pose (`poses`), which the closures verify;
nothing of its statics and dynamics is used.

MuJoCo is part of the installation; Pinocchio comes with ``pip install "paminsa-viz[verify]"``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from paminsa_viz.late import late_names

if TYPE_CHECKING:
    from paminsa_viz.engines.dxf import dxf_text
    from paminsa_viz.engines.exported import exported_mjcf, exported_usd
    from paminsa_viz.engines.missing import INSTALL, EngineMissing, why_missing
    from paminsa_viz.engines.mujoco_model import MujocoRobot, Played, play
    from paminsa_viz.engines.pinocchio_model import PinocchioRobot
    from paminsa_viz.engines.poses import joint_values, workspace_poses
    from paminsa_viz.engines.simulated_log import NO_NOISE, LogNoise, RecordedMotion, simulate_log
    from paminsa_viz.engines.urdf import closure_table, urdf_text
    from paminsa_viz.engines.verification import EngineCheck, Verification, verify

__all__ = [
    "INSTALL",
    "NO_NOISE",
    "EngineCheck",
    "EngineMissing",
    "LogNoise",
    "MujocoRobot",
    "PinocchioRobot",
    "Played",
    "RecordedMotion",
    "Verification",
    "closure_table",
    "dxf_text",
    "exported_mjcf",
    "exported_usd",
    "joint_values",
    "play",
    "simulate_log",
    "urdf_text",
    "verify",
    "why_missing",
    "workspace_poses",
]

__getattr__ = late_names(__name__)
