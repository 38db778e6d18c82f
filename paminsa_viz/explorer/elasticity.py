"""Stiffness and vibration on the page: what a person set, and what is found."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from paminsa_viz.elastostatics.center_lines import CenterLines, center_lines
from paminsa_viz.elastostatics.leg_matrices import leg_matrices
from paminsa_viz.elastostatics.stiffness import (
    Compensation,
    PlatformStiffness,
    StrainShares,
    compensate,
    load_wrench,
    platform_stiffness,
    strain_shares,
)
from paminsa_viz.elastostatics.vibration import SHARED, robot_modes, whole_matrices
from paminsa_viz.explorer.motion.description import Pose
from paminsa_viz.explorer.settings import setting
from paminsa_viz.explorer.tasks import Outcome
from paminsa_viz.model import Design, Limit, PaminsaError
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.elastic import BARS

MODES = 6
"""Modes that are found."""

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
        shapes: Center lines with the displacements of the modes; None without frequencies.
        deflected: The same with that under the load case; None without a load.
        compensation: What the motors do to bring x, y, theta and z back; None without a load.
        shares: Strain energy of the parts under the load case; None without a load.
    """

    stiffness: PlatformStiffness
    twist: Array
    frequencies: tuple[float, ...] = ()
    shapes: CenterLines | None = None
    deflected: CenterLines | None = None
    compensation: Compensation | None = None
    shares: StrainShares | None = None


ElasticOutcome = Outcome[ElasticJob, ElasticResult]


@dataclass(frozen=True)
class ElasticView:
    """Stiffness and vibration of a session.

    Attributes:
        mode: Which mode is animated, from 0.
        case: Key of the load case.
        bar: Whose section values are edited.
        outcome: The last result.
    """

    mode: int = 0
    case: str = setting(
        "load", "Load case", "Deflection and strain energy are under this load",
        options={name: key for key, (name, _) in CASES.items()},
    )  # fmt: skip
    bar: str = setting("b4", "Bar", options={bar.upper(): bar for bar in BARS})
    outcome: ElasticOutcome | None = None

    @property
    def result(self) -> ElasticResult | None:
        """What was found last, or None."""
        return None if self.outcome is None else self.outcome.result


def analyze_elasticity(job: ElasticJob, _: object) -> ElasticResult:
    """Return stiffness, modes and deflection.

    Raises:
        PaminsaError: If the pose has none.
    """
    design, pose = job.design, np.array(job.pose)
    stiffness = platform_stiffness(design, pose)
    status = Limit(int(stiffness.status))
    if status is not Limit.OK:
        raise PaminsaError(status.explanation)
    matrices, wrench = leg_matrices(design), job.wrench
    found = ElasticResult(stiffness, stiffness.deflection(wrench))
    modes = robot_modes(design, pose, MODES)
    plain, _ = whole_matrices(matrices, pose, loaded=False)
    force = np.zeros((len(plain), 1))
    force[: SHARED - 1, 0] = wrench
    vectors: Array = np.concatenate(
        [np.linalg.solve(plain, force).astype(np.float64), modes.shapes], axis=1
    )
    lines = center_lines(matrices, pose, vectors)
    if wrench.any():
        found = replace(
            found,
            deflected=replace(lines, moves=lines.moves[..., :1]),
            compensation=compensate(design, pose, wrench),
            shares=strain_shares(design, pose, wrench),
        )
    if modes.stable:
        shapes = replace(lines, moves=lines.moves[..., 1:])
        found = replace(found, frequencies=tuple(modes.frequencies.tolist()), shapes=shapes)
    return found
