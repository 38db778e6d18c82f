"""From an analyzed motion to the curves that are plotted: two charts for each kind of plot."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.explorer.motion.checking import EngineTorques
from paminsa_viz.explorer.motion.plots import Plot, PlotView
from paminsa_viz.explorer.motion.store import Analyzed
from paminsa_viz.palette import ACTUATOR_COLORS, INK, MUTED
from paminsa_viz.plots.curves_model import PARTS
from paminsa_viz.trajectory import TrajectoryAnalysis
from paminsa_viz.units import power_of_ten

Values = NDArray[np.float64]

SOLID, DASHED, DOTTED = (), (6, 4), (2, 3)
"""Strokes: the present design, the reference, the formulae as printed."""

COORDINATE_COLORS = ("#0072B2", "#D55E00", INK, "#009E73")
"""Colors of x, y, theta, z."""

_DEGREES = 180 / np.pi

_SMALL = 1e-4
"""Errors up to this are shown in a thousandth of the unit [m, rad]."""

_PLAIN = 1e-2
"""Differences from here on are shown in the unit itself [N m, N]."""

MOST_MARKS = 50
"""About how many of an engine's torques are marked on a curve."""


@dataclass(frozen=True, eq=False)
class Trace:
    """One curve.

    Attributes:
        label: Its name in tables.
        values: (n,) as a person reads them; NaN where there is none.
        color: ``#rrggbb``.
        dash: Lengths of dash and gap [px]; empty for a full line.
        wide: Whether it is drawn stronger than others.
        marks: Whether its values are drawn as marks and not as a line; between them it has none.
    """

    label: str
    values: Values
    color: str
    dash: tuple[int, ...] = SOLID
    wide: bool = True
    marks: bool = False


@dataclass(frozen=True, eq=False)
class Chart:
    """Curves over one axis of time.

    Attributes:
        title: What is drawn, with its unit.
        unit: The unit.
        t: (n,) [s].
        traces: The curves.
        failing: (n,) where the motion fails.
        until: Samples before the first failure; numbers in tables are of these.
    """

    title: str
    unit: str
    t: Values
    traces: tuple[Trace, ...]
    failing: NDArray[np.bool_]
    until: int


def charts(view: PlotView, found: Analyzed) -> tuple[Chart, ...]:
    """Return the charts of a plot, one or two; none for a simulation that has not been run."""
    if view.plot in (Plot.TRACKING, Plot.DRIVEN):
        return _simulated(view.plot, found)
    if view.plot is Plot.PARTS:
        return (_parts(view.actuator, found),)
    if view.plot is Plot.ENERGY:
        return _energy(found)
    if view.plot in _OF_PLATFORM:
        return _of_platform(view.plot, found)
    if view.plot is Plot.DIFFERENCE:
        return _differences(found)
    drawn = _of_actuators(view.plot, found)
    return _marked(drawn, found) if view.needs_engine else drawn


def _chart(
    title: str,
    unit: str,
    traces: list[Trace],
    analysis: TrajectoryAnalysis,
    t: Values | None = None,
) -> Chart:
    check = analysis.check
    if t is None:
        return Chart(title, unit, analysis.trajectory.t, tuple(traces), ~check.good, check.until)
    none = np.zeros(t.size, dtype=bool)
    return Chart(title, unit, t, tuple(traces), none, t.size)


def _besides(
    found: Analyzed, pick: Callable[[TrajectoryAnalysis], Values], columns: tuple[int, ...]
) -> list[Trace]:
    """Return the curves of some actuators for the present design and what stands beside it."""
    traces = [Trace(f"M{j + 1}", pick(found.present)[:, j], ACTUATOR_COLORS[j]) for j in columns]
    for beside, dash, name in (
        (found.reference, DASHED, "reference"),
        (found.printed, DOTTED, "as printed"),
    ):
        if beside is not None:
            values = pick(beside)
            traces += [
                Trace(f"M{j + 1} {name}", values[:, j], ACTUATOR_COLORS[j], dash, False)
                for j in columns
            ]
    return traces


def _of_actuators(plot: Plot, found: Analyzed) -> tuple[Chart, ...]:
    if plot is Plot.TORQUES:
        turning, lifting = ("Torques [N·m]", "N·m"), ("Force F₄ [N]", "N")
        pick: Callable[[TrajectoryAnalysis], Values] = lambda a: a.torque  # noqa: E731
    else:
        turning, lifting = ("Power of M1–M3 [W]", "W"), ("Power of M4 [W]", "W")
        pick = lambda a: a.power  # noqa: E731
    return (
        _chart(*turning, _besides(found, pick, (0, 1, 2)), found.present),
        _chart(*lifting, _besides(found, pick, (3,)), found.present),
    )


def _marked(drawn: tuple[Chart, ...], found: Analyzed) -> tuple[Chart, ...]:
    """Return the charts of the torques with an engine's marked on them, as soon as they are known.

    The curves of the marks are there from the start, so that the charts can stay.
    """
    marks = np.full(found.present.torque.shape, np.nan)
    name, torques = "engine", found.answer.found if found.answer else None
    if torques is not None:
        name, torque = torques.engine.name, torques.engine.torque
        step = math.ceil(len(torque) / MOST_MARKS)
        marks[torques.kept[::step]] = torque[::step]
    return tuple(
        replace(
            chart,
            traces=chart.traces
            + tuple(Trace(f"M{j + 1} {name}", marks[:, j], INK, marks=True) for j in columns),
        )
        for chart, columns in zip(drawn, ((0, 1, 2), (3,)), strict=True)
    )


