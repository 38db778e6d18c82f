"""Linear programs by HiGHS and conic ones by Clarabel, both with tolerances far below their own."""

from __future__ import annotations

from importlib import import_module
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from paminsa_viz.balancing.program import SolverFailed
from paminsa_viz.model.arrays import Array

REGULARIZATIONS = (1e-11, 1e-8, 1e-13)
"""Of Clarabel's linear systems; the next one where a program with hardly any interior needs it."""


class ConicProgram(NamedTuple):
    """minimize cost . x  with  rows x <= right, low <= x <= high, right - rows x in each cone."""

    cost: Array
    rows: Array
    right: Array
    low: Array
    high: Array
    cones: list[tuple[Array, Array]]


class ConicSolution(NamedTuple):
    """Unknowns, multipliers of the rows, and for each cone the u that weighs all but its first row.

    A cone that holds (t, v) gets u . v <= |u| t as its part of the Lagrangian.
    """

    x: Array
    multipliers: Array
    cone_multipliers: list[Array]


def solve_linear(p: ConicProgram) -> ConicSolution | None:
    """Solve a program without cones by HiGHS; None if it is infeasible.

    Raises:
        SolverFailed: If HiGHS fails for another reason.
    """
    from scipy.optimize import linprog  # slow to load

    tight = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    found: Any = None
    bounds = np.column_stack([p.low, p.high])
    for method, options in (("highs", tight), ("highs-ds", {}), ("highs-ipm", {})):
        found = linprog(p.cost, p.rows, p.right, bounds=bounds, method=method, options=options)
        if found.status == 2:
            return None
        if found.status == 0:
            return ConicSolution(found.x, -found.ineqlin.marginals, [])
    raise SolverFailed(str(found.message))


def solve_conic(p: ConicProgram) -> ConicSolution | None:
    """Solve a program by Clarabel; None if it is infeasible.

    Raises:
        SolverFailed: If Clarabel finds no solution at all.
    """
    from scipy import sparse  # slow to load

    clarabel: Any = import_module("clarabel")  # compiled, without types

    # fixed unknowns would leave no interior; the others in parts of their upper bounds
    free = p.low < p.high
    x = p.low.copy()
    unit = np.where(np.isfinite(p.high) & (p.high > 0), p.high, 1.0)[free]
    eye = np.eye(len(p.cost))
    below, above = free & np.isfinite(p.low), free & np.isfinite(p.high)
    blocks = [
        (p.rows, p.right), (eye[above], p.high[above]), (-eye[below], -p.low[below]), *p.cones
    ]  # fmt: skip
    matrix = np.vstack([rows for rows, _ in blocks])
    right = np.concatenate([side for _, side in blocks]) - matrix[:, ~free] @ x[~free]
    matrix = matrix[:, free] * unit
    # rows in parts of their largest coefficients, those of a cone alike
    size = np.abs(matrix).max(axis=1, initial=0.0)
    linear = len(p.rows) + int(above.sum() + below.sum())
    ends = np.cumsum([linear, *(len(side) for _, side in p.cones)]).tolist()
    for first, last in pairwise(ends):
        size[first:last] = size[first:last].max()
    size[size == 0.0] = 1.0
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-11
    settings.iterative_refinement_reltol = settings.iterative_refinement_abstol = 1e-15
    settings.iterative_refinement_max_iter = 30
    found: Any = None
    for settings.static_regularization_constant in REGULARIZATIONS:
        tried = clarabel.DefaultSolver(
            sparse.csc_matrix((len(unit), len(unit))), p.cost[free] * unit,
            sparse.csc_matrix(matrix / size[:, None]), right / size,
            [clarabel.NonnegativeConeT(linear),
             *(clarabel.SecondOrderConeT(len(side)) for _, side in p.cones)],
            settings,
        ).solve()  # fmt: skip
        if found is None or _residual(tried) < _residual(found):
            found = tried
        if str(tried.status) in ("Solved", "PrimalInfeasible"):
            found = tried
            break
    if "PrimalInfeasible" in str(found.status):
        return None
    x[free] = np.array(found.x) * unit
    multipliers = np.array(found.z) / size
    if not (np.isfinite(x).all() and np.isfinite(multipliers).all()):
        raise SolverFailed(f"Clarabel returned {found.status}")
    return ConicSolution(
        x, multipliers[: len(p.rows)], [-multipliers[a + 1 : b] for a, b in pairwise(ends)]
    )


def _residual(found: Any) -> float:
    gap = abs(found.obj_val - found.obj_val_dual) / max(1.0, abs(found.obj_val))
    residual = float(np.max([found.r_prim, found.r_dual, gap]))  # NaN where one of them is
    return residual if np.isfinite(residual) else np.inf
