"""Forward simulation of the robot with a controller that follows a trajectory.

The controller works with a model of the robot that may differ from the robot in masses, payload,
gravity and friction. The equations of motion are solved by SciPy; the balance of energy along the
solution measures the error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import count
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.checks import check_fields, require_at_least, require_positive
from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.arrays import Array, as_vectors
from paminsa_viz.model.design import Design
from paminsa_viz.model.dynamics import forward_dynamics, mass_matrix
from paminsa_viz.model.energy import kinetic_energy, potential_energy
from paminsa_viz.model.jacobians import jacobian
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.progress import Progress, go_on, keep_on
from paminsa_viz.trajectory.check import (
    GUIDES,
    PassageWindow,
    PathEvent,
    allowed,
    check_path,
    limit_margins,
    singular_clearance,
    worst_event,
)
from paminsa_viz.trajectory.equations import equations
from paminsa_viz.trajectory.plant import Gains
from paminsa_viz.trajectory.sampled import States, Trajectory

# ------------------------------------------------------------ controllers, and gains that suit them


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
        check_fields(self)
        for name in ("bandwidth", "damping"):
            require_at_least(getattr(self, name), name, what="a finite number of at least 0")
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
    """Return what each actuator feels of the robot's inertia at a pose, (..., 4) [kg m^2, kg].

    It is the diagonal of J^T M J, the drives' own inertia included; pose (..., 4) [m, m, rad, m].
    Not finite where the pose is singular.
    """
    j = jacobian(design.geometry, pose)
    return np.einsum("...ji,...jk,...ki->...i", j, mass_matrix(design, pose), j)


# ----------------------------------------------------------------------------- the robot under them

PANTOGRAPH_CLEARANCE = 1e-4
"""Distance from a stretched or folded pantograph at which a simulation stops, at Appendix 4's
lengths [m]; at others in proportion to crank plus coupler.

Beyond the limit there is no motion to compute, and accelerations grow without bound before it.
"""

_TOLERANCE = 1e-8  # relative error of a step that the solver aims at

_NEAR = 1e-2  # margin below which a solver that gives up has come to a limit [m]
_MOST_EVALUATIONS = 100_000
_MOST_A_SECOND = 20_000
_CALLS_A_REPORT = 2_000  # evaluations between two reports: a tenth of a second or so
"""How often the equations may be evaluated, and how often more for a second of the motion.

