"""Identification on the page: its logs and settings, its tasks, and what they find."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from paminsa_viz.explorer.state.outcome import TaskState
from paminsa_viz.explorer.state.settings import Settings, setting
from paminsa_viz.model import Design, InvalidInput

if TYPE_CHECKING:  # a page waits for none of it at its start
    from paminsa_viz.identification import Excitation, Log
    from paminsa_viz.identification.findings import Findings  # noqa: F401 - a type argument

EXPORT_RATE = 250.0
"""Samples a second of an exported excitation [1/s]."""


@dataclass(frozen=True)
class IdentifySettings(Settings):
    """What a person set: of the identification and, last, of the excitation that is searched.

    Attributes:
        delay, rotors, legs, constrain: As of `identification.IdentificationSettings`.
        gains: Torque of M1..M3 [N m/A] and force of M4 [N/A] for an ampere, as typed; empty for
            logs of torques.
        periods: How often an excitation is run.

    Raises:
        InvalidInput: If the gains are not four numbers.
    """

    cut_off: float = setting(
        10.0, "Cut-off [Hz]", "Where the filter halves; 8 to 12 Hz suits most logs",
        range=(1.0, 100.0), step=0.5,
    )  # fmt: skip
    delay: bool = setting(False, "Fit a delay", "Of the torques after the positions")
    rotors: bool = setting(
        False, "Rotors differ", "Fit how the rotors’ inertias of M1 to M3 differ"
    )
    legs: bool = setting(False, "Legs of their own", "Fit how the legs’ masses differ")
    constrain: bool = setting(
        False, "Hold the identity", "Of the masses, which only springs break"
    )  # fmt: skip
    split: bool = setting(
        False, "Split at gaps", "Instead of refusing a log with gaps or rows out of reach"
    )
    gains: str = setting(
        "", "Gains",
        "For logs of currents: N·m/A of M1 to M3 and N/A of M4; type them before the log is opened",
    )  # fmt: skip
    payload: float = setting(
        0.0, "Payload [kg]", "Of the log with payload; 0: not weighed", range=(0.0, 1e3), step=0.1
    )
    period: float = setting(
        10.0, "Period [s]", "After which the motion repeats itself", range=(1.0, 100.0)
    )
    harmonics: int = setting(
        5, "Harmonics", "Sines that each coordinate is made of; more tell more and are faster",
        range=(3, 20),
    )  # fmt: skip
    periods: int = setting(2, "Periods", range=(1, 1000))
    seconds: float = setting(
        60.0, "Search for [s]", "How long, at most; a longer search may find a better motion",
        range=(1.0, 600.0), step=5.0,
    )  # fmt: skip

    def __post_init__(self) -> None:
        super().__post_init__()
        parse_gains(self.gains)

    @property
    def of_log(self) -> IdentifySettings:
        """Those that an identification depends on, the others as they are at first."""
        start = IdentifySettings()
        return replace(
            self, period=start.period, harmonics=start.harmonics, periods=start.periods,
            seconds=start.seconds,
        )  # fmt: skip

    @property
    def of_excitation(self) -> IdentifySettings:
        """Those that the search for a motion depends on, the others as they are at first."""
        return IdentifySettings(
            period=self.period, harmonics=self.harmonics, periods=self.periods,
            seconds=self.seconds,
        )  # fmt: skip


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


@dataclass(frozen=True)
class IdentifyJob:
    """An identification with all it depends on."""

    design: Design
    log: Log
    other: Log | None
    loaded: Log | None
    settings: IdentifySettings


@dataclass(frozen=True)
class ExcitationJob:
    """A search for a motion with all it depends on."""

    design: Design
    settings: IdentifySettings


@dataclass(frozen=True)
class IdentificationState(TaskState[IdentifyJob, "Findings"]):
    """The identification of a session; settings outlive a result, logs are not saved.

    Attributes:
        settings: What a person set.
        log, other, loaded: The opened logs: to identify, to validate with, with a payload.
        actuator: Whose torque is drawn, 0 to 3.
        excitation: The search for a motion.
    """

    settings: IdentifySettings = field(default_factory=IdentifySettings)
    log: Log | None = None
    other: Log | None = None
    loaded: Log | None = None
    actuator: int = 0
    excitation: TaskState[ExcitationJob, Excitation] = TaskState()
