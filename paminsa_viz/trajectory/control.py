"""Controllers of the simulated robot, and gains that suit it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.dynamics import mass_matrix
from paminsa_viz.model.jacobians import jacobian
from paminsa_viz.trajectory.plant import Gains


class ControlMode(Enum):
    """How the simulated actuators are commanded."""

    FEED_FORWARD = "feed-forward"
    """The torques of the wanted motion, computed beforehand, without feedback."""
    PD = "feed-forward + PD"
    """The same, and torques in proportion to the actuators' position and speed errors."""
    COMPUTED_TORQUE = "computed torque"
    """The torques that, by the model, give the platform the acceleration which brings it back."""


@dataclass(frozen=True)
class Controller:
    """A controller; its gains follow from a bandwidth unless they are given.

    Attributes:
        control: How it works.
        bandwidth: Frequency of the error's own motion, undamped [Hz].
        damping: Its damping ratio; 1 brings an error back fastest without swinging.
        proportional: Gains (4,) of the actuators' position errors, of PD alone [N m/rad, N/m].
        derivative: Gains (4,) of their speed errors [N m s/rad, N s/m].

    Raises:
        InvalidInput: If a number is negative or not finite, or only one set of gains is given.
    """

    control: ControlMode = ControlMode.PD
    bandwidth: float = 8.0
    damping: float = 1.0
    proportional: tuple[float, float, float, float] | None = None
    derivative: tuple[float, float, float, float] | None = None

    def __post_init__(self) -> None:
        for name in ("bandwidth", "damping"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise InvalidInput(name, f"a finite number of at least 0 is needed, not {value!r}")
        if (self.proportional is None) != (self.derivative is None):
            raise InvalidInput("derivative", "proportional and derivative gains come together")
        for name in ("proportional", "derivative"):
            given = getattr(self, name)
            value = np.zeros(4) if given is None else np.asarray(given, dtype=np.float64)
            if value.shape != (4,) or not (np.isfinite(value).all() and (value >= 0).all()):
                raise InvalidInput(name, "four finite gains of at least 0 are needed")

    def gains(self, model: Design, pose: ArrayLike) -> Gains:
        """Return the gains for a robot near a pose (4,) [m, m, rad, m].

        Those of PD are the bandwidth's square and twice its product with the damping, times each
        actuator's own inertia at the pose: the diagonal of J^T M J.
        """
        rate = 2 * np.pi * self.bandwidth
        stiffness, damping = rate**2, 2 * self.damping * rate
        if self.proportional is None or self.derivative is None:
            inertia = actuator_inertia(model, pose)
            p, d = stiffness * inertia, damping * inertia
        else:
            p, d = np.array(self.proportional, float), np.array(self.derivative, float)
        mode = float(list(ControlMode).index(self.control))
        return Gains(mode, stiffness, damping, p, d)


@of_design
def actuator_inertia(design: Design, pose: ArrayLike) -> Array:
    """Return what each actuator feels of the robot's inertia at a pose, (..., 4) [kg m^2, kg]."""
    j = jacobian(design.geometry, pose)
    return np.einsum("...ji,...jk,...ki->...i", j, mass_matrix(design, pose), j)