Ten times what the default gains need; much higher gains would take too long.
"""

_LONGEST_STEP = 0.02  # longest step [s], so that nothing of the wanted motion is stepped over


NO_AUTHORITY = (
    "the motion crosses a singular locus, where the actuators have no authority along the escape "
    "twist: a robot that is not exactly on the motion, by a payload, friction or initial error "
    "that the controller does not know of, cannot be held there, and the commanded torques have "
    "no bound"
)
"""Why a simulation stops in a planned crossing."""


@dataclass(frozen=True, eq=False)
class Simulation:
    """The simulated motion at n instants: the samples of the trajectory until it stopped.

    Attributes:
        design: The robot.
        controller: What drove it.
        trajectory: The wanted motion.
        t: (n,) [s].
        pose: (n, 4) [m, m, rad, m].
        velocity: (n, 4) [m/s, m/s, rad/s, m/s].
        torque: (n, 4) commanded torques of M1..M3 [N m] and force of M4 [N].
        wanted: States of the trajectory, (n, 4) each.
        work: (n,) energy that the actuators have put in [J].
        loss: (n,) energy that friction has taken [J].
        push: (n,) energy that the load has put in [J].
        stopped: Why it stopped before the trajectory's end; None if it did not.
        evaluations: Number of times the equations of motion were evaluated.
    """

    design: Design
    controller: Controller
    trajectory: Trajectory
    t: Array
    pose: Array
    velocity: Array
    torque: Array
    wanted: States
    work: Array
    loss: Array
    push: Array
    stopped: PathEvent | None
    evaluations: int

    @property
    def error(self) -> Array:
        """Pose minus wanted pose, (n, 4) [m, m, rad, m]."""
        return self.pose - self.wanted.pose

    @cached_property
    def distance(self) -> Array:
        """Distance of the platform from where it should be, (n,) [m]."""
        return np.linalg.norm(self.error[:, [0, 1, 3]], axis=1)

    @cached_property
    def energy(self) -> Array:
        """Kinetic plus potential energy of the robot, (n,) [J]."""
        moving = kinetic_energy(self.design, self.pose, self.velocity)
        return moving + potential_energy(self.design, self.pose)

    @cached_property
    def energy_drift(self) -> Array:
        """Growth of energy minus work put in, by the load as well, plus friction losses, (n,) [J].

        Zero but for the error of the solution: how far it is from a motion of the robot.
        """
        return self.energy - self.energy[0] - (self.work + self.push - self.loss)


class SimulationFailed(PaminsaError):
    """A simulation that the solver could not carry on, for no limit that is known.

    Attributes:
        t: How far it came [s].
    """

    def __init__(self, t: float, message: str) -> None:
        self.t = t
        super().__init__(f"the simulation failed at {t:.4g} s: {message}")


@of_design
def simulate(
    design: Design,
    trajectory: Trajectory,
    *,
    model: Design | None = None,
    controller: Controller | None = None,
    offset: ArrayLike = (0.0, 0.0, 0.0, 0.0),
    clearance: float | None = None,
    tolerance: float = _TOLERANCE,
    progress: Progress = go_on,
) -> Simulation:
    """Let a controller drive a robot along a trajectory.

    It stops, with the reason, where the robot comes to a limit of its workspace or too close to a
    singular pose, and in a planned crossing that it cannot follow. Without feedback the robot is
    unstable: held by constant torques at Appendix 4's home pose, an error of theta grows by a
    factor e in 0.18 s.

    Args:
        design: The robot itself, with its friction, its payload and its load.
        trajectory: The wanted motion, with a load that varies with time if it has one: the
            controller knows that one.
        model: The controller's model of the robot; by default the robot itself. It may differ
            in masses, payload, gravity, friction and load, not in geometry.
        controller: By default feed-forward with PD at the actuators.
        offset: (4,) pose error at the start [m, m, rad, m].
        clearance: Least distance from singular positions [m]; `singular_clearance` if None.
        tolerance: Relative error of a step.
        progress: Called now and then.

    Raises:
        Canceled: If ``progress`` ends it.
        ImpossibleTrajectory: If the robot cannot run the trajectory at all.
        InvalidInput: If the model's geometry is another, the start with its offset is out of
            reach, the tolerance is not positive, or nothing of the robot has inertia in some
            direction.
        SimulationFailed: If the solver gives up away from any limit, or would take too long.
    """
    from scipy.integrate import solve_ivp  # slow to load

    require_positive(tolerance, "tolerance")
    model = model or design
    controller = controller or Controller()
    if model.geometry != design.geometry:
        raise InvalidInput("model", "its geometry has to be that of the robot")
    clearance = singular_clearance(design) if clearance is None else clearance
    check = check_path(design.geometry, trajectory, clearance)
    check.require()
    shift = as_vectors(offset, "offset")
    if shift.shape != (4,) or not np.isfinite(shift).all():
        raise InvalidInput("offset", "four finite numbers are needed")
    # pose, velocity, work, losses, and the load's work
    loaded = design.load.acts or trajectory.load is not None
    energies = np.zeros(3 if loaded else 2)
    start = np.concatenate([trajectory.pose[0] + shift, trajectory.velocity[0], energies])
    stop_at = np.where(GUIDES, 0.0, PANTOGRAPH_CLEARANCE * length_ratio(design.geometry))
    stop_at[12:] = 0.0  # the singular distances hold a clearance already
    side = np.array(check.side)

    def margins(t: float, pose: Array) -> Array:
        sides = allowed(np.array([t]), side, clearance, check.windows)
        return limit_margins(design.geometry, pose[None], *sides)[0] - stop_at

    if not margins(trajectory.t[0], start[:4]).min() > 0:
        raise InvalidInput("offset", "the robot cannot start there")
    forward_dynamics(design, start[:4], start[4:8], np.zeros(4))  # raises without inertia

    gains = controller.gains(model, trajectory.pose[0])
    derivative, torques = equations(design, model, gains, trajectory)
    most = _MOST_EVALUATIONS + _MOST_A_SECOND * trajectory.duration
    calls = count(1)

    def bounded(t: float, state: Array) -> Array:
        call = next(calls)
        if call % _CALLS_A_REPORT == 0:
            keep_on(progress, float((t - trajectory.t[0]) / trajectory.duration))
        if call > most:
            raise SimulationFailed(
                t, f"more than {most:,.0f} evaluations; lower gains or a wider transition of the "
                f"Coulomb friction would make it easier",
            )  # fmt: skip
        return derivative(t, state)

    def least_margin(t: float, state: Array) -> float:
        return float(margins(t, state[:4]).min())

    least_margin.terminal = True  # type: ignore[attr-defined]
    solution = solve_ivp(
        bounded, (trajectory.t[0], trajectory.t[-1]), start, method="DOP853",
        t_eval=trajectory.t, events=least_margin, rtol=tolerance, atol=0.01 * tolerance,
        max_step=_LONGEST_STEP,
    )  # fmt: skip
    t, states = solution.t, solution.y.T
    stopped = None
    if solution.status != 0:
        stopped, t, states = _end(solution, margins, check.windows)
    return Simulation(
        design, controller, trajectory, t, states[:, :4], states[:, 4:8], torques(t, states),
        trajectory.at(t), states[:, 8], states[:, 9], states[:, 10:].sum(axis=1), stopped,
        int(solution.nfev),
    )  # fmt: skip


def _end(
    solution: Any,
    margins: Callable[[float, Array], Array],
    windows: tuple[PassageWindow, ...] = (),
) -> tuple[PathEvent, Array, Array]:
    """Return why a solution stopped, with its times and states up to there."""
    t, states = solution.t, solution.y.T
    if solution.status == 1:
        end, state = solution.t_events[0][-1], solution.y_events[0][-1]
        if end > t[-1]:
            t, states = np.append(t, end), np.vstack([states, state])
    left = margins(float(t[-1]), states[-1, :4])
    if solution.status != 1 and left.min() > _NEAR:
        for window in windows:
            if window.begin <= t[-1] <= window.end:
                place = tuple(states[-1, :4].tolist())
                return (
                    PathEvent(float(t[-1]), Limit.SINGULAR, -1, 0.0, place, NO_AUTHORITY),
                    t,
                    states,
                )
        raise SimulationFailed(float(t[-1]), str(solution.message))
    return worst_event(t[-1], states[-1, :4], left), t, states
