"""The balance: the paper's, the settings of others, counterweights, the front, the sensitivity."""

from __future__ import annotations

from functools import partial
from typing import Any

from viser import Icon

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.maps import hold_range, toggle_difference
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.features.balance import charts
from paminsa_viz.explorer.features.balance import texts as text
from paminsa_viz.explorer.features.balance.counterweights import COUNTERWEIGHTS
from paminsa_viz.explorer.kit.chart import chart, chart_clicks
from paminsa_viz.explorer.kit.entries import (
    Answer,
    Button,
    ButtonGroup,
    Entry,
    Folder,
    Html,
)
from paminsa_viz.explorer.kit.inputs import Dropdown, Pair, Slider, attribute
from paminsa_viz.explorer.kit.robot_texts import gauge_html
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.task import STOP_HINT
from paminsa_viz.explorer.kit.text import note
from paminsa_viz.explorer.state.balance import (
    LARGEST_MASS,
    LONGEST_LEVER,
    SLOTS,
    BalanceKind,
    BalanceSettings,
    CounterweightSlot,
    FreeMasses,
    Goal,
)
from paminsa_viz.explorer.state.settings import MILLIMETERS, PERCENT, PLAIN
from paminsa_viz.explorer.state.state import State

_setting = SettingInputs("balance", "balance.settings", BalanceSettings, balancing.change_settings)


def _busy(state: State) -> bool:
    return state.balance.running is not None


def _idle(state: State) -> bool:
    return not _busy(state)


def _slot(name: str, bar: str, joint: int) -> Pair:
    """Return the input of a counterweight slot: longest lever and largest mass."""

    def read(state: State) -> tuple[float, float]:
        slot = getattr(state.balance.settings, name)
        return slot.max_lever, slot.max_mass

    def apply(state: State, value: tuple[float, float]) -> State:
        return balancing.change_settings(state, **{name: CounterweightSlot(*value)})

    return Pair(
        f"balance.{name}", f"{bar.upper()} past {joint}", read=read, apply=apply,
        range=((0.0, LONGEST_LEVER), (0.0, LARGEST_MASS)), units=(MILLIMETERS, PLAIN),
        hint=f"Counterweight on each leg, on {bar.upper()} beyond joint {joint}: longest lever, "
        "largest mass (0 for none)",
    )  # fmt: skip


def _frees_masses(state: State) -> bool:
    return state.balance.settings.movable is not FreeMasses.NONE


def _is_on_motion(state: State) -> bool:
    return not state.balance.settings.goal.static


SETTINGS = (
    _setting("goal", apply=balancing.choose_goal),
    Slider(
        "balance.motion_weight", "Weight of motion [%]", range=(0.0, 100.0), step=1.0, unit=PERCENT,
        hint="Against the static torques; each peak relative to its current value",
        visible=lambda state: state.balance.settings.goal is Goal.BOTH,
        **attribute("balance.settings.motion_weight", balancing.change_settings),
    ),
    _setting("exact"),
    Html(
        "balance.slots",
        content=note(
            "", "Counterweights past a joint: longest lever [mm], largest mass on each leg [kg]. "
            "Whether they hit another body is checked with the result.", muted=True,
        ),
    ),
    *(_slot(*slot) for slot in SLOTS),
    _setting("movable"),
    _setting("max_increase", visible=_frees_masses),
    _setting("max_decrease", visible=_frees_masses),
    _setting("max_added", visible=_is_on_motion),
    Html(
        "balance.unlimited", visible=_is_on_motion,
        content=note("", "Largest added mass of the whole robot; 0: no limit", muted=True),
    ),
    Button(
        "balance.optimize", "Optimize", visible=_idle,
        effect=partial(balancing.start, task=BalanceKind.OPTIMUM),
        hint="Finds the masses that balance the robot best, and makes them the design’s",
    ),
    Button(
        "balance.stop", "Stop", color="gray", visible=_busy,
        effect=balancing.OPTIMUM.stop, hint=STOP_HINT,
    ),
)  # fmt: skip


def _has_front(state: State) -> bool:
    return charts.shown_front(state) is not None


def _points(state: State) -> tuple[float, float]:
    return 0.0, float(max(len(state.balance.points), 1))


