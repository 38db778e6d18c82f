"""What a synthesis can minimize: one registry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.statics import BODIES
from paminsa_viz.quantities.requirements import Workspace
from paminsa_viz.synthesis.masses.program import InnerSolution
from paminsa_viz.units import DisplayUnit, display_unit


class Trial(Protocol):
    """What objectives read of a robot that reaches its workspace.

    Attributes:
        reference: The robot that the search starts from.
        workspace: Its workspace, at its height.
        masses: In the order of `lumped.MASS_PATHS` (28,) [kg, kg m^2].
        inner: The best masses and springs, where some are free.
        footprint: Radius about z that it sweeps [m].
        static_torque: Largest static torque of M1 to M3 over the workspace [N m].
    """

    @property
    def reference(self) -> Design: ...
    @property
    def workspace(self) -> Workspace: ...
    @property
    def masses(self) -> Array: ...
    @property
    def inner(self) -> InnerSolution | None: ...
    @property
    def footprint(self) -> float: ...
    @property
    def static_torque(self) -> float: ...


@dataclass(frozen=True)
class Objective:
    """A number of a robot and its workspace that is minimized or limited.

    Attributes:
        key: Name in Python, in case files and on the command line.
        label: Name in choices.
        title: What it is.
        unit: SI unit.
        value: ``value(trial)`` of a robot that meets the requirements [SI].
        largest: Whether it is maximized instead.
    """

    key: str
    label: str
    title: str
    unit: str
    value: Callable[[Trial], float]
    largest: bool = False

    @property
    def display(self) -> DisplayUnit:
        """The unit for display."""
        return display_unit(self.unit)

    @property
    def sign(self) -> float:
        """-1 where it is maximized."""
        return -1.0 if self.largest else 1.0


_LEG_MASSES = [MASS_PATHS.index(path) for path in BODIES]
_PLATFORM = MASS_PATHS.index("platform.mass")


def legs_and_platform(masses: Array, owner: Design) -> float:
    """Return the mass of the platform and of all legs with their counterweights [kg].

    Args:
        masses: In the order of `lumped.MASS_PATHS` (28,).
        owner: The design that has the counterweights.
    """
    weights = sum(weight.mass for weight in owner.counterweights)
    return 3 * (float(masses[_LEG_MASSES].sum()) + weights) + float(masses[_PLATFORM])


def _moving_mass(trial: Trial) -> float:
    owner = trial.reference if trial.inner is None else trial.inner.design
    return legs_and_platform(trial.masses, owner)


def _of_motions(trial: Trial, key: str) -> float:
    assert trial.inner is not None  # see `masses.case.check_inner`
    return trial.inner.value(key)


def _volume(trial: Trial) -> float:
    x, y, z = trial.workspace.size
    return x * y * z * trial.workspace.shape.section.fill


OBJECTIVES: dict[str, Objective] = {
    item.key: item
    for item in (
        Objective(
            "footprint", "footprint radius",
            "Radius R_f about z swept by joints 5, 8, 9 and the guides’ ends over the workspace",
            "m",
            lambda trial: trial.footprint,
        ),
        Objective(
            "moving_mass", "moving mass",
            "Mass of the platform and of all legs with their counterweights", "kg", _moving_mass,
        ),
        Objective(
            "static_torque", "peak static torque",
            "Largest static torque of M1 to M3 over the workspace; zero where M_p2 is", "N m",
            lambda trial: trial.static_torque,
        ),
        Objective(
            "peak_torque", "peak torque on motions",
            "Largest torque of M1 to M3 on the motions", "N m",
            lambda trial: _of_motions(trial, "peak_torque"),
        ),
        Objective(
            "energy", "energy of motions",
            "Energy that the actuators put in on the motions; braking gives none back", "J",
            lambda trial: _of_motions(trial, "energy"),
        ),
        Objective(
            "volume", "volume of the workspace",
            "Volume of the workspace, whose width or height is searched", "m^3", _volume,
            largest=True,
        ),
    )
}  # fmt: skip
"""Every objective by its key, in the order of choices."""


@kinds_checked
def find_objective(key: str) -> Objective:
    """Return an objective.

    Raises:
        InvalidInput: If there is none of this key; names the known ones.
    """
    if key not in OBJECTIVES:
        raise InvalidInput("objective", f"{', '.join(OBJECTIVES)} are known, not {key!r}")
    return OBJECTIVES[key]
