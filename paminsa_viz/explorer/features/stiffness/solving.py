"""Finds stiffness, modes and deflection of a pose."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from paminsa_viz.elastostatics.center_lines import center_lines
from paminsa_viz.elastostatics.drive_stiffness import drive_modes
from paminsa_viz.elastostatics.leg_matrices import leg_matrices
from paminsa_viz.elastostatics.stiffness import (
    compensate,
    platform_stiffness,
    strain_shares,
)
from paminsa_viz.elastostatics.vibration import SHARED, robot_modes, whole_matrices
from paminsa_viz.explorer.state.stiffness import MODES, ElasticJob, ElasticResult
from paminsa_viz.model import Limit, PaminsaError
from paminsa_viz.model.arrays import Array


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
    if modes.ok:
        shapes = replace(lines, moves=lines.moves[..., 1:])
        alone = drive_modes(design, pose).frequencies
        found = replace(
            found, frequencies=tuple(modes.frequencies.tolist()), alone=tuple(alone.tolist()),
            shapes=shapes,
        )  # fmt: skip
    return found
