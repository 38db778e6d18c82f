"""Many drives as columns, so that one expression evaluates all of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.drive import ROUNDING, Drive


@dataclass(frozen=True, eq=False)
class DriveTable:
    """Drives as columns of n entries; a limit that a drive lacks is infinite, a price NaN.

    Attributes:
        ratio: Motor angle for one unit of the actuator, N [rad/rad, rad/m].
        inertia, viscous, coulomb: J, b, c at the motor's shaft [kg m^2, N m s/rad, N m].
        output_inertia, output_viscous, output_coulomb: Of a screw or belt whose gear is not chosen
            yet, at the actuator [kg, N s/m, N]; at the motor they are divided by N^2, N^2 and N.
            Zero where they are part of J, b and c.
        efficiency: Of gear and screw together.
        rated_torque, rated_speed, top_speed: Of the motor [N m, rad/s]; the top speed is also the
            gear's.
        thermal_time: Time constant of the winding [s]; infinite if not known.
        gear_rated, gear_peak: Of the gear, at the actuator [N m, N].
        holds: Whether it holds a load at rest without torque.
        mass, cost: [kg], any currency.
        corner_speed, corner_torque: (n, corners) of the envelopes in force [rad/s, N m]; the last
            corner is repeated where an envelope has fewer.
        parts: Per drive the row of each of ``catalog``'s lists that it was made of, (n, lists).
        catalog: The drives, or the motors, gears and screws, that it was made of.
    """

    ratio: Array
    inertia: Array
    viscous: Array
    coulomb: Array
    output_inertia: Array
    output_viscous: Array
    output_coulomb: Array
    efficiency: Array
    rated_torque: Array
    rated_speed: Array
    top_speed: Array
    thermal_time: Array
    gear_rated: Array
    gear_peak: Array
    holds: NDArray[np.bool_]
    mass: Array
    cost: Array
    corner_speed: Array
    corner_torque: Array
    parts: NDArray[np.intp]
    catalog: tuple[tuple[Drive, ...], ...]

    def __len__(self) -> int:
        return len(self.ratio)

    def __getitem__(self, index: NDArray[np.bool_] | NDArray[np.intp] | slice) -> DriveTable:
        columns = {f.name: getattr(self, f.name)[index] for f in fields(self)[:-1]}
        return DriveTable(**columns, catalog=self.catalog)

    def drive(self, index: int) -> Drive:
        """Return one of the drives."""
        chosen = [part[row] for part, row in zip(self.catalog, self.parts[index], strict=True)]
        return combined(*chosen)

    def factors(self, ratio: Array | None = None) -> Array:
        """Return what the signals of a load are multiplied by, (n, 6); see `duty.Signal`."""
        n = (self.ratio if ratio is None else ratio)[:, None]
        found = self.geared_down / n + n * self.geared_up
        found[:, -1] += self.coulomb
        return found

    @property
    def geared_down(self) -> Array:
        """What of `factors` is divided by N, (n, 6)."""
        columns = (
            1 / self.efficiency, self.efficiency, np.ones(len(self)),
            self.output_inertia, self.output_viscous, self.output_coulomb,
        )  # fmt: skip
        return np.stack(columns, axis=1)

    @property
    def geared_up(self) -> Array:
        """What of `factors` is multiplied by N, (n, 6)."""
        none = np.zeros(len(self))
        return np.stack([none, none, none, self.inertia, self.viscous, none], axis=1)

    @property
    def slopes(self) -> Array:
        """Slopes between the corners, (n, corners - 1) [N m s/rad]; NaN between repeated ones."""
        with np.errstate(divide="ignore", invalid="ignore"):
            rise = np.diff(self.corner_torque, axis=1)
            return np.where(rise == 0, 0.0, rise) / np.diff(self.corner_speed, axis=1)

    @property
    def concave(self) -> NDArray[np.bool_]:
        """Whether the envelope is a concave function of the speed, (n,)."""
        slopes = np.where(np.isnan(self.slopes), -np.inf, self.slopes)
        rise = np.diff(np.where(np.isfinite(slopes), slopes, -1e300), axis=1)
        bound = ROUNDING * np.abs(slopes[:, :1])
        return np.asarray((rise <= bound).all(axis=1))

    @property
    def lines(self) -> tuple[Array, Array]:
        """The lines of concave envelopes, torque <= a - s speed: a and s, each (n, lines)."""
        slopes = self.slopes
        used = np.isfinite(slopes)
        s = np.where(used, -slopes, 0.0)
        starts = np.where(used, self.corner_speed[:, :-1], 0.0)
        return np.where(used, self.corner_torque[:, :-1] + s * starts, np.inf), s


def drive_table(drives: Sequence[Drive]) -> DriveTable:
    """Return drives as columns."""

    def column(name: str, missing: float = math.inf) -> Array:
        found = [getattr(drive, name) for drive in drives]
        return np.array([missing if value is None else value for value in found], float)

    lever = np.array([d.ratio / d.gear_ratio * d.lead_efficiency for d in drives], float)
    corners = [drive.corners for drive in drives]
    count = max((len(points) for points in corners), default=2)
    padded = np.array(
        [[*points, *[points[-1]] * (count - len(points))] for points in corners], float
    ).reshape(len(drives), count, 2)
    top = np.minimum(padded[:, -1, 0], column("gear_top_speed"))
    return DriveTable(
        ratio=column("ratio"),
        inertia=column("inertia"),
        viscous=column("viscous"),
        coulomb=column("coulomb"),
        output_inertia=np.zeros(len(drives)),
        output_viscous=np.zeros(len(drives)),
        output_coulomb=np.zeros(len(drives)),
        efficiency=column("total_efficiency"),
        rated_torque=column("rated_torque"),
        rated_speed=column("rated_speed"),
        top_speed=top,
        thermal_time=column("thermal_time_constant"),
        gear_rated=column("gear_rated_torque") * lever,
        gear_peak=column("gear_peak_torque") * lever,
        holds=np.array([drive.holds for drive in drives], bool),
        mass=column("mass", math.nan),
        cost=column("cost", math.nan),
        corner_speed=padded[..., 0],
        corner_torque=padded[..., 1],
        parts=np.arange(len(drives))[:, None],
        catalog=(tuple(drives),),
    )


def pair_table(
    motors: Sequence[Drive], gears: Sequence[Drive], transmissions: Sequence[Drive] = ()
) -> DriveTable:
    """Return every motor with every gear, and every screw or belt if there are any, as columns.

    Args:
        motors: Drives of which only the motor counts.
        gears: Drives of which only the gear counts.
        transmissions: Drives of which only the screw or belt counts, with inertia and friction at
            its own shaft; none for M1..M3.
    """
    tables = [drive_table(part) for part in (motors, gears, transmissions) if part]
    sizes = [len(table) for table in tables]
    rows = np.stack([index.ravel() for index in np.indices(sizes)], axis=1)
    picked = [table[rows[:, place]] for place, table in enumerate(tables)]
    motor, gear = picked[0], picked[1]
    n = gear.ratio
    screw = picked[2] if transmissions else None
    screw_ratio = 1.0 if screw is None else screw.ratio
    screw_efficiency = 1.0 if screw is None else screw.efficiency
    lever = screw_ratio * screw_efficiency
    return replace(
        motor,
        ratio=gear.ratio * screw_ratio,
        inertia=motor.inertia + gear.inertia + (0.0 if screw is None else screw.inertia / n**2),
        viscous=motor.viscous + gear.viscous + (0.0 if screw is None else screw.viscous / n**2),
        coulomb=motor.coulomb + gear.coulomb + (0.0 if screw is None else screw.coulomb / n),
        efficiency=gear.efficiency * screw_efficiency,
        top_speed=np.minimum(motor.top_speed, gear.top_speed),
        gear_rated=gear.gear_rated * lever,
        gear_peak=gear.gear_peak * lever,
        holds=motor.holds if screw is None else motor.holds | screw.holds,
        mass=sum((table.mass for table in picked[1:]), motor.mass),
        cost=sum((table.cost for table in picked[1:]), motor.cost),
        parts=rows,
        catalog=tuple(tuple(part) for part in (motors, gears, transmissions) if part),
    )


def combined(motor: Drive, gear: Drive | None = None, transmission: Drive | None = None) -> Drive:
    """Return a motor with a gear, and with a screw or belt, as one drive.

    Masses and costs add, and are unknown if one is. Inertia and friction of the gear are at the
    motor's shaft, those of the screw or belt at its own.
    """
    parts = [part for part in (motor, gear, transmission) if part is not None]
    drive = motor
    if gear is not None:
        drive = replace(
            drive,
            gear_ratio=gear.gear_ratio, efficiency=gear.efficiency,
            gear_rated_torque=gear.gear_rated_torque, gear_peak_torque=gear.gear_peak_torque,
            gear_top_speed=gear.gear_top_speed,
        )  # fmt: skip
    if transmission is not None:
        drive = replace(
            drive,
            transmission=transmission.transmission, lead=transmission.lead,
            lead_efficiency=transmission.lead_efficiency,
        )  # fmt: skip
    losses = [(part.gear_inertia, part.viscous, part.coulomb) for part in parts]
    if transmission is not None:
        inertia, viscous, coulomb = losses.pop()
        n = drive.gear_ratio
        losses.append((inertia / n**2, viscous / n**2, coulomb / n))
    masses, costs = [p.mass for p in parts], [p.cost for p in parts]
    return replace(
        drive,
        name=", ".join(part.name for part in parts if part.name),
        gear_inertia=sum(inertia for inertia, _, _ in losses),
        viscous=sum(viscous for _, viscous, _ in losses),
        coulomb=sum(coulomb for _, _, coulomb in losses),
        brake=any(part.brake for part in parts),
        mass=None if None in masses else sum(m for m in masses if m is not None),
        cost=None if None in costs else sum(c for c in costs if c is not None),
    )
