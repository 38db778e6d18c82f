"""Stiffness and vibration on the page: what a person set, and what is found."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from paminsa_viz.elastostatics.center_lines import CenterLines
from paminsa_viz.elastostatics.stiffness import (
    Compensation,
    PlatformStiffness,
    StrainShares,
    load_wrench,
)
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.settings import Settings, setting
from paminsa_viz.model import Design
from paminsa_viz.model.arrays import Array, Pose
from paminsa_viz.model.elastic import BARS

MODE_NODE = "/elastic/mode"
"""Scene name of the mode that is animated; the page draws less often while it is there."""

MODES = 6
"""How many of the lowest natural modes are solved."""

CASES: dict[str, tuple[str, tuple[float, ...]]] = {
    "load": ("payload and load", ()),
    "x": ("100 N along x", (100.0, 0, 0, 0, 0, 0)),
    "y": ("100 N along y", (0, 100.0, 0, 0, 0, 0)),
    "z": ("100 N along z", (0, 0, 100.0, 0, 0, 0)),
    "theta": ("10 N·m about z", (0, 0, 0, 0, 0, 10.0)),
    "tilt_x": ("10 N·m about x", (0, 0, 0, 10.0, 0, 0)),
    "tilt_y": ("10 N·m about y", (0, 0, 0, 0, 10.0, 0)),
}
"""Load cases: their names, and wrenches at P [N, N m]; the first one is the design's."""


@dataclass(frozen=True)
class ElasticJob:
    """Stiffness and modes of a design at a pose.

    Attributes:
        design: With the geometry that the robot is shown with.
        pose: The last reachable pose [m, m, rad, m].
        case: Key of the load case.
    """

    design: Design
    pose: Pose
    case: str

    @property
    def wrench(self) -> Array:
        """Wrench of the load case at P, (6,) [N, N m]."""
        if self.case == "load":
            return load_wrench(self.design, np.array(self.pose))
        return np.array(CASES[self.case][1], float)


@dataclass(frozen=True, eq=False)
class ElasticResult:
    """Stiffness, modes and deflection.

    Attributes:
        stiffness: At the pose.
        twist: Of the platform under the load case, (6,) [m, rad].
        frequencies: Natural frequencies, lowest first [Hz]; none where weight and load push the
            platform away.
        alone: The same of the platform on its drives, with rigid bars.
        shapes: Center lines with the displacements of the modes; None without frequencies.
        deflected: The same with that under the load case; None without a load.
        compensation: What the motors do to bring x, y, theta and z back; None without a load.
        shares: Strain energy of the parts under the load case; None without a load.
    """

    stiffness: PlatformStiffness
    twist: Array
    frequencies: tuple[float, ...] = ()
    alone: tuple[float, ...] = ()
    shapes: CenterLines | None = None
    deflected: CenterLines | None = None
    compensation: Compensation | None = None
    shares: StrainShares | None = None


ElasticOutcome = Outcome[ElasticJob, ElasticResult]


@dataclass(frozen=True)
class StiffnessSettings(Settings):
    """What a person set.

    Attributes:
        mode: Which mode is animated, from 0.
        case: Key of the load case.
        bar: Whose section values are edited.
    """

    mode: int = setting(
        0, "Mode", "Natural frequency of the animated mode",
        options={f"{i + 1}": i for i in range(MODES)},
    )  # fmt: skip
    case: str = setting(
        "load", "Load case", "Deflection and strain energy are under this load",
        options={name: key for key, (name, _) in CASES.items()},
    )  # fmt: skip
    bar: str = setting(
        "b4", "Bar", "Whose section is given below, of all legs",
        options={bar.upper(): bar for bar in BARS},
    )  # fmt: skip


@dataclass(frozen=True)
class StiffnessState:
    """Stiffness and vibration of a session.

    Attributes:
        settings: What a person set.
        outcome: The last result.
    """

    settings: StiffnessSettings = field(default_factory=StiffnessSettings)
    outcome: ElasticOutcome | None = None

    @property
    def result(self) -> ElasticResult | None:
        """What was found last, or None."""
        return None if self.outcome is None else self.outcome.result
