"""Weighted least squares, with intervals of a block jackknife.

Filtered residuals are correlated, and so is what a model leaves out; ordinary least squares then
states intervals much too narrow. The jackknife leaves out one block of half a second at a time: the
spread of what is found without it needs no model of the noise. Only normal equations are kept, one
for each block and actuator, so that leaving one out is a subtraction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.errors import InvalidInput
from paminsa_viz.identification.log import InvalidLog
from paminsa_viz.model.arrays import Array
from paminsa_viz.units import counted

CONFIDENCE = 0.95
"""Coverage of the intervals."""

FEWEST_BLOCKS = 5
"""Fewest blocks for an interval."""

SMALLEST_EIGENVALUE = 1e-11
"""Smallest eigenvalue of the scaled normal matrix that counts as excited, over the largest."""

LOST = 1e-4
"""Share of a number that may lie in directions which the motion does not excite."""

RESOLUTION = 1e-9
"""Least noise of an actuator, over the largest RMS of all of them."""

BLOCKS_AT_ONCE = 64
"""Blocks whose rows are copied at once: those of a long log fill the memory."""

ITERATIONS = 3
"""How often the actuators' noise is estimated again; the weights are those of the last but one."""


class NormalBlocks(NamedTuple):
    """Normal equations of B blocks, the four actuators apart, for n unknowns.

    Attributes:
        matrix: (B, 4, n, n).
        right: (B, 4, n).
        square: (B, 4) sums of the squared torques.
        samples: (B,) numbers of samples.
    """

    matrix: Array
    right: Array
    square: Array
    samples: Array

    def weighted(self, weight: Array) -> tuple[Array, Array]:
        """Return matrices (B, n, n) and right sides (B, n) with the actuators weighed by (4,)."""
        matrix = np.einsum("j,bjac->bac", weight, self.matrix)
        return matrix, np.einsum("j,bja->ba", weight, self.right)


def half_widths(blocks: int) -> float:
    """Return the half width of an interval over its standard error: Student's t for B - 1."""
    from scipy.stats import t  # takes a while to load

    return float(t.ppf(0.5 + 0.5 * CONFIDENCE, blocks - 1))


def jackknife(without: Array) -> Array:
    """Return standard errors (n,) from values (B, n) without each block."""
    count = len(without)
    spread = ((without - without.mean(axis=0)) ** 2).sum(axis=0)
    return np.asarray(np.sqrt((count - 1) / count * spread))


def block_numbers(
    t: Array, segment: NDArray[np.int64], length: float, log: str = ""
) -> NDArray[np.int64]:
    """Return the number of the block that each sample is in, (m,); blocks are equally long.

    What is left over at the end of a segment belongs to its last block. A refusal names the log.

    Raises:
        InvalidLog: If there are fewer than `FEWEST_BLOCKS`.
        InvalidInput: If a block is shorter than the time between samples.
    """
    found = np.empty(len(t), np.int64)
    following = 0
    for number in np.unique(segment):
        part = segment == number
        times = t[part] - t[part][0]
        step = float(times[1]) if len(times) > 1 else length
        if length < 0.999 * step:  # and not by rounding
            problem = f"at least {step:g} s, the time between filtered samples, is needed"
            raise InvalidInput("block", f"{problem}, not {length!r}; or a higher cut-off")
        count = max(1, int((times[-1] + step) / length + 1e-6))
        found[part] = following + np.minimum((times / length + 1e-9).astype(np.int64), count - 1)
        following += count
    if following < FEWEST_BLOCKS:
        size = f"of {length:g} s"
        left = counted(following, f"block {size} is", f"blocks {size} are")
        raise InvalidLog(
            f"{left} left after filtering, which takes the ends of every piece without gaps; "
            f"intervals need {FEWEST_BLOCKS}, and 20 s or more are advised, or a higher cut-off",
            log=log,
        )
    return found


def normal_blocks(
    columns: Array | Sequence[Array], torque: Array, numbers: NDArray[np.int64]
) -> NormalBlocks:
    """Return the normal equations of all blocks.

    Args:
        columns: (m, 4, n), or several such arrays, which are never put together as a whole.
        torque: (m, 4).
        numbers: (m,) increasing block numbers.
    """
    counts = np.bincount(numbers)
    ends = np.cumsum(counts)
    begins = ends - counts
    parts = [columns] if isinstance(columns, np.ndarray) else columns
    n = sum(part.shape[-1] for part in parts)
    whole = np.empty((len(counts), 4, n + 1, n + 1))
    for start in range(0, len(counts), BLOCKS_AT_ONCE):
        some = slice(start, start + BLOCKS_AT_ONCE)
        inside = slice(begins[some][0], ends[some][-1])
        block = numbers[inside]
        place = np.arange(inside.start, inside.stop) - begins[block]
        rows = np.zeros((len(counts[some]), 4, int(counts[some].max()), n + 1))
        rows[block - start, :, place, :n] = np.concatenate([part[inside] for part in parts], -1)
        rows[block - start, :, place, n] = torque[inside]
        whole[some] = rows.mT @ rows
    return NormalBlocks(
        whole[..., :n, :n], whole[..., :n, n], whole[..., n, n], counts.astype(np.float64)
    )


