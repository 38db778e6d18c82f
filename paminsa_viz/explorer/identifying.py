"""Identification on the page: its logs and settings, its jobs, and what came of them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any

from paminsa_viz.actuation import actuator_limits
from paminsa_viz.model import Design, InvalidInput, PaminsaError

if TYPE_CHECKING:  # a page waits for none of it at its start
    from paminsa_viz.explorer.background import Report
    from paminsa_viz.identification import Excitation, Log
    from paminsa_viz.identification.findings import Findings

CUT_OFFS = (1.0, 100.0)
"""Lowest and highest cut-off [Hz]."""

PERIODS = (1.0, 100.0)
"""Shortest and longest period of an excitation [s]."""

SEARCH_TIMES = (1.0, 600.0)
"""Shortest and longest search [s]."""

MOST_PAYLOAD = 1e3
"""Largest payload of the third log [kg]."""

HARMONICS = (3, 20)
"""Fewest and most harmonics of an excitation."""

EXPORT_RATE = 250.0
"""Samples a second of an exported excitation [1/s]."""


@dataclass(frozen=True)
class IdentifySettings:
    """What a person set.

    Attributes:
        cut_off: Where the filter halves [Hz].
        delay, rotors, legs, constrain: As of `identification.IdentificationSettings`.
        split: Whether gaps and rows that cannot be used split a log instead of refusing it.
        gains: Torque of M1..M3 [N m/A] and force of M4 [N/A] for an ampere, as typed; empty for
            logs of torques.
        payload: Payload of the third log [kg]; 0 if it was not weighed.
        period: Of the excitation [s].
        harmonics: Of each coordinate.
        periods: How often it is run.
        seconds: Time for the search [s].
    """

    cut_off: float = 10.0
    delay: bool = False
    rotors: bool = False
    legs: bool = False
    constrain: bool = False
    split: bool = False
    gains: str = ""
    payload: float = 0.0
    period: float = 10.0
    harmonics: int = 5
    periods: int = 2
    seconds: float = 60.0

    @property
    def gain_values(self) -> tuple[float, ...] | None:
        """The gains, or None.

        Raises:
            InvalidInput: If they are not four numbers.
        """
        return parse_gains(self.gains)


def parse_gains(text: str) -> tuple[float, ...] | None:
    """Return four gains of a text, None if it is empty.

    Raises:
        InvalidInput: If they are not four numbers.
    """
    words = text.replace(",", " ").replace(";", " ").split()
    if not words:
        return None
    problem = "four numbers are needed, N·m/A of M1 to M3 and N/A of M4, or nothing"
    try:
        found = tuple(float(word) for word in words)
    except ValueError:
        raise InvalidInput("gains", problem) from None
    if len(found) != 4 or not all(0 < abs(value) < 1e6 for value in found):
        raise InvalidInput("gains", problem)
    return found


_RANGES = {
    "cut_off": CUT_OFFS, "payload": (0.0, MOST_PAYLOAD), "period": PERIODS, "seconds": SEARCH_TIMES,
    "harmonics": HARMONICS, "periods": (1, 1000),
}  # fmt: skip


def settings_data(settings: IdentifySettings) -> dict[str, Any]:
    """Return the settings that are not the default, as plain data."""
    values = {item.name: getattr(settings, item.name) for item in fields(IdentifySettings)}
    return {
        item.name: values[item.name]
        for item in fields(IdentifySettings)
        if values[item.name] != item.default
    }


def settings_from_data(data: dict[str, Any]) -> IdentifySettings:
    """Read what `settings_data` returned.

    Raises:
        InvalidInput: If a name is unknown or a value not possible.
    """
    default = IdentifySettings()
    for name, value in data.items():
        expected = type(getattr(default, name, None))
        number = expected in (int, float) and type(value) in (int, float)
        if not (number or (type(value) is expected and expected in (bool, str))):
            raise InvalidInput("saved state", f"the identification has no such {name[:20]!r}")
        low, high = _RANGES.get(name, (-math.inf, math.inf))
        if number and not (low <= value <= high and (expected is float or value == int(value))):
            raise InvalidInput("saved state", f"{name}: {low:g} to {high:g} is possible")
    parse_gains(str(data.get("gains", "")))
    return replace(default, **data)


@dataclass(frozen=True, eq=False)
class IdentifyJob:
    """An identification with all it depends on."""

    design: Design
    log: Log
    other: Log | None
    loaded: Log | None
    settings: IdentifySettings


@dataclass(frozen=True, eq=False)
class IdentifyOutcome:
    """What came of one: the findings, or the problem."""

    job: IdentifyJob
    findings: Findings | None
    problem: str = ""


@dataclass(frozen=True, eq=False)
class ExcitationJob:
    """A search for a motion with all it depends on."""

    design: Design
    settings: IdentifySettings


@dataclass(frozen=True, eq=False)
class ExcitationOutcome:
    """What came of one: the motion, or the problem."""

    job: ExcitationJob
    excitation: Excitation | None
    problem: str = ""


@dataclass(frozen=True)
class Identifying:
    """The identification of a session; settings outlive a result, logs are not saved.

    Attributes:
        settings: What a person set.
        log, other, loaded: The opened logs: to identify, to validate with, with a payload.
        running, outcome: The identification that runs, and the last one.
        actuator: Whose torque is drawn, 0 to 3.
        searching, done: The search for a motion that runs, and what part of it is done.
        excited: What came of the last search.
    """

    settings: IdentifySettings = field(default_factory=IdentifySettings)
    log: Log | None = None
    other: Log | None = None
    loaded: Log | None = None
    running: IdentifyJob | None = None
    outcome: IdentifyOutcome | None = None
    actuator: int = 0
    searching: ExcitationJob | None = None
    done: float = 0.0
    excited: ExcitationOutcome | None = None

    @property
    def findings(self) -> Findings | None:
        """What the last identification found."""
        return None if self.outcome is None else self.outcome.findings

    def stale(self, design: Design) -> bool:
        """Whether design, logs or settings have changed since the last identification."""
        outcome = self.outcome
        if outcome is None:
            return False
        job = outcome.job
        same = job.log is self.log and job.other is self.other and job.loaded is self.loaded
        fit: dict[str, Any] = {
            name: getattr(self.settings, name) for name in ("period", "harmonics", "periods")
        }
        compared = replace(job.settings, seconds=self.settings.seconds, **fit)
        return not (same and compared == self.settings and job.design == design)


def identify_logs(job: IdentifyJob, report: Report) -> IdentifyOutcome:
    """Identify; raises nothing that is a log's fault."""
    from paminsa_viz.identification import IdentificationSettings
    from paminsa_viz.identification.findings import Stopped, investigate

    own = job.settings
    try:
        settings = IdentificationSettings(
            cut_off=own.cut_off, delay=own.delay, rotors=own.rotors, legs=own.legs,
            constrain=own.constrain,
        )  # fmt: skip
        found = investigate(
            job.log, job.design, settings, other=job.other, loaded=job.loaded,
            payload=own.payload or None, report=report,
        )  # fmt: skip
    except Stopped:
        return IdentifyOutcome(job, None, "it was stopped")
    except PaminsaError as error:
        return IdentifyOutcome(job, None, str(error))
    return IdentifyOutcome(job, found)


def search_excitation(job: ExcitationJob, report: Report) -> ExcitationOutcome:
    """Search for a motion; raises nothing that is the robot's fault."""
    from paminsa_viz.identification import (
        ExcitationLimits,
        ExcitationSettings,
        optimize_excitation,
    )

    own, limits = job.settings, actuator_limits(job.design)
    try:
        settings = ExcitationSettings(
            period=own.period, harmonics=own.harmonics, periods=own.periods, seconds=own.seconds,
            evaluations=1_000_000,
        )  # fmt: skip
        kept = ExcitationLimits(limits.speed, limits.rated)
        found = optimize_excitation(job.design, kept, settings, report=report)
    except PaminsaError as error:
        return ExcitationOutcome(job, None, str(error))
    return ExcitationOutcome(job, found)
