"""Drives of the actuators: motor, gear, and screw or belt, with their limits and losses.

Everything but the gear's own limits is at the motor's shaft, as data sheets give it. A motor turns
by `Drive.ratio` N for one unit of its actuator, rad/rad for M1..M3 and rad/m for M4, so that at the
actuator its inertia is N^2 J, its viscous friction N^2 b and its Coulomb friction N c. The
efficiency is none of the dynamics: it counts when a drive is chosen (`paminsa_viz.actuation`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.model.parameters import Group, parameter
from paminsa_viz.units import format_ascii

ACTUATORS = ("M1", "M2", "M3", "M4")
"""Names of the actuators: three rotary ones and the linear one."""

TORQUE_UNITS = ("N m", "N m", "N m", "N")
"""Units of their torques and force."""

SPEED_UNITS = ("rad/s", "rad/s", "rad/s", "m/s")
"""Units of their speeds."""

TRANSMISSIONS = ("", "screw", "belt")
"""What may turn a gear's output into a straight motion; nothing for M1..M3."""

SELF_LOCKING = 0.5
"""Efficiency below which a screw cannot be driven by its load."""

ROUNDING = 1e-12
"""Relative rise of a slope that still counts as concave."""

MOST_POINTS = 16
"""Most points of an envelope."""

Envelope = tuple[tuple[float, float], ...]
"""Corners (speed [rad/s], torque [N m]) of the largest torque as a function of the speed."""


