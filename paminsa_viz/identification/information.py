"""What a motion tells of the parameters, and how far it stays from the robot's limits.

Both come with their derivatives by the motion's coefficients. The derivatives by the state of a
sample are differences, all of a period in one batch; the rest is exact:
d log det M = 2 tr(M^-1 W^T dW).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from paminsa_viz.identification.base_parameters import SELECTION, base_regressor
from paminsa_viz.identification.multi_sine import MultiSineFamily
from paminsa_viz.model import backend
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.dynamics import friction_torque
from paminsa_viz.model.jacobians import inverse_jacobian
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.lumped import lumped_coefficients
from paminsa_viz.model.parameters import ActuatorFriction
from paminsa_viz.model.reach import check_reach
from paminsa_viz.model.regressor import drive_regressor, torque_regressor
from paminsa_viz.model.singularity import DEXTERITY
from paminsa_viz.model.statics import load_torques

DRAWN_STATES = 400
"""Random states that show how large the columns of the base parameters are."""

STEP = 1e-6
"""Step of the differences, over the size of a coordinate or rate."""

COULOMB_SHARE = 0.02
"""Speed scale of the Coulomb step over the speed limit: a sharper one has no derivative to use."""


class ExcitationLimits(NamedTuple):
    """What a motion has to keep.

    Attributes:
        speed: (4,) of the actuators [rad/s, m/s].
        torque: (4,) of the actuators, to both sides [N m, N].
        condition: Of the map from speeds of M1..M3 to the platform's, see `measure_singularity`.
            Near the singular circle torques are large, so that without it the best motion would
            go there, where a wrong length matters most.
        clearance: Distance to the limits of reach, and of the joints 5 from the height of the
            guides, on whose other side the platform would be among the legs [m].
    """

    speed: Array
    torque: Array
    condition: float = 5.0
    clearance: float = 0.01


LIMITED = (
    *(f"speed of M{number}" for number in range(1, 5)),
    *(f"torque of M{number}" for number in range(1, 4)), "force of M4",
    "condition number", "height", "reach",
)  # fmt: skip
"""The limits, in the order of `Evaluation.room`."""


GROUPS = np.vstack([np.eye(len(LIMITED)), np.tile(np.eye(len(LIMITED))[-1], (11, 1))])
"""Which limit of `LIMITED` each value of `StateValues.room` belongs to, (22, 11)."""


class StateValues(NamedTuple):
    """Values at states of batch shape (...), from which information and room follow.

    Attributes:
        regressor: (..., 4, 18).
        speed: (..., 4) of the actuators [rad/s, m/s].
        room: (..., 22) what is left to each limit, as a share of it, see `GROUPS`: the last limit,
            reach, is one of each leg and kind, as a share of R_b.
    """

    regressor: Array
    speed: Array
    room: Array


class Evaluation(NamedTuple):
    """What a motion is worth, with derivatives by its variables.

    Attributes:
        value: log det of the information of a sample; -inf where the motion is impossible.
        room: (11,) least share left to each limit, softened; negative beyond it.
        slope: (size,) derivative of ``value``.
        room_slope: (11, size).
        worst: The least share left, not softened.
    """

    value: float
    room: Array
    slope: Array
    room_slope: Array
    worst: float


class Information:
    """Information of periodic motions about base parameters, friction and offsets of a design.

    Attributes:
        family: The motions.
        rank: Number of parameters: base parameters of the masses, viscous and Coulomb friction of
            each actuator, offsets of M1..M3.
        noise: (4,) standard deviation of the torques [N m, N]; ones until it is set.
        sharp: Whether the torques' own Coulomb step is taken instead of a soft one.
    """

    def __init__(
        self,
        design: Design,
        limits: ExcitationLimits,
        family: MultiSineFamily,
        period: float,
        samples: int,
    ) -> None:
        self.family, self.limits = family, limits
        self._design, self._geometry = design, design.geometry
        self._mechanism = mechanism(design.geometry)
        self._c = lumped_coefficients(design)
        self._waves = family.waves(np.arange(samples) / samples, period)
        self._coulomb_speed = COULOMB_SHARE * np.asarray(limits.speed)
        rate = 2.0 * np.pi / period
        self._sizes = np.concatenate([family.scale * rate**order for order in range(3)])
        self._base = self._base_columns()
        self.rank = self._base.shape[1] + 11
        self.noise = np.ones(4)
        self.sharp = False

    def _base_columns(self) -> Array:
        """Return columns (18, 11) of the base parameters, scaled to be of one size."""
        rng = np.random.default_rng(0)
        drawn = rng.uniform(-0.5, 0.5, (DRAWN_STATES, 3, 4)) * self._sizes.reshape(3, 4)
        drawn[:, 0] += self.family.center
        x = base_regressor(self._geometry, drawn[:, 0], drawn[:, 1], drawn[:, 2])
        x = x[np.isfinite(x).all(axis=(1, 2))].reshape(-1, x.shape[-1])
        # a robot that hardly reaches anything may have none of them
        return SELECTION / np.maximum(np.sqrt((x**2).sum(axis=0) / max(len(x), 1)), 1e-12)

    def states(self, variables: Array) -> Array:
        """Return poses and rates of a period for variables (..., size), (..., samples, 12)."""
        parts = self.family.by_coordinate(variables)
        rates = [parts @ wave.T for wave in self._waves]
        states = np.concatenate([np.swapaxes(rate, -1, -2) for rate in rates], axis=-1)
        states[..., :4] += self.family.center
        return states

    @np.errstate(all="ignore")
    def at(self, states: Array) -> StateValues:
        """Return the values at states (..., 12)."""
        p, v, a = (states[..., start : start + 4] for start in (0, 4, 8))
        shape = p.shape[:-1]
        y = torque_regressor(self._geometry, p, v, a, gravity=self._design.gravity)
        speed = np.einsum("...ij,...j->...i", inverse_jacobian(self._geometry, p), v)
        torque = np.einsum("...ij,j->...i", y, self._c)
        if any(self._design.drive_inertia):
            growth = drive_regressor(self._geometry, p, v, a)
            torque = torque + growth @ np.array(self._design.drive_inertia)
        torque = torque + friction_torque(self._friction, speed)
        if self._design.load.acts:
            flat = p.reshape(-1, 4)
            held = load_torques(self._geometry, self._design.load, flat)
            torque = torque + held.reshape(torque.shape)
        flat = np.ascontiguousarray(p.reshape(-1, 4))
        kappa = backend.over_list(DEXTERITY, self._mechanism, flat)[:, 1].reshape(shape)
        margins = check_reach(self._geometry, p).margins.reshape(*shape, 12)
        length = self._geometry.base_radius
        room = [
            1.0 - np.abs(speed) / self.limits.speed,
            1.0 - np.abs(torque) / self.limits.torque,
            1.0 - kappa[..., None] / self.limits.condition,
            (natural_height(self._geometry, p)[..., None] - self.limits.clearance) / length,
            (margins - self.limits.clearance) / length,
        ]
        return StateValues(y, speed, np.concatenate(room, axis=-1))

    @property
    def _friction(self) -> ActuatorFriction:
        """The design's friction, with a step as soft as that of the columns."""
        own = self._design.actuator_friction
        if self.sharp:
            return own
        soft = float(self._coulomb_speed.min())
        return own._replace(transition_speed=max(own.transition_speed, soft))

    def _columns(self, values: StateValues) -> Array:
        """Return the rows over their noise, (..., samples, 4, rank)."""
        shape = values.speed.shape
        found = np.zeros((*shape, self.rank))
        r = self._base.shape[1]
        found[..., :r] = values.regressor @ self._base
        own = np.arange(4)
        found[..., own, r + own] = values.speed
        found[..., own, r + 4 + own] = np.tanh(values.speed / self._coulomb_speed)
        found[..., own[:3], r + 8 + own[:3]] = 1.0
        return found / self.noise[:, None]

    def torque_rms(self, variables: Array) -> Array:
        """Return the RMS torque of motions (..., size) by actuator, (..., 4) [N m, N]."""
        torque = self.at(self.states(variables)).regressor @ self._c
        return np.sqrt((torque**2).mean(axis=-2))

    @np.errstate(all="ignore")
    def log_det(self, variables: Array) -> Array:
        """Return log det of the information of a sample of motions (..., size), (...)."""
        rows = self._columns(self.at(self.states(variables)))
        rows = rows.reshape(*rows.shape[:-3], -1, self.rank)
        matrix = np.swapaxes(rows, -1, -2) @ rows / len(self._waves[0])
        sign, value = np.linalg.slogdet(matrix)
        return np.where((sign > 0) & np.isfinite(value), value, -np.inf)

    def worst_room(self, variables: Array) -> Array:
        """Return the least share left to any limit of motions (..., size), (...); NaN beyond."""
        return self.at(self.states(variables)).room.min(axis=(-1, -2))

    def evaluate(self, variables: Array, sharpness: float) -> Evaluation:
        """Return the worth of one motion (size,) with derivatives.

        Args:
            variables: The motion.
            sharpness: The softened least share is too small by up to log(samples) over this.
        """
        states = self.states(variables)
        steps = STEP * self._sizes
        moved = states + np.vstack([np.zeros(12), np.diag(steps)])[:, None]  # (13, samples, 12)
        values = self.at(moved)
        room, by_state = values.room[0], (values.room[1:] - values.room[0]) / steps[:, None, None]
        if not np.isfinite(values.room).all():  # torques are among them: so is the regressor
            return self._impossible()
        here = StateValues(*(value[0] for value in values))
        rows = self._columns(here).reshape(-1, self.rank)
        matrix = rows.T @ rows
        sign, value = np.linalg.slogdet(matrix)
        if sign <= 0:
            return self._impossible()
        samples, r = len(states), self._base.shape[1]
        weights = 2.0 * np.linalg.solve(matrix, rows.T).T.reshape(samples, 4, self.rank)
        weights /= self.noise[:, None]
        own = np.arange(4)
        viscous, coulomb = weights[:, own, r + own], weights[:, own, r + 4 + own]
        bend = 1.0 - np.tanh(here.speed / self._coulomb_speed) ** 2
        coulomb = coulomb * bend / self._coulomb_speed
        change = np.einsum(
            "dnij,nij->dn", values.regressor[1:] - here.regressor, weights[..., :r] @ self._base.T
        )
        change += np.einsum("dni,ni->dn", values.speed[1:] - here.speed, viscous + coulomb)
        slope = self._by_variables((change.T / steps)[None])[0]
        soft, shares = _soft_least(room, sharpness)
        on_limits = np.einsum("dnc,nc,cl->lnd", by_state, shares, GROUPS)
        room_slope = self._by_variables(on_limits)
        value = float(value) - self.rank * np.log(samples)
        return Evaluation(value, soft, slope, room_slope, float(room.min()))

    def _impossible(self) -> Evaluation:
        size, limits = self.family.size, len(LIMITED)
        slopes = np.zeros(size), np.zeros((limits, size))
        return Evaluation(-np.inf, np.full(limits, -1.0), *slopes, -np.inf)

    def _by_variables(self, by_state: Array) -> Array:
        """Return derivatives by the variables, (m, size), from those by states (m, samples, 12)."""
        parts = sum(
            np.einsum("mnd,nw->mdw", by_state[..., 4 * order : 4 * order + 4], wave)
            for order, wave in enumerate(self._waves)
        )
        return np.stack([self.family.from_coordinates(part) for part in np.asarray(parts)])


def natural_height(geometry: Geometry, pose: Array) -> Array:
    """Return how far the joints 5 are from the height of the guides, (...) [m].

    For poses (..., 4); positive on the side where the platform is by design, below the guides with
    the lower knee.
    """
    return -geometry.knee.sign * (pose[..., 3] + geometry.platform_joint_height)


def _soft_least(room: Array, sharpness: float) -> tuple[Array, Array]:
    """Return the softened least share of each limit (11,), and what each value (n, 22) counts."""
    least = np.array([room[:, group > 0].min() for group in GROUPS.T])
    powers = np.exp(-sharpness * (room - GROUPS @ least))
    sums = powers.sum(axis=0) @ GROUPS
    return least - np.log(sums) / sharpness, powers / (GROUPS @ sums)
