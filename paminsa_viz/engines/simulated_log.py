"""A log of the robot as MuJoCo has it: what its encoders and current sensors would have recorded.

Torques along a motion are the engine's inverse dynamics, so a log tests formulas and identification
with a robot that is not theirs. Friction is the design's law at the actuators; what engines and
model share is the kinematics, which the engine's loop closures verify.

A log can have the faults of a real robot (`Defects`) and of its sensors (`LogNoise`).
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from paminsa_viz.engines.mechanism import leg_name
from paminsa_viz.engines.mjcf import mjcf_text
from paminsa_viz.engines.mujoco_model import MujocoRobot
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.dynamics import friction_torque
from paminsa_viz.model.jacobians import actuator_velocity
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.trajectory.sampled import Trajectory, sample_times

BLOCK = 2048
"""States worked on at a time; each takes some 30 kB in the engine's matrices."""


@dataclass(frozen=True)
class LogNoise:
    """What the sensors add.

    Attributes:
        torque: Standard deviation of the torque noise, over the RMS torque of each actuator.
        correlation: Time in which the noise forgets itself by 1/e [s]; 0 for white noise.
        angle: Step of the encoders of M1..M3 [rad]; 0 for none.
        travel: Step of the encoder of M4 [m]; 0 for none.
    """

    torque: float = 0.02
    correlation: float = 0.02
    angle: float = np.pi / 18000
    travel: float = 1e-5


NO_NOISE = LogNoise(0.0, 0.0, 0.0, 0.0)
"""The noise of a log that is exact."""


class HeavierBar(NamedTuple):
    """A bar of one leg that is not as the design has it.

    Attributes:
        leg: 0, 1, 2.
        bar: Its name, such as ``"B4"``.
        factor: What its mass and its inertias are multiplied by.
    """

    leg: int
    bar: str
    factor: float


@dataclass(frozen=True)
class Defects:
    """Where the robot of the log differs from its design.

    Attributes:
        bars: Bars of single legs.
        encoder_zero: What the encoders show too much, (4,) [rad, m].
        delay: How much later than the positions the torques are recorded [s].
        gain: What the torques are multiplied by before they are recorded, (4,).
        offset: What is added to the torques, (4,) [N m, N].
        spring: Constant force on joint 9 of every leg, upward [N]: a weight compensation without
            inertia.
    """

    bars: tuple[HeavierBar, ...] = ()
    encoder_zero: tuple[float, ...] = (0.0,) * 4
    delay: float = 0.0
    gain: tuple[float, ...] = (1.0,) * 4
    offset: tuple[float, ...] = (0.0,) * 4
    spring: float = 0.0


NO_DEFECTS = Defects()


class RecordedMotion(NamedTuple):
    """What a log holds: times (n,) [s], actuator positions (n, 4) [rad, m], torques (n, 4)."""

    t: Array
    position: Array
    torque: Array


@of_design
def simulate_log(
    design: Design,
    motion: Trajectory,
    *,
    rate: float = 1000.0,
    noise: LogNoise = NO_NOISE,
    defects: Defects = NO_DEFECTS,
    seed: int = 0,
) -> RecordedMotion:
    """Return the log of a motion that the robot follows exactly.

    Args:
        design: The robot; its payload, load, friction and drives are those of the log.
        motion: The platform's motion. Before and after it the robot stands at its ends.
        rate: Samples a second [1/s].
        noise: Of the sensors; none by default.
        defects: Of the robot; none by default.
        seed: Of the noise. The same arguments give the same log.

    Raises:
        EngineMissing: If MuJoCo is not installed.
        InvalidInput: If the motion leaves the workspace, or a defect names a bar that there is not.
    """
    t = sample_times(float(motion.t[0]), float(motion.t[-1]), rate)
    position = inverse_kinematics(design.geometry, motion.at(t).pose).actuators
    state = motion.at(t - defects.delay)
    robot = _DefectiveRobot(design, defects)
    torque = np.concatenate(
        [
            robot.inverse_dynamics(*(values[start : start + BLOCK] for values in state))
            for start in range(0, t.size, BLOCK)
        ]
    )
    torque += friction_torque(
        design.actuator_friction, actuator_velocity(design, state.pose, state.velocity)
    )
    lost = np.flatnonzero(~np.isfinite(torque).all(axis=1))
    if lost.size:
        problem = f"there is no torque at {t[lost[0]]:.6g} s: out of reach, or singular"
        raise InvalidInput("motion", problem)
    torque = torque * np.array(defects.gain) + np.array(defects.offset)
    scale = noise.torque * np.sqrt((torque**2).mean(axis=0))
    step = float(t[1] - t[0])
    torque += scale * correlated_noise(t.size, step, noise.correlation, seed)
    position = position + np.array(defects.encoder_zero)
    for column, count in enumerate((noise.angle,) * 3 + (noise.travel,)):
        if count > 0.0:
            position[:, column] = count * np.round(position[:, column] / count)
    return RecordedMotion(t, position, torque)


def correlated_noise(count: int, step: float, correlation: float, seed: int) -> Array:
    """Return noise of four signals with standard deviation 1, (count, 4).

    Its autocorrelation is exp(-|lag| / correlation): a first-order process from its first sample
    on. ``step`` is the time between samples [s].
    """
    from scipy.signal import lfilter  # takes a while to load

    white = np.random.default_rng(seed).standard_normal((count, 4))
    if correlation <= 0.0:
        return white
    keep = np.exp(-step / correlation)
    white[1:] *= np.sqrt(1.0 - keep**2)
    return np.asarray(lfilter([1.0], [1.0, -keep], white, axis=0), np.float64)


class _DefectiveRobot(MujocoRobot):
    """The robot with bars and springs that its design does not have."""

    def __init__(self, design: Design, defects: Defects) -> None:
        super().__init__(design, xml=_changed(mjcf_text(design), defects.bars))
        self._spring = defects.spring

    def _bias(self, q: Array, v: Array, wrench: Array | None) -> tuple[Array, Array]:
        drift, bias = super()._bias(q, v, wrench)
        if self._spring:
            rows = np.zeros((3, self.model.nv))
            for leg in range(3):
                body = self.model.body(leg_name(leg, "joint9")).id
                at = self.data.xipos[body]
                self._mujoco.mj_jac(self.model, self.data, rows, None, at, body)
                bias = bias - self._spring * rows[2]
        return drift, bias


def _changed(text: str, bars: tuple[HeavierBar, ...]) -> str:
    """Return an MJCF text with other masses and inertias of some bars."""
    root = ET.fromstring(text)
    bodies = {body.attrib.get("name"): body for body in root.iter("body")}
    for leg, bar, factor in bars:
        body = bodies.get(leg_name(leg, bar))
        inertial = None if body is None else body.find("inertial")
        if inertial is None:
            raise InvalidInput("bars", f"leg {leg + 1} has no bar {bar!r}; write B2, B3, B4 ...")
        if not factor > 0.0:
            raise InvalidInput("bars", f"a factor above 0 is needed, not {factor!r}")
        inertial.set("mass", repr(factor * float(inertial.attrib["mass"])))
        tensor = (factor * float(value) for value in inertial.attrib["diaginertia"].split())
        inertial.set("diaginertia", " ".join(map(repr, tensor)))
    return ET.tostring(root, encoding="unicode")