@dataclass(frozen=True)
class Drive(Group, path="drive", limits=(1e-12, 1e9)):
    """A motor with its gear, and the screw or belt of M4; a limit that is None is none.

    Attributes:
        name: Motor and gear, as a person calls them.
        envelope: Corners of the largest motor torque against the speed, linear in between, from
            speed 0 on; without it the peak torque up to the top speed. It holds for both signs of
            torque and speed.
        transmission: ``"screw"`` or ``"belt"`` for M4, empty for M1..M3.
        brake: Whether a brake holds the load while the robot waits.

    Raises:
        InvalidDesign: If a number is negative or not finite, an efficiency is above 1, or the
            envelope is no function of the speed.
    """

    name: str = ""
    rotor_inertia: float = parameter(0.0, "J_r", "kg m^2", "inertia of the rotor")
    gear_inertia: float = parameter(0.0, "J_g", "kg m^2", "inertia of the gear, at the motor shaft")
    gear_ratio: float = parameter(1.0, "n", "", "gear ratio", positive=True)
    efficiency: float = parameter(1.0, "eta", "", "efficiency of the gear", positive=True)
    viscous: float = parameter(0.0, "b_r", "N m s/rad", "viscous friction, at the motor shaft")
    coulomb: float = parameter(0.0, "c_r", "N m", "Coulomb friction, at the motor shaft")
    rated_torque: float | None = parameter(None, "T_r", "N m", "rated torque", positive=True)
    peak_torque: float | None = parameter(None, "T_p", "N m", "peak torque", positive=True)
    rated_speed: float | None = parameter(None, "w_r", "rad/s", "rated speed", positive=True)
    top_speed: float | None = parameter(None, "w_p", "rad/s", "top speed", positive=True)
    envelope: Envelope = ()
    thermal_time_constant: float | None = parameter(
        None, "t_th", "s", "thermal time constant of the winding", positive=True
    )
    encoder_counts: float | None = parameter(
        None, "N_e", "", "encoder counts of one motor turn", positive=True
    )
    gear_rated_torque: float | None = parameter(
        None, "T_gr", "N m", "rated torque of the gear, at its output", positive=True
    )
    gear_peak_torque: float | None = parameter(
        None, "T_gp", "N m", "peak torque of the gear, at its output", positive=True
    )
    gear_top_speed: float | None = parameter(
        None, "w_g", "rad/s", "top speed of the gear, at its input", positive=True
    )
    transmission: str = ""
    lead: float | None = parameter(None, "p", "m", "travel in a turn of the output", positive=True)
    lead_efficiency: float = parameter(
        1.0, "eta_l", "", "efficiency of screw or belt", positive=True
    )
    brake: bool = False
    mass: float | None = parameter(None, "m_d", "kg", "mass, fixed to the base")
    cost: float | None = parameter(None, "cost", "", "cost, in any currency")

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.name, str):
            raise InvalidDesign("drive.name", self.name, "a text is needed")
        for name in ("efficiency", "lead_efficiency"):
            if getattr(self, name) > 1:
                allowed = "an efficiency is above 0 and at most 1"
                raise InvalidDesign(f"drive.{name}", getattr(self, name), allowed)
        if self.transmission not in TRANSMISSIONS:
            allowed = 'a transmission is "screw" or "belt", or empty'
            raise InvalidDesign("drive.transmission", self.transmission, allowed)
        if (self.lead is None) != (self.transmission == ""):
            raise InvalidDesign("drive.lead", self.lead, "a screw or belt has a lead, others none")
        if not isinstance(self.brake, bool):
            raise InvalidDesign("drive.brake", self.brake, "true or false is needed")
        object.__setattr__(self, "envelope", checked_envelope(self.envelope))

    @property
    def ratio(self) -> float:
        """Motor angle for one unit of the actuator, N [rad/rad, or rad/m]."""
        return self.gear_ratio * (1.0 if self.lead is None else 2 * math.pi / self.lead)

    @property
    def inertia(self) -> float:
        """Inertia at the motor's shaft, J = J_r + J_g [kg m^2]."""
        return self.rotor_inertia + self.gear_inertia

    @property
    def reflected_inertia(self) -> float:
        """Inertia at the actuator, N^2 J [kg m^2, or kg]."""
        return self.ratio**2 * self.inertia

    @property
    def reflected_friction(self) -> tuple[float, float]:
        """Viscous and Coulomb friction at the actuator, N^2 b and N c.

        In [N m s/rad, N m] for M1..M3, in [N s/m, N] for M4.
        """
        return self.ratio**2 * self.viscous, self.ratio * self.coulomb

    @property
    def total_efficiency(self) -> float:
        """Efficiency of gear and screw or belt."""
        return self.efficiency * self.lead_efficiency

    @property
    def holds(self) -> bool:
        """Whether it holds a load at rest without torque: a brake, or a self-locking screw."""
        return self.brake or (self.transmission == "screw" and self.lead_efficiency < SELF_LOCKING)

    @property
    def corners(self) -> Envelope:
        """The envelope in force, from speed 0 to the top speed; infinite where nothing limits.

        The peak torque and the top speed limit an envelope that goes beyond them.
        """
        peak = math.inf if self.peak_torque is None else self.peak_torque
        top = math.inf if self.top_speed is None else self.top_speed
        if not self.envelope:
            return ((0.0, peak), (top, peak))
        found = [(speed, torque) for speed, torque in self.envelope if speed < top]
        if self.envelope[-1][0] >= top:
            speeds, torques = zip(*self.envelope, strict=True)
            found.append((top, float(np.interp(top, speeds, torques))))
        limited: list[tuple[float, float]] = []
        for (s0, t0), (s1, t1) in pairwise(found):
            limited.append((s0, min(t0, peak)))
            if (t0 - peak) * (t1 - peak) < 0:
                limited.append((s0 + (peak - t0) / (t1 - t0) * (s1 - s0), peak))
        return (*limited, (found[-1][0], min(found[-1][1], peak)))

    @property
    def lines(self) -> tuple[tuple[float, float], ...]:
        """Lines torque <= a - s speed that keep the envelope, as pairs a, s [N m, N m s/rad].

        They are the envelope where it is concave. Below another one it is the steepest line from
        its torque at rest to a corner.
        """
        (_, first), *rest = self.corners
        if math.isinf(first) or math.isinf(self.corners[-1][0]):
            return ((first, 0.0),)
        falls = [(t0 - t1) / (s1 - s0) for (s0, t0), (s1, t1) in pairwise(self.corners)]
        if all(b >= a - ROUNDING * abs(a) for a, b in pairwise(falls)):
            starts = self.corners[:-1]
            return tuple((t + s * w, s) for (w, t), s in zip(starts, falls, strict=True))
        return ((first, max((first - torque) / speed for speed, torque in rest)),)

    @property
    def output_limits(self) -> OutputLimits:
        """What it gives at the actuator, its efficiency taken off."""
        factor = self.ratio * self.total_efficiency
        peak = max(torque for _, torque in self.corners)
        rated = math.inf if self.rated_torque is None else self.rated_torque
        gear = self.gear_limits
        return OutputLimits(
            min(factor * peak, gear.peak),
            min(factor * rated, gear.rated),
            min(self.corners[-1][0] / self.ratio, gear.speed),
        )

    @property
    def gear_limits(self) -> OutputLimits:
        """What the gear alone can take, at the actuator."""
        lever = self.ratio / self.gear_ratio * self.lead_efficiency
        return OutputLimits(
            math.inf if self.gear_peak_torque is None else self.gear_peak_torque * lever,
            math.inf if self.gear_rated_torque is None else self.gear_rated_torque * lever,
            math.inf if self.gear_top_speed is None else self.gear_top_speed / self.ratio,
        )

    @property
    def resolution(self) -> float | None:
        """Motion of the actuator for one count of the encoder [rad or m]."""
        counts = self.encoder_counts
        return None if counts is None else 2 * math.pi / (counts * self.ratio)

    @property
    def summary(self) -> str:
        """Name and ratio in a line, for tables: ``"motor 100 W, gear, 100:1"``.

        A ratio that is part of the name, as gears in a catalog have it, is not said again.
        """
        parts = [self.name] if self.name else []
        ratio = f"{self.gear_ratio:g}:1"
        if ratio not in self.name.replace(",", " ").split():
            parts.append(ratio)
        if self.lead is not None:
            parts.append(f"{self.transmission} {format_ascii(self.lead, 'm')}")
        return ", ".join(parts)

    def without_friction(self) -> Drive:
        """Return the drive without viscous and Coulomb friction."""
        return replace(self, viscous=0.0, coulomb=0.0)


