"""From settings to the case of a search: ranges of lengths, which kinds of robots, how long."""

from __future__ import annotations

from paminsa_viz.explorer.state.settings import at_first
from paminsa_viz.explorer.state.synthesis import (
    BOTH,
    LARGER,
    SMALLER,
    EffortChoice,
    Range,
    SynthesisSettings,
)
from paminsa_viz.model import BarLaw, Design, InvalidInput
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.search.case import (
    DEFAULT_PATHS,
    DIMENSIONS,
    Effort,
    Regime,
    SearchRange,
    SynthesisCase,
)

_, WIDTH, TALL = DIMENSIONS
"""Paths of the workspace's sizes."""

EFFORTS: dict[EffortChoice, Effort] = {
    EffortChoice.QUICK: Effort(40, 8),
    EffortChoice.NORMAL: Effort(150, 12),
    EffortChoice.THOROUGH: Effort(400, 16),
}

KINDS: dict[str, tuple[Regime, ...]] = {
    BOTH: (Regime.SMALLER, Regime.LARGER),
    SMALLER: (Regime.SMALLER,),
    LARGER: (Regime.LARGER,),
}
"""Which of base and platform may be larger, by the setting."""

LEAST_MARGIN = LEAST_CLEARANCE = 0.001
"""Least distances to the limits of reach and of two bodies, where nothing else is required [m].

They are for about the prototype's lengths and bodies, and follow those of other robots.
"""

POSSIBLE = (1e-6, 0.1)
"""Ends of both [m]."""

LEAST, LARGEST = 1e-3, 100.0
"""Ends of what can be searched [m, or 1 of k]."""


def _possible(value: float) -> float:
    return min(max(round(value, 3), LEAST), LARGEST)


def default_ranges(design: Design, requirements: Requirements) -> dict[str, Range]:
    """Return ranges around a design, by path [SI]: half to twice its own lengths.

    With a workspace, those of its width and height as well.
    """
    held = {path: design.value(path) for path in DEFAULT_PATHS}
    found = {path: (_possible(0.5 * value), _possible(2.0 * value)) for path, value in held.items()}
    low, high = found["geometry.magnification"]
    found["geometry.magnification"] = max(low, 1.5), max(high, 3.0)
    workspace = requirements.workspace
    if workspace is not None:
        wide, _, tall = workspace.size
        found[WIDTH] = wide, 3.0 * wide
        found[TALL] = tall, tall
    return found


def ranges_of(
    settings: SynthesisSettings, design: Design, requirements: Requirements
) -> dict[str, Range]:
    """Return the ranges of a search, by path [SI]; of sizes where a volume is sought."""
    found = default_ranges(design, requirements)
    if "volume" not in (settings.objective, settings.against):
        found = {path: ends for path, ends in found.items() if path not in DIMENSIONS}
    return found | {path: ends for path, ends in settings.ranges if path in found}


def case_of(
    settings: SynthesisSettings, design: Design, requirements: Requirements
) -> SynthesisCase:
    """Return the case of a search.

    Raises:
        InvalidInput: If it is not possible; says what is missing.
    """
    if requirements.workspace is None:
        raise InvalidInput(
            "workspace", "a required workspace is needed; choose one in the section Requirements"
        )
    ranges = ranges_of(settings, design, requirements)
    held = {
        path: low for path, (low, high) in ranges.items() if low == high and path not in DIMENSIONS
    }
    ratio, scale = length_ratio(design.geometry), design.geometry.body_scale
    return SynthesisCase(
        requirements,
        tuple(SearchRange(path, *ends) for path, ends in ranges.items() if ends[0] != ends[1]),
        design.vary(dict(held)),
        objective=settings.objective,
        bars=BarLaw(grow=settings.tubes_grow, tubes=settings.tube_masses),
        allow_overlap=settings.allow_overlap,
        above_guides=settings.above_guides,
        clearance=at_first(LEAST_CLEARANCE, 1, scale, POSSIBLE),
        margin=at_first(LEAST_MARGIN, 1, ratio, POSSIBLE),
        regimes=KINDS[settings.regimes],
        seed=settings.seed,
        effort=EFFORTS[settings.effort],
        name=design.name,
    )