def _point(state: State) -> float:
    """Return the number of the point that is worked on, from 1; 0 for none."""
    chosen = balancing.chosen_point(state)
    return 0.0 if chosen is None else chosen + 1.0


def _choose_point(state: State, value: float) -> State:
    point = round(value)
    return balancing.choose_point(state, point - 1 if point else None)


def _click(state: State, data: Any) -> State:
    index = charts.clicked_point(data, state)
    return state if index is None else balancing.choose_point(state, index)


FRONT = (
    chart_clicks(charts.FRONT, "balance.point", _click),
    Html(
        "front.about", content=text.front_html, visible=lambda state: state.balance.front is None
    ),
    *balancing.FRONT.buttons(
        Button(
            "front.compute", "Compute the front",
            effect=partial(balancing.start, task=BalanceKind.FRONT),
            hint="Finds designs between the lowest peak at rest and the lowest in motion",
        ),
    ),
    Answer(
        "balance.front_answer", "Pareto front", found=lambda state: state.balance.front,
        entries=(
            Html("front.text", content=text.front_html),
            chart("front.chart", charts.shown_front, charts.front_figure, 0.82),
            Slider(
                "balance.point", "Point", range=_points, step=1.0, visible=_has_front,
                hint="Works on a point of the front; 0 is none of them: it goes back to the "
                "design before",
                read=_point, apply=_choose_point,
            ),
        ),
    ),
)  # fmt: skip

SENSITIVITY = (
    Html(
        "tornado.about", content=text.sensitivity_html,
        visible=lambda state: state.balance.tornado is None,
    ),
    _setting("variation"),
    *balancing.SENSITIVITY.buttons(
        Button(
            "tornado.compute", "Compute", visible=_idle,
            effect=partial(balancing.start, task=BalanceKind.SENSITIVITY),
            hint="Changes each mass and length by itself, and measures what the torques do",
        ),
    ),
    Answer(
        "balance.tornado_answer", "Sensitivity", found=lambda state: state.balance.tornado,
        entries=(
            Html("tornado.text", content=text.sensitivity_html),
            Dropdown(
                "balance.output", "Output",
                options={label: index for index, label in enumerate(charts.OUTPUT_LABELS)},
                hint="What the bars are the change of",
                **attribute("balance.output"),
            ),
            chart("tornado.chart", charts.shown_tornado, charts.tornado_figure, 1.15),
        ),
    ),
)  # fmt: skip

BALANCE: tuple[Entry, ...] = (
    balancing.OPTIMUM.worker,
    Html("balance.gauge", content=gauge_html),
    Button(
        "balance", "Balance as in the paper", icon=Icon.SCALE, effect=balancing.balance_now,
        disabled=_busy,
        hint="M_p2 = 0 (Eqs. 7–8) by masses of joints and links, with the least added mass",
    ),
    Answer(
        "balance.answer", "Balance", found=lambda state: state.balance.outcome, always=True,
        entries=(
            Html("balance.status", content=text.status_html),
            ButtonGroup(
                "balance.maps", "Maps",
                choices={
                    "Common range": hold_range,
                    "Difference": toggle_difference,
                    "Swap": actions.swap_reference,
                },
                visible=lambda state: state.document.reference is not None,
                hint="Common color range of design and reference; their difference; swap with "
                "reference",
            ),
            Html(
                "balance.details",
                content=lambda frame: text.details_html(frame.state.balance.outcome),
            ),
        ),
    ),
    Folder("balance.settings", "Optimization settings", entries=SETTINGS, open=False),
    Folder("balance.weights", "Counterweights of each leg", entries=COUNTERWEIGHTS),
)  # fmt: skip

FOLDERS: tuple[Entry, ...] = (
    Folder(
        "balance.front", "Pareto front: dynamic vs. static torque", entries=FRONT, open=False
    ),
    Folder("balance.tornado", "Sensitivity (tornado)", entries=SENSITIVITY, open=False),
)  # fmt: skip


def balance_entries(*folders: Folder) -> tuple[Entry, ...]:
    """Return the entries of the tab, with folders of other features among them."""
    return (*BALANCE, *folders, *FOLDERS)