class OutputLimits(NamedTuple):
    """What drives give at their actuators; infinite where nothing limits.

    Attributes:
        peak: Torque or force for a short time, at low speed [N m or N].
        rated: Continuous torque or force [N m or N].
        speed: Top speed [rad/s or m/s].
    """

    peak: float
    rated: float
    speed: float


UNLIMITED = OutputLimits(math.inf, math.inf, math.inf)
"""Limits of an actuator without a drive."""

Drives = tuple[Drive | None, Drive | None, Drive | None, Drive | None]
"""Drives of M1..M4; None where none is chosen."""

NO_DRIVES: Drives = (None, None, None, None)
"""No drive for any of M1..M4, the default."""


def check_drives(drives: object) -> None:
    """Raise `InvalidDesign` unless these can be the drives of M1..M4."""
    if not isinstance(drives, tuple) or len(drives) != len(ACTUATORS):
        raise InvalidDesign("drives", drives, "four drives are needed, None for none")
    for name, drive in zip(ACTUATORS, drives, strict=True):
        if drive is None:
            continue
        if not isinstance(drive, Drive):
            raise InvalidDesign(f"drives.{name}", drive, "a Drive or None is needed")
        if (drive.lead is None) == (name == "M4"):
            allowed = (
                "M4 moves along a line: it needs a screw or belt with a lead"
                if name == "M4"
                else "only M4 moves along a line: M1..M3 have neither screw nor belt"
            )
            raise InvalidDesign(f"drives.{name}.lead", drive.lead, allowed)


def checked_envelope(envelope: object) -> Envelope:
    """Return an envelope as pairs of floats.

    Raises:
        InvalidDesign: If it is no function of the speed that starts at 0.
    """

    def refused(allowed: str) -> InvalidDesign:
        return InvalidDesign("drive.envelope", envelope, allowed)

    try:
        points = tuple((float(speed), float(torque)) for speed, torque in envelope)  # type: ignore[union-attr]
    except (TypeError, ValueError):
        raise refused("pairs of speed [rad/s] and torque [N·m] are needed") from None
    if not points:
        return ()
    if not 2 <= len(points) <= MOST_POINTS:
        raise refused(f"an envelope has 2 to {MOST_POINTS} points")
    if not all(math.isfinite(value) and value >= 0 for point in points for value in point):
        raise refused("speeds and torques are finite numbers of at least 0")
    speeds = [speed for speed, _ in points]
    if speeds[0] != 0 or any(b <= a for a, b in pairwise(speeds)):
        raise refused("an envelope is a function of the speed: speeds start at 0 and increase")
    if points[0][1] == 0:
        raise refused("the torque at speed 0 has to be above 0")
    return points