def _differences(found: Analyzed) -> tuple[Chart, ...]:
    """Return the formulae's torques minus an engine's; nothing in the charts if not known yet."""
    torques = found.answer.found if found.answer else None
    return tuple(
        _difference(found, torques, columns, title, unit)
        for columns, title, unit in (((0, 1, 2), "Torques", "N·m"), ((3,), "Force F₄", "N"))
    )


def _difference(
    found: Analyzed,
    torques: EngineTorques | None,
    columns: tuple[int, ...],
    title: str,
    unit: str,
) -> Chart:
    present, name = found.present, "engine"
    kept = np.arange(present.trajectory.size)
    if torques is not None:
        kept, name = torques.kept, torques.engine.name
    curves = []
    for analysis, dash, said in ((present, SOLID, ""), (found.printed, DOTTED, " as printed")):
        if analysis is not None:
            unknown = np.full((kept.size, 4), np.nan)
            values = unknown if torques is None else torques.difference(analysis)
            curves += [(f"M{j + 1}{said}", values[:, j], j, dash) for j in columns]
    largest = np.nanmax(np.abs([values for _, values, _, _ in curves]), initial=0.0)
    factor, unit = _readable(float(largest), unit)
    traces = tuple(
        Trace(label, factor * values, ACTUATOR_COLORS[j], dash, wide=dash == SOLID)
        for label, values, j, dash in curves
    )
    failing = ~present.check.good[kept]
    until = int(np.searchsorted(kept, present.check.until))
    heading = f"{title}, formulae − {name} [{unit}]"
    return Chart(heading, unit, present.trajectory.t[kept], traces, failing, until)


def _readable(largest: float, unit: str) -> tuple[float, str]:
    """Return the factor to a unit in which a small number is from 1 to 1000, and that unit."""
    if not 0.0 < largest < _PLAIN:
        return 1.0, unit
    power = 3 * math.floor(math.log10(largest) / 3)
    return 10.0**-power, f"{power_of_ten(power)} {unit}"


def _parts(actuator: int, found: Analyzed) -> Chart:
    parts = found.present.breakdown
    traces = [
        Trace(label, getattr(parts, name)[:, actuator], color, wide=False)
        for name, label, color in PARTS
    ]
    total = found.present.torque[:, actuator]
    traces.append(Trace(f"M{actuator + 1}, all", total, ACTUATOR_COLORS[actuator]))
    title, unit = ("Torque", "N·m") if actuator < 3 else ("Force", "N")
    return _chart(f"{title} of M{actuator + 1} by cause [{unit}]", unit, traces, found.present)


def _energy(found: Analyzed) -> tuple[Chart, ...]:
    present = found.present
    gained = present.energy - present.energy[0]
    balance = [
        *_besides(found, lambda a: a.work, (3,)),
        Trace("energy gained", gained, INK, DASHED),
        Trace("work − losses − gain", present.energy_residual, MUTED, wide=False),
    ]
    return (
        _chart("Work of M1–M3 [J]", "J", _besides(found, lambda a: a.work, (0, 1, 2)), present),
        _chart("Work of M4, and the robot's energy [J]", "J", balance, present),
    )


_OF_PLATFORM = {
    Plot.POSE: ("pose", "Position [mm]", "mm", "Angle θ [°]", "°"),
    Plot.SPEED: ("velocity", "Speed [mm/s]", "mm/s", "Turning speed [°/s]", "°/s"),
    Plot.ACCELERATION: ("acceleration", "Acceleration [m/s²]", "m/s²", "Of θ [rad/s²]", "rad/s²"),
}  # fmt: skip


def _of_platform(plot: Plot, found: Analyzed) -> tuple[Chart, ...]:
    name, place, unit, turn, turn_unit = _OF_PLATFORM[plot]
    scale = (1.0, 1.0) if plot is Plot.ACCELERATION else (1e3, _DEGREES)
    return _coordinates(
        getattr(found.present.trajectory, name), scale, (place, unit), (turn, turn_unit), found
    )


def _coordinates(
    values: Values,
    scale: tuple[float, float],
    place: tuple[str, str],
    turn: tuple[str, str],
    found: Analyzed,
    t: Values | None = None,
) -> tuple[Chart, ...]:
    """Return charts of x, y, z and of theta for values (n, 4)."""
    lengths = [Trace("xyθz"[i], scale[0] * values[:, i], COORDINATE_COLORS[i]) for i in (0, 1, 3)]
    angle = [Trace("θ", scale[1] * values[:, 2], COORDINATE_COLORS[2])]
    return (
        _chart(*place, lengths, found.present, t),
        _chart(*turn, angle, found.present, t),
    )


def _simulated(plot: Plot, found: Analyzed) -> tuple[Chart, ...]:
    simulation = found.simulation
    if simulation is None:
        return ()
    if plot is Plot.TRACKING:
        error = np.abs(simulation.error)
        length = ("mm", 1e3) if error[:, [0, 1, 3]].max() > _SMALL else ("µm", 1e6)
        angle = ("°", _DEGREES) if error[:, 2].max() > _SMALL else ("m°", 1e3 * _DEGREES)
        place = (f"Error of x, y, z [{length[0]}]", length[0])
        turn = (f"Error of θ [{angle[0]}]", angle[0])
        scale = (length[1], angle[1])
        return _coordinates(simulation.error, scale, place, turn, found, simulation.t)
    torques = [Trace(f"M{j + 1}", simulation.torque[:, j], ACTUATOR_COLORS[j]) for j in range(4)]
    return (
        _chart("Commanded torques [N·m]", "N·m", torques[:3], found.present, simulation.t),
        _chart("Commanded force F₄ [N]", "N", torques[3:], found.present, simulation.t),
    )
