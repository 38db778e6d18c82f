"""Synthesize: ranges of lengths, objective, the search with its best robot so far, the result."""

from __future__ import annotations

from functools import partial
from typing import Any

from viser import Icon

from paminsa_viz.explorer.background import BackgroundJob, Report
from paminsa_viz.explorer.entries import Button, Custom, Folder, Html, Progress
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.inputs import (
    MILLIMETERS,
    PLAIN,
    Checkbox,
    Dropdown,
    Number,
    Pair,
    attribute,
)
from paminsa_viz.explorer.panels import synthesize_text as text
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.explorer.synthesis import actions
from paminsa_viz.explorer.synthesis.cases import REGIMES, TALL, WIDTH, ranges_of
from paminsa_viz.explorer.synthesis.jobs import (
    BestSoFar,
    EffortChoice,
    Range,
    Shown,
    SynthesisJob,
    SynthesisOutcome,
)
from paminsa_viz.explorer.synthesis.solving import search
from paminsa_viz.model import PARAMETER
from paminsa_viz.synthesis.case import DEFAULT_PATHS
from paminsa_viz.synthesis.objectives import OBJECTIVES
from paminsa_viz.units import symbol_text

LARGEST = 100.0
"""Largest length that can be typed [m]."""


def _setting(name: str) -> dict[str, Any]:
    return attribute(f"synthesizing.settings.{name}", actions.change_settings)


def _busy(state: State) -> bool:
    return state.synthesizing.running is not None


def _idle(state: State) -> bool:
    return state.synthesizing.running is None


def _sizes(state: State) -> bool:
    return state.synthesizing.settings.objective == "volume"


def _range(path: str, label: str, hint: str, *, size: bool = False) -> Pair:
    """Return the input of the range of a number that is searched."""
    plain = path in PARAMETER and not PARAMETER[path].unit
    unit = PLAIN if plain else MILLIMETERS

    def read(state: State) -> Range:
        document = state.document
        ranges = ranges_of(state.synthesizing.settings, document.design, document.requirements)
        return ranges.get(path, (0.1, 0.1))  # hidden without a workspace

    return Pair(
        f"synthesize.{path}", label if plain else f"{label} [mm]", units=(unit, unit),
        range=((1e-3, LARGEST),) * 2, step=0.1 if plain else 1.0, read=read,
        visible=_sizes if size else None,
        hint=f"{hint}: least and largest value; it is held where both are equal",
        apply=lambda state, ends: actions.set_range(state, path, ends),
    )  # fmt: skip


RANGES = (
    *(
        _range(path, symbol_text(PARAMETER[path].symbol), PARAMETER[path].label)
        for path in DEFAULT_PATHS
    ),
    _range(WIDTH, "width", "Diameter of the workspace, or its extent along x and y", size=True),
    _range(TALL, "height", "Height of the workspace", size=True),
    Dropdown(
        "synthesize.regimes", "Radii", options={label: label for label in REGIMES},
        hint="With R_pl < R_b there is a singular rotation, with R_pl > R_b there is none: two "
        "different kinds of robots, searched one after the other",
        **_setting("regimes"),
    ),
    Checkbox(
        "synthesize.above", "Above the guides", hint="Whether joints 5 may be above the guides",
        **_setting("above_guides"),
    ),
)  # fmt: skip

SYNTHESIZE = (
    Html("synthesize.intro", content=text.intro_html),
    Dropdown(
        "synthesize.objective", "Objective",
        options={
            f"{'largest' if one.largest else 'least'} {one.label}": key
            for key, one in OBJECTIVES.items()
        },
        hint="What is minimized, or maximized", **_setting("objective"),
    ),
    Folder("synthesize.ranges", "Ranges", entries=RANGES),
    Dropdown(
        "synthesize.effort", "Effort", options={one.value: one for one in EffortChoice},
        hint="How long to search; longer searches work in processes of their own",
        **_setting("effort"),
    ),
    Number(
        "synthesize.seed", "Seed", range=(0.0, 1e6), step=1.0,
        hint="The same seed gives the same result",
        read=lambda state: float(state.synthesizing.settings.seed),
        apply=lambda state, value: actions.change_settings(state, seed=round(value)),
    ),
    Dropdown(
        "synthesize.shown", "Best so far", options={one.value: one for one in Shown},
        hint="How the best robot so far is shown while the search runs", **_setting("shown"),
    ),
    Button(
        "synthesize.start", "Search", icon=Icon.SEARCH, effect=actions.start, visible=_idle,
        undo=False, hint="Searches lengths that meet all requirements with the best objective",
    ),
    Progress(
        "synthesize.progress", visible=_busy,
        read=lambda state: 0.0 if (best := state.synthesizing.best) is None else best.done,
    ),
    Html("synthesize.best", content=text.best_html),
    Button(
        "synthesize.stop", "Stop", color="gray", effect=actions.stop, visible=_busy, undo=False
    ),
    Html("synthesize.result", content=text.result_html),
    Button(
        "synthesize.open", "Open as current design", icon=Icon.CHECK,
        visible=lambda state: text.has_robot(state),
        effect=actions.open_result,
        hint="The design that the search began with becomes the reference; undo goes back",
    ),
    Custom("synthesize.job", make=lambda session: Searcher(session)),
)  # fmt: skip


class Searcher:
    """Runs the searches of a session."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._job: BackgroundJob[SynthesisJob, SynthesisOutcome] = BackgroundJob(
            session, "synthesize", self._search, actions.receive,
            failed=lambda job, problem: SynthesisOutcome(job, problem=problem), undo=False,
        )  # fmt: skip

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Start the search that is wanted."""
        self._job.request(frame.state.synthesizing.running)

    def _search(self, job: SynthesisJob, report: Report) -> SynthesisOutcome:
        def tell(best: BestSoFar) -> None:
            action = partial(actions.tell, job=job, best=best)
            self._session.dispatch("synthesize.tell", action, step=False)

        return search(job, report, tell)
