"""Inverse dynamics of a closed loop from an engine's tree: eliminate the dependent joints.

An engine knows the open tree: its mass matrix M and bias forces b in the joint velocities v, and
the Jacobian G of the loop closures with its drift, so that G v = 0 and G v' + drift = 0. With the
platform's four velocities as independent ones, v = S u and v' = S u' + s follow by solving for the
others. The principle of virtual power then gives the forces in the actuated joints alone:

    S_act^T tau = S^T (M v' + b),

where b holds the external load as well, which the engine puts on the platform in its own way.

Closures of a plane loop by ball joints repeat themselves, so G has more rows than its rank; the
dependent columns have full rank, and the consistent system is solved by least squares.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from paminsa_viz.engines.mechanism import POSE_JOINTS, MechanismTree, build_mechanism
from paminsa_viz.engines.poses import joint_values, unclosed
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import inverse_kinematics


class ClosedLoopRobot(ABC):
    """The robot in a physics engine; all quantities are the engine's own.

    Attributes:
        design: The robot.
        mechanism: The links and closures that the engine's model was built from.
    """

    def __init__(self, design: Design) -> None:
        """Build the engine's model.

        Raises:
            EngineMissing: If the engine is not installed.
            InvalidDesign: If a bar's inertias belong to no rigid body.
        """
        self.design = design
        self.mechanism: MechanismTree = build_mechanism(design)
        self._names: tuple[str, ...] = ()

    def _set_order(self, names: Iterable[str]) -> None:
        """Take note of the joints in the order of the engine's coordinates and velocities.

        Raises:
            InvalidInput: If they are not the mechanism's: a model from elsewhere was loaded.
        """
        self._names = tuple(names)
        own = {joint.name for link in self.mechanism.links for joint in link.joints}
        if strange := sorted(own.symmetric_difference(self._names)):
            raise InvalidInput(
                "model", f"its joints are not those of this robot ({', '.join(strange[:3])} ...)"
            )
        self._independent = np.array([self._names.index(name) for name in POSE_JOINTS])
        self._actuated = np.array([self._names.index(name) for name in self.mechanism.actuated])

    @abstractmethod
    def _tree(self, q: Array) -> tuple[Array, Array]:
        """Return closure Jacobian (m, nv) and mass matrix (nv, nv) at one configuration."""

    @abstractmethod
    def _bias(self, q: Array, v: Array, wrench: Array | None) -> tuple[Array, Array]:
        """Return closure drift (m,) and bias forces (nv,) with gravity at one state.

        A wrench (6,) [N, N m] acts on the platform at the load's point, in its directions.
        """

    def static_torques(self, poses: ArrayLike) -> Array:
        """Return what the actuators need to hold poses (..., 4) at rest.

        Returns:
            (..., 4) = (tau_1, tau_2, tau_3 [N m], F_4 [N]); NaN where a pose has no configuration.
        """
        poses = np.asarray(poses, float)
        rest = np.zeros_like(poses)
        return self.inverse_dynamics(poses, rest, rest)

    def inverse_dynamics(
        self,
        poses: ArrayLike,
        velocities: ArrayLike,
        accelerations: ArrayLike,
        *,
        load: ArrayLike | None = None,
    ) -> Array:
        """Return what the actuators need for platform motions, without joint friction.

        The design's load acts on the platform.

        Args:
            poses: (..., 4) [m, m, rad, m].
            velocities: (..., 4) rates of the pose [m/s, m/s, rad/s, m/s].
            accelerations: (..., 4) [m/s^2, m/s^2, rad/s^2, m/s^2].
            load: (..., 6) a wrench on top of the design's load [N, N m].

        Returns:
            (..., 4) = (tau_1, tau_2, tau_3 [N m], F_4 [N]); NaN where a pose cannot be reached
            or is exactly singular.

        Raises:
            InvalidInput: If the last axis does not hold four numbers.
        """
        given = {"poses": poses, "velocities": velocities, "accelerations": accelerations}
        for name, values in given.items():
            shape = np.shape(values)
            if not shape or shape[-1] != 4:
                raise InvalidInput(name, f"shape {shape} does not end in 4")
        x, u, du = np.broadcast_arrays(*(np.asarray(a, float) for a in given.values()))
        shape = x.shape
        x, u, du = (a.reshape(-1, 4) for a in (x, u, du))
        good, q = self._place(x, u, du)
        torque = np.full(x.shape, np.nan)
        if good.any():
            wrench = self._wrenches(load, shape)
            wrench = None if wrench is None else wrench[good]
            torque[good] = self._project(q, u[good], du[good], wrench)
        return torque.reshape(shape)

    def _wrenches(self, load: ArrayLike | None, shape: tuple[int, ...]) -> Array | None:
        """Return the wrench of every state of a batch (..., 4), as (n, 6); None for none."""
        own = self.design.load
        if load is None and not own.acts:
            return None
        whole = np.array(own.wrench) + (np.zeros(6) if load is None else np.asarray(load, float))
        return np.broadcast_to(whole, (*shape[:-1], 6)).reshape(-1, 6)

    def actuator_inertia(self, poses: ArrayLike) -> Array:
        """Return the mass matrix of the whole robot in its actuators (..., 4, 4).

        At poses (..., 4); units by row and column of (theta_1, theta_2, theta_3 [rad], Z [m]). NaN
        as in `inverse_dynamics`.
        """
        poses = np.asarray(poses, float)
        flat = poses.reshape(-1, 4)
        good, q = self._place(flat)
        inertia = np.full((len(flat), 4, 4), np.nan)
        if good.any():
            mass, spread, _ = self._eliminate(q)
            driven = _solve(np.swapaxes(spread[:, self._actuated], 1, 2), np.swapaxes(spread, 1, 2))
            inertia[good] = driven @ mass @ np.swapaxes(driven, 1, 2)
        return inertia.reshape(*poses.shape, 4)

    def state(self, pose: ArrayLike, velocity: ArrayLike) -> tuple[Array, Array]:
        """Return the engine's own coordinates (nq,) and velocities (nv,) of one platform state.

        Raises:
            UnreachablePose: If the pose has no configuration.
        """
        x, u = (np.asarray(a, float).reshape(1, 4) for a in (pose, velocity))
        good, q = self._place(x, u)
        if not good[0]:
            raise unclosed(x[0])
        _, spread, _ = self._eliminate(q)
        return q[0], spread[0] @ u[0]

    def pose(self, q: Array) -> Array:
        """Return the platform's pose (..., 4) at the engine's coordinates (..., nq)."""
        return q[..., self._independent]

    def _place(self, x: Array, *motion: Array) -> tuple[NDArray[np.bool_], Array]:
        """Return which poses (n, 4) are reachable with finite motion, and their coordinates."""
        values = joint_values(inverse_kinematics(self.design.geometry, x))
        q = np.stack([values[name] for name in self._names], axis=1)
        good = np.asarray(np.isfinite(np.concatenate([q, *motion], axis=1)).all(axis=1))
        return good, q[good]

    def _eliminate(self, q: Array) -> tuple[Array, Array, Callable[[Array], Array]]:
        """Return M, S, and the solver of G_dependent v = right, at configurations (n, nq)."""
        trees = [self._tree(row) for row in q]
        jacobian = np.stack([tree[0] for tree in trees])
        mass = np.stack([tree[1] for tree in trees])
        n, _, size = jacobian.shape
        dependent = np.setdiff1d(np.arange(size), self._independent)
        basis, upper = np.linalg.qr(jacobian[:, :, dependent])

        def solve(right: Array) -> Array:
            found = np.zeros((n, size, right.shape[-1]))
            found[:, dependent] = _solve(upper, np.swapaxes(basis, 1, 2) @ right)
            return found

        spread = -solve(jacobian[:, :, self._independent])
        spread[:, self._independent] = np.eye(4)
        return mass, spread, solve

    def _project(self, q: Array, u: Array, du: Array, wrench: Array | None) -> Array:
        """Inverse dynamics at configurations (n, nq), velocities and accelerations (n, 4)."""
        mass, spread, solve = self._eliminate(q)
        velocity = (spread @ u[..., None])[..., 0]
        loads = [None] * len(q) if wrench is None else wrench
        states = [self._bias(*state) for state in zip(q, velocity, loads, strict=True)]
        drift = np.stack([state[0] for state in states])[..., None]
        bias = np.stack([state[1] for state in states])[..., None]
        force = mass @ (spread @ du[..., None] - solve(drift)) + bias
        needed = np.swapaxes(spread, 1, 2) @ force
        return _solve(np.swapaxes(spread[:, self._actuated], 1, 2), needed)[..., 0]


def _solve(matrix: Array, right: Array) -> Array:
    """Solve a stack of systems; NaN for the exactly singular ones."""
    try:
        return np.asarray(np.linalg.solve(matrix, right), float)
    except np.linalg.LinAlgError:
        found = np.full(right.shape, np.nan)
        for index, one in enumerate(matrix):
            if np.linalg.det(one) != 0:
                found[index] = np.linalg.solve(one, right[index])
        return found
