"""What a figure over time is made of: one analyzed trajectory, and what stands beside it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.model.errors import InvalidInput
from paminsa_viz.plots.caption import shown
from paminsa_viz.plots.map_data import Provenance, provenance
from paminsa_viz.trajectory.analysis import TrajectoryAnalysis
from paminsa_viz.trajectory.simulation import Simulation


@dataclass(frozen=True, eq=False)
class OtherTorques:
    """Torques from elsewhere, such as a physics engine, at the samples of the trajectory.

    Attributes:
        name: What they are from, for the legend.
        torque: (n, 4) [N m, N m, N m, N]; NaN where there is none.
    """

    name: str
    torque: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sources:
    """What a figure is made of.

    Attributes:
        analysis: The design on the trajectory.
        reference: Another design on the same trajectory.
        printed: The design by the formulae as printed.
        simulation: The robot driven along the trajectory.
        engine: Torques from elsewhere.

    Raises:
        InvalidInput: If they are not of the same motion.
    """

    analysis: TrajectoryAnalysis
    reference: TrajectoryAnalysis | None = None
    printed: TrajectoryAnalysis | None = None
    simulation: Simulation | None = None
    engine: OtherTorques | None = None

    def __post_init__(self) -> None:
        motion = self.analysis.trajectory
        for name in ("reference", "printed"):
            beside = getattr(self, name)
            if beside is None or beside.trajectory is motion:
                continue
            same = np.array_equal(beside.trajectory.t, motion.t) and np.array_equal(
                beside.trajectory.pose, motion.pose
            )
            if not same:
                raise InvalidInput(name, "it has to be an analysis of the same trajectory")
        if self.engine is not None and self.engine.torque.shape != (motion.size, 4):
            shape = self.engine.torque.shape
            raise InvalidInput("engine", f"torques ({motion.size}, 4) are needed, not {shape}")
        if self.simulation is not None:
            start, end = self.simulation.t[0], self.simulation.t[-1]
            if start != motion.t[0] or end > motion.t[-1]:
                raise InvalidInput("simulation", "it has to be one of the same trajectory")

    @cached_property
    def provenance(self) -> Provenance:
        """Where the numbers come from."""
        return provenance(self.analysis.design)

    @cached_property
    def time(self) -> NDArray[np.float64]:
        """Instants of the simulation, and of the trajectory after it stopped (n,) [s]."""
        t = self.analysis.trajectory.t
        if self.simulation is None:
            return t
        return np.concatenate([self.simulation.t, t[t > self.simulation.t[-1]]])

    @property
    def other(self) -> tuple[str, NDArray[np.float64]]:
        """Name and torques (n, 4) of what the analysis is compared with.

        That is the engine if there is one, else the printed formulae, else the reference.

        Raises:
            InvalidInput: If there is nothing.
        """
        if self.engine is not None:
            return self.engine.name, self.engine.torque
        if self.printed is not None:
            return "formulae as printed", self.printed.torque
        if self.reference is not None:
            return f"reference {shown(self.reference.design.name)}", self.reference.torque
        raise InvalidInput(
            "engine", "a comparison needs an engine's torques, printed formulae or a reference"
        )
