"""A controller in C at 1 kHz moves the robot in MuJoCo as the same one in Python does."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.codegen import controller_kit
from paminsa_viz.engines.mjcf import mjcf_text
from paminsa_viz.engines.mujoco_model import MujocoRobot
from paminsa_viz.model import APPENDIX_4, inverse_dynamics
from paminsa_viz.model.arrays import Array
from paminsa_viz.trajectory import PRESET
from tests.codegen.printed import STRICT

CYCLE = 1e-3
STEPS = 5
"""Steps of the simulation in a cycle of the controller."""

STIFFNESS, DAMPING = 40.0**2, 2 * 40.0

LOOP = """
#include <stdio.h>
#include "paminsa.h"
#include "design.h"

int main(void)
{
    /* pose, velocity; wanted pose, velocity, acceleration */
    double row[20], acceleration[4], torque[4];

    while (fread(row, sizeof row, 1, stdin) == 1) {
        for (int i = 0; i < 4; i++)
            acceleration[i] = row[16 + i] + 80.0 * (row[12 + i] - row[4 + i]) +
                1600.0 * (row[8 + i] - row[i]);
        const PaminsaReach reach =
            paminsa_inverse_dynamics(&PAMINSA_DESIGN, row, row + 4, acceleration, torque);
        if (reach.status != PAMINSA_STATUS_OK)
            return 1;
        fwrite(torque, sizeof torque, 1, stdout);
        fflush(stdout);
    }
    return 0;
}
"""

Control = Callable[[Array], Array]
"""Torques (4,) for a row (20,) of state and wanted state."""


def in_python(row: Array) -> Array:
    pose, velocity, wanted, rate, acceleration = row.reshape(5, 4)
    acceleration = acceleration + DAMPING * (rate - velocity) + STIFFNESS * (wanted - pose)
    return inverse_dynamics(APPENDIX_4, pose, velocity, acceleration).torque


def follow(control: Control, wanted: Array) -> Array:
    """Return the poses (n, 4) at each cycle of a motion (n, 12), started off it by 1 mm."""
    import mujoco

    start = wanted[0, :4] + np.array([1e-3, 0.0, 0.0, 0.0])
    robot = MujocoRobot(APPENDIX_4, xml=mjcf_text(APPENDIX_4, pose=start.tolist()))
    model, data = robot.model, robot.data
    model.opt.timestep = CYCLE / STEPS
    model.eq_solref[:] = (2 * model.opt.timestep, 1)
    data.qpos[:], data.qvel[:] = robot.state(start, wanted[0, 4:8])
    poses = []
    for row in wanted:
        pose, velocity = robot.pose(data.qpos).copy(), robot.pose(data.qvel).copy()
        poses.append(pose)
        data.ctrl[:] = control(np.concatenate([pose, velocity, row]))
        mujoco.mj_step(model, data, STEPS)
    return np.array(poses)


@pytest.mark.slow
def test_a_loop_in_c_follows_a_motion_as_the_one_in_python(tmp_path: Path) -> None:
    plan = PRESET["circle"].build(APPENDIX_4.geometry)
    states = plan.at(np.arange(400) * CYCLE)
    wanted = np.concatenate([states.pose, states.velocity, states.acceleration], axis=-1)
    for name, text in controller_kit(APPENDIX_4).items():
        (tmp_path / name).write_text(text)
    (tmp_path / "loop.c").write_text(LOOP)
    command = ["gcc", *STRICT, "loop.c", "-o", "loop", "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True)
    with subprocess.Popen(
        [tmp_path / "loop"], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdin
        assert process.stdout

        def in_c(row: Array) -> Array:
            process.stdin.write(row.tobytes())
            process.stdin.flush()
            return np.frombuffer(process.stdout.read(32))

        by_c = follow(in_c, wanted)
        process.stdin.close()
        assert process.wait(10) == 0
    by_python = follow(in_python, wanted)
    np.testing.assert_allclose(by_c, by_python, rtol=0, atol=1e-9)
    error = np.abs(by_c - wanted[:, :4]).max(axis=1)
    assert error[0] == pytest.approx(1e-3)
    assert error[300:].max() < 1e-4
    assert np.abs(wanted[-1, :4] - wanted[0, :4]).max() > 1e-2
