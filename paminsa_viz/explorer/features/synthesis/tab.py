"""Synthesize: ranges of lengths, objective, the search with its best robot so far, the result."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from viser import Icon

from paminsa_viz.explorer.features.synthesis import actions
from paminsa_viz.explorer.features.synthesis import texts as text
from paminsa_viz.explorer.features.synthesis.cases import (
    LARGEST,
    LEAST,
    TALL,
    WIDTH,
    ranges_of,
)
from paminsa_viz.explorer.features.synthesis.charts import (
    DESIGN_FRONT,
    clicked_point,
    front_figure,
    shown_front,
)
from paminsa_viz.explorer.kit.chart import chart, chart_clicks
from paminsa_viz.explorer.kit.design_numbers import what
from paminsa_viz.explorer.kit.entries import Answer, Button, Folder, Html, Then
from paminsa_viz.explorer.kit.inputs import Pair, Slider
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.state.settings import MILLIMETERS, PLAIN
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.state.synthesis import Range, SynthesisSettings
from paminsa_viz.model import PARAMETER
from paminsa_viz.synthesis.search.case import DEFAULT_PATHS
from paminsa_viz.synthesis.search.objectives import OBJECTIVES
from paminsa_viz.units import symbol_text


def _ranges(state: State) -> dict[str, Range]:
    document = state.document
    return ranges_of(state.synthesis.settings, document.design, document.requirements)


def _points(state: State) -> tuple[float, float]:
    front = state.synthesis.front
    return 1.0, float(max(0 if front is None else len(front.points), 2))


def _range(path: str, label: str, hint: str, *, size: bool = False) -> Pair:
    """Return the input of the range of a number that is searched."""
    plain = path in PARAMETER and not PARAMETER[path].unit
    unit = PLAIN if plain else MILLIMETERS

    def read(state: State) -> Range:
        return _ranges(state).get(path, (0.1, 0.1))  # hidden where it is not searched

    return Pair(
        f"synthesize.{path}", label if plain else f"{label} [mm]", units=(unit, unit),
        range=((LEAST, LARGEST), (LEAST, LARGEST)), step=0.1 if plain else 1.0, read=read,
        visible=(lambda state: path in _ranges(state)) if size else None, ordered=True,
        hint=f"{hint}: least and largest value; it is held where both are equal",
        apply=lambda state, ends: actions.set_range(state, path, ends),
    )  # fmt: skip


_setting = SettingInputs("synthesize", "synthesis.settings", SynthesisSettings)

RANGES = (
    *(
        _range(path, symbol_text(PARAMETER[path].symbol), what(PARAMETER[path]))
        for path in DEFAULT_PATHS
    ),
    _range(WIDTH, "Width", "Diameter of the workspace, or its extent along x and y", size=True),
    _range(TALL, "Height", "Height of the workspace", size=True),
    _setting("regimes"),
    _setting("above_guides"),
    _setting("allow_overlap"),
    _setting("tubes_grow"),
    _setting("tube_masses"),
)  # fmt: skip

_START, _PROGRESS, _STOP = actions.SEARCH.buttons(
    Button(
        "synthesize", "Search", icon=Icon.SEARCH, effect=actions.start, undo=False,
        hint="Searches lengths that meet all requirements with the best objective",
    ),
)  # fmt: skip


def _click(state: State, data: Any) -> State:
    index = clicked_point(data, state)
    return state if index is None else actions.choose_point(state, index)


SYNTHESIZE = (
    chart_clicks(DESIGN_FRONT, "synthesize.point", _click),
    Html("synthesize.intro", content=text.intro_html),
    _setting(
        "objective",
        options={
            f"{'largest' if one.largest else 'least'} {one.label}": key
            for key, one in OBJECTIVES.items()
        },
    ),
    _setting(
        "against", options={"nothing": "", **{one.label: key for key, one in OBJECTIVES.items()}}
    ),
    Folder("synthesize.ranges", "Ranges", entries=RANGES, open=False),
    *map(_setting, ("effort", "seed", "shown")),
    _START,
    _PROGRESS,
    Html("synthesize.best", content=text.best_html),
    replace(_STOP, effect=actions.stop, hint="Ends the search with the best robot so far"),
    Answer(
        "synthesize.answer", "Synthesis",
        found=lambda state: (
            None if actions.SEARCH.outcome(state) is None
            else (actions.SEARCH.outcome(state), actions.PRICES.outcome(state))
        ),
        entries=(
            Folder(
                "synthesize.front", visible=lambda state: shown_front(state) is not None,
                entries=(
                    chart("synthesize.chart", shown_front, front_figure, 0.82),
                    Slider(
                        "synthesize.point", "Point", range=_points, step=1.0, undo=False,
                        hint="A robot of the front; click one in the chart",
                        read=lambda state: 1.0 + state.synthesis.point,
                        apply=lambda state, value: actions.choose_point(state, round(value) - 1),
                    ),
                ),
            ),
            Button(
                "synthesize.open", "Open as current design", icon=Icon.CHECK,
                visible=text.has_robot,
                effect=Then(
                    actions.open_result,
                    lambda state: f"“{state.document.design.name}” is the design now, at the "
                    "middle of its workspace; the design that the search began with is the "
                    "reference. Undo goes back.",
                ),
                hint="The design that the search began with becomes the reference; undo goes back",
            ),
            Html("synthesize.result", content=text.result_html),
            *actions.PRICES.buttons(
                Button(
                    "synthesize.prices", "What requirements cost", color="gray", undo=False,
                    effect=actions.PRICES.start, visible=text.can_price,
                    hint="Searches again near the answer with each active requirement relaxed and "
                    "tightened",
                ),
            ),
            Html("synthesize.price_list", content=text.prices_html),
        ),
    ),
    actions.SEARCH.worker,
    actions.PRICES.worker,
)  # fmt: skip
