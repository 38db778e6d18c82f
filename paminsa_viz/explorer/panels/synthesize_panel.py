"""Synthesize: ranges of lengths, objective, the search with its best robot so far, the result."""

from __future__ import annotations

from functools import partial
from typing import Any

from viser import Icon

from paminsa_viz.explorer.background import BackgroundJob, Report
from paminsa_viz.explorer.bindings import Panel
from paminsa_viz.explorer.browser.bridge import Bridge
from paminsa_viz.explorer.entries import Button, Custom, Folder, Html, Progress
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.inputs import (
    MILLIMETERS,
    PLAIN,
    Checkbox,
    Dropdown,
    Number,
    Pair,
    Slider,
    attribute,
)
from paminsa_viz.explorer.panels import synthesize_text as text
from paminsa_viz.explorer.panels.balance_charts import BalanceChart
from paminsa_viz.explorer.panels.design_front import (
    DESIGN_FRONT,
    clicked_point,
    front_figure,
    front_key,
)
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.explorer.synthesis import actions
from paminsa_viz.explorer.synthesis.cases import REGIMES, TALL, WIDTH, ranges_of
from paminsa_viz.explorer.synthesis.jobs import (
    BestSoFar,
    EffortChoice,
    PriceJob,
    PriceOutcome,
    Range,
    Shown,
    SynthesisJob,
    SynthesisOutcome,
)
from paminsa_viz.explorer.synthesis.solving import find_prices, search
from paminsa_viz.model import PARAMETER
from paminsa_viz.synthesis.search.case import DEFAULT_PATHS
from paminsa_viz.synthesis.search.objectives import OBJECTIVES
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


def _pricing(state: State) -> bool:
    return state.synthesizing.pricing is not None


def _points(state: State) -> tuple[float, float]:
    outcome = state.synthesizing.outcome
    count = 0 if outcome is None or outcome.front is None else len(outcome.front.points)
    return 1.0, float(max(count, 2))


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
        range=((1e-3, LARGEST), (1e-3, LARGEST)), step=0.1 if plain else 1.0, read=read,
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
    Dropdown(
        "synthesize.against", "Against",
        options={"nothing": "", **{one.label: key for key, one in OBJECTIVES.items()}},
        hint="A second objective, for a Pareto front of robots; takes as many searches as it has "
        "points",
        **_setting("against"),
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
    Folder(
        "synthesize.front", visible=lambda state: front_key(state) is not None,
        entries=(
            Custom(
                "synthesize.chart",
                make=partial(BalanceChart, key=front_key, figure=front_figure, aspect=0.82),
            ),
            Slider(
                "synthesize.point", "Point", range=_points, step=1.0, undo=False,
                hint="A robot of the front; click one in the chart",
                read=lambda state: 1.0 + state.synthesizing.point,
                apply=lambda state, value: actions.choose_point(state, round(value) - 1),
            ),
        ),
    ),
    Html("synthesize.result", content=text.result_html),
    Button(
        "synthesize.open", "Open as current design", icon=Icon.CHECK,
        visible=lambda state: text.has_robot(state),
        effect=actions.open_result,
        hint="The design that the search began with becomes the reference; undo goes back",
    ),
    Button(
        "synthesize.prices", "What requirements cost", color="gray", effect=actions.start_prices,
        visible=lambda state: text.has_robot(state) and state.synthesizing.pricing is None,
        undo=False, hint="Searches again near the answer with each active requirement relaxed and "
        "tightened",
    ),
    Progress(
        "synthesize.priced", visible=_pricing, read=lambda state: state.synthesizing.priced
    ),
    Button(
        "synthesize.stop_prices", "Stop", color="gray", effect=actions.stop_prices,
        visible=_pricing, undo=False,
    ),
    Html("synthesize.price_list", content=text.prices_html),
    Custom("synthesize.job", make=lambda session: Searcher(session)),
)  # fmt: skip


class SynthesizePanel(Panel):
    """The entries above, and clicks on the front."""

    def __init__(self, session: Session, bridge: Bridge) -> None:
        super().__init__(session, SYNTHESIZE)
        bridge.on("click", self._click)

    def _click(self, data: Any) -> None:
        """Show the robot of the front that was clicked; ``data`` comes from the page."""

        def choose(state: State) -> State:
            index = clicked_point(data, state)
            return state if index is None else actions.choose_point(state, index)

        if isinstance(data, dict) and data.get("title") == DESIGN_FRONT:
            self._session.dispatch("synthesize.point", choose, step=False)


class Searcher:
    """Runs the searches of a session."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._job: BackgroundJob[SynthesisJob, SynthesisOutcome] = BackgroundJob(
            session, "synthesize", self._search, actions.receive,
            failed=lambda job, problem: SynthesisOutcome(job, problem=problem), undo=False,
        )  # fmt: skip

        self._prices: BackgroundJob[PriceJob, PriceOutcome] = BackgroundJob(
            session, "prices", find_prices, actions.receive_prices,
            failed=lambda job, problem: PriceOutcome(job, problem=problem),
            progress=actions.report_prices, undo=False,
        )  # fmt: skip

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Start the search that is wanted."""
        self._job.request(frame.state.synthesizing.running)
        self._prices.request(frame.state.synthesizing.pricing)

    def _search(self, job: SynthesisJob, report: Report) -> SynthesisOutcome:
        def tell(best: BestSoFar) -> None:
            action = partial(actions.tell, job=job, best=best)
            self._session.dispatch("synthesize.tell", action, step=False)

        return search(job, report, tell)
