"""Numbers that are pinned to the strip: which, and what they are where the robot is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.settings import Settings
from paminsa_viz.model import PARAMETER, Design
from paminsa_viz.model.arrays import Pose
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirements import Requirement

MOST_PINS = 6
"""Most numbers in the strip."""

IMBALANCE = "M_p2"
"""Key of the static imbalance, which is a number of the design alone and no parameter."""


def can_be_pinned(key: str) -> bool:
    """Whether a key is that of a quantity of the pose, or of a number of the design."""
    return key == IMBALANCE or key in QUANTITIES or key in PARAMETER


@dataclass(frozen=True)
class PinSettings(Settings):
    """What is pinned.

    Attributes:
        keys: Keys of `QUANTITIES`, paths of `PARAMETERS`, or `IMBALANCE`, in their order.
    """

    keys: tuple[str, ...] = ()

    @property
    def possible(self) -> bool:
        few = len(self.keys) <= MOST_PINS and len(set(self.keys)) == len(self.keys)
        return few and all(map(can_be_pinned, self.keys))


@dataclass(frozen=True)
class PinsJob:
    """What is pinned, with all its values depend on.

    Attributes:
        keys: What is pinned.
        design, reference: The robot as it is shown, and the pinned reference.
        pose: The last reachable pose [m, m, rad, m].
        bounds: Requirements on what is pinned.
    """

    keys: tuple[str, ...]
    design: Design
    reference: Design | None
    pose: Pose
    bounds: tuple[Requirement, ...] = ()


class PinValue(NamedTuple):
    """A pinned number [SI]; NaN where there is none.

    Attributes:
        value: Of the design.
        reference: Of the reference, at the same pose; NaN without one.
        reason: Why the design has none.
        margin: To the requirements on it, the least; NaN where there are none.
        bound: Size of the bound that the margin is to.
    """

    value: float
    reference: float
    reason: str
    margin: float
    bound: float


PinsOutcome = Outcome[PinsJob, tuple[PinValue, ...]]


@dataclass(frozen=True)
class PinsState:
    """Pins of a session.

    Attributes:
        settings: What is pinned.
        outcome: The values that were found last.
    """

    settings: PinSettings = field(default_factory=PinSettings)
    outcome: PinsOutcome | None = None