@dataclass(frozen=True, eq=False)
class FitSolution:
    """The fitted numbers x, and x without each block.

    Attributes:
        x: (n,) of the whole log; what is not excited is as small as possible.
        without: (B, n) without each block.
        noise: (4,) standard deviation of the residuals [N m, N].
        excited: (n, q) directions of x that the motion excites.
        hidden: (n, n - q) the others, scaled as the columns are.
        information: (n, n) weighted normal matrix.
    """

    x: Array
    without: Array
    noise: Array
    excited: Array
    hidden: Array
    information: Array

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return len(self.without)

    @property
    def quantile(self) -> float:
        """Half width of an interval over its standard error, see `half_widths`."""
        return half_widths(self.blocks)

    def deviation(self, rows: Array) -> Array:
        """Return the standard errors of rows x, (r,) for rows (r, n); of the jackknife."""
        return jackknife(self.without @ rows.T)

    def known(self, rows: Array) -> NDArray[np.bool_]:
        """Whether the motion excites all of rows x, (r,)."""
        hidden = np.linalg.norm(rows @ self.hidden, axis=1)
        return hidden <= LOST * np.linalg.norm(rows * unit_scale(self.information), axis=1)

    @cached_property
    def widening(self) -> float:
        """How much wider the jackknife's standard errors are than those of uncorrelated samples.

        One factor, the median over the excited directions: a jackknife of forty blocks has no
        covariance of twenty numbers.
        """
        inner = np.linalg.inv(self.excited.T @ self.information @ self.excited)
        spread = self.deviation(np.asarray(np.linalg.pinv(self.excited), np.float64))
        return float(np.median(spread / np.sqrt(np.diag(inner))))


def solve(blocks: NormalBlocks) -> FitSolution:
    """Solve the normal equations, weighted by each actuator's noise, whole and without each block.

    The noise is that of the residuals, estimated again `ITERATIONS` times.

    Raises:
        InvalidLog: If no column is excited at all.
    """
    square, count = blocks.square.sum(axis=0), float(blocks.samples.sum())
    # What no sensor resolves: a thousand-millionth of the largest torque or force.
    floor = RESOLUTION**2 * max(float(square.max()) / count, 1e-30)
    variance = np.maximum(square / count, floor)
    for _ in range(ITERATIONS - 1):
        x = _weighted(blocks, variance)[0]
        variance = np.maximum(_residual(blocks, x) / count, floor)
    x, excited, hidden, whole, force = _weighted(blocks, variance)
    noise = np.sqrt(np.maximum(_residual(blocks, x) / count, floor))
    parts, forces = blocks.weighted(1 / variance)
    left = excited.T @ (whole - parts) @ excited
    rest = ((force - forces) @ excited)[..., None]
    # what a single block tells is as small as possible without it: no inverse has it
    without = (np.linalg.pinv(left, hermitian=True) @ rest)[..., 0]
    return FitSolution(x, without @ excited.T, noise, excited, hidden, whole)


def _weighted(blocks: NormalBlocks, variance: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Return x, the excited and the hidden directions, and the weighted normal equations."""
    whole = np.einsum("j,bjac->ac", 1 / variance, blocks.matrix)
    force = np.einsum("j,bja->a", 1 / variance, blocks.right)
    excited, hidden = directions(whole)
    inner = np.linalg.solve(excited.T @ whole @ excited, excited.T @ force)
    return excited @ inner, excited, hidden, whole, force


def _residual(blocks: NormalBlocks, x: Array) -> Array:
    """Return the sums of the squared residuals, (4,)."""
    matrix, right = blocks.matrix.sum(axis=0), blocks.right.sum(axis=0)
    return blocks.square.sum(axis=0) - 2 * right @ x + np.einsum("a,jac,c->j", x, matrix, x)


def block_residuals(blocks: NormalBlocks, x: Array) -> Array:
    """Return the root mean squares of what numbers x (n,) leave in each block, (B, 4)."""
    left = np.einsum("a,bjac,c->bj", x, blocks.matrix, x) - 2 * blocks.right @ x + blocks.square
    return np.sqrt(np.maximum(left, 0.0) / blocks.samples[:, None])


def unit_scale(whole: Array) -> Array:
    """Return sizes (n,) of unknowns that make the diagonal of a normal matrix 1, or leave it 0."""
    diagonal = np.diag(whole)
    return 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))


def directions(whole: Array) -> tuple[Array, Array]:
    """Return the excited directions (n, q) of a normal matrix, and the hidden ones (n, n - q).

    Raises:
        InvalidLog: If none is excited.
    """
    scale = unit_scale(whole)
    values, vectors = np.linalg.eigh(whole * scale * scale[:, None])
    kept = values > SMALLEST_EIGENVALUE * values[-1]
    if not kept.any():
        raise InvalidLog("the robot does not move in this log; record a motion that excites it")
    return scale[:, None] * vectors[:, kept], scale[:, None] * vectors[:, ~kept]
