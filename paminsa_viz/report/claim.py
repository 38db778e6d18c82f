"""A number of the documentation, and how it is worked out again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from paminsa_viz.model.arrays import Array


@dataclass(frozen=True)
class Claim:
    """A number of the documentation and its check.

    Attributes:
        page: The page of the documentation.
        text: What it says.
        check: How it is worked out here.
        unit: Unit of the figure; empty for a ratio, a difference in parts, or several units.
        allowed: The figure that is allowed at most, or, with ``stated``, how far off it may be; in
            parts of each where several are stated.
        measure: Returns the figure, or those that are stated.
        stated: The figures that the page states; None where the claim is that it is about zero.
    """

    page: str
    text: str
    check: str
    unit: str
    allowed: float
    measure: Callable[[], float | Array]
    stated: float | tuple[float, ...] | None = None


@dataclass(frozen=True, eq=False)
class MeasuredClaim:
    """A claim with the figure that was just measured.

    Attributes:
        claim: The claim.
        value: The figure, or several; NaN where there is none.
    """

    claim: Claim
    value: float | Array

    @property
    def holds(self) -> bool:
        """Whether the claim holds."""
        aim = np.asarray(0.0 if self.claim.stated is None else self.claim.stated)
        allowed = self.claim.allowed * (np.abs(aim) if aim.ndim else 1.0)
        return bool((np.abs(self.value - aim) <= allowed).all())
