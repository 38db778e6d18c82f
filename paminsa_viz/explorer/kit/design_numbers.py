"""Sliders of the design's numbers, made from the registry of parameters, in groups.

A new parameter appears by itself in the group whose paths it begins with; the lengths are named one
by one. A short name, a range or a step of its own is one entry below.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.kit.inputs import Slider
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import (
    APPENDIX_4,
    PARAMETER,
    PARAMETERS,
    Design,
    Geometry,
    InvalidDesign,
    InvalidInput,
    Parameter,
)
from paminsa_viz.model.geometry import BODY_SCALE
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.units import DisplayUnit, capitalized, number, symbol_text

STROKE = "geometry.guide_stroke"

DIGITS = 6
"""Significant digits of the design's numbers."""


@dataclass(frozen=True)
class SliderGroup:
    """A folder of sliders.

    Attributes:
        tab: The section that it is in.
        title: Its heading.
        prefixes: Starts of the paths that it holds.
        open: Whether it is open at first.
    """

    tab: str
    title: str
    prefixes: tuple[str, ...]
    open: bool = True

    @property
    def parameters(self) -> list[Parameter]:
        """What it holds, in the order of the prefixes and of the registry."""
        return [
            parameter
            for prefix in self.prefixes
            for parameter in PARAMETERS
            if parameter.path.startswith(prefix)
        ]


GROUPS = (
    SliderGroup("Masses", "Platform and payload", ("platform.mass", "payload.mass")),
    SliderGroup("Masses", "Payload’s center", ("payload.height",), open=False),
    SliderGroup("Masses", "Links of each leg", ("links.",)),
    SliderGroup("Masses", "Joints of each leg", ("joints.",)),
    SliderGroup(
        "Lengths", "Pantograph",
        ("geometry.magnification", "geometry.crank", "geometry.coupler"),
    ),
    SliderGroup(
        "Lengths", "Base and platform",
        ("geometry.base_radius", "geometry.platform_radius", "geometry.platform_joint_height"),
    ),
    SliderGroup(
        "Lengths", "Arms, shafts and guides",
        ("geometry.arm", "geometry.shaft", "geometry.guide", "geometry.axis"),
    ),
    SliderGroup("Lengths", "Size of the bodies", (BODY_SCALE,)),
    SliderGroup(
        "Masses", "Inertias of platform and payload", ("platform.inertia", "payload.inertia"),
        open=False,
    ),
    SliderGroup("Masses", "Inertias of the links", ("inertias.",), open=False),
    SliderGroup("Masses", "Gravity", ("gravity",), open=False),
    SliderGroup("Masses", "Friction of the actuators", ("friction.",), open=False),
    SliderGroup("Load", "External force", ("load.force",)),
    SliderGroup("Load", "External moment", ("load.moment",)),
    SliderGroup("Load", "Point of the force, from the center", ("load.point",)),
)  # fmt: skip
"""Every number of a design, once."""

NAMES = {
    "platform.mass": "platform",
    "payload.mass": "payload",
    "links.b1": "arm",
    "links.b2": "shaft",
    "links.b3": "bar 4–3–7",
    "links.b4": "bar 9–4–5",
    "links.b7": "bar 7–8",
    "links.b8": "bar 8–9",
    "links.b10": "guide link",
    "joints.j2": "shaft, arm",
    "joints.j3": "B3, shaft",
    "joints.j4": "B3, B4",
    "joints.j5": "B4, platform",
    "joints.j7": "B3, B7",
    "joints.j8": "slider",
    "joints.j9": "knee B8, B4",
    "geometry.base_radius": "leg axes",
    "geometry.platform_radius": "joints 5",
    "geometry.platform_joint_height": "joint 5 up",
    "geometry.arm_length": "arm",
    "geometry.shaft_length": "shaft",
    "geometry.guide_link_length": "guide link",
    BODY_SCALE: "bodies",
    "platform.inertia": "platform",
    "payload.inertia": "payload",
    "payload.height": "above P",
    "inertias.b2_vertical": "shaft",
    "inertias.b10_vertical": "guide link",
    "load.moment_x": "bearings",
    "load.moment_y": "bearings",
}
"""A word or two next to the symbol."""

BEARING_PATHS = ("load.moment_x", "load.moment_y", "load.point_z")
"""What no actuator sees."""

BEARINGS = "The bearings carry it: the actuators do not see it."

RANGES = {
    "geometry.magnification": (1.35, 6.0, 0.025),
    "geometry.axis_clearance": (0.0, 100.0, 0.25),
    BODY_SCALE: (0.05, 3.0, 0.005),
    "gravity": (0.0, 20.0, 0.005),
    "friction.viscous_rotary": (0.0, 2.0, 0.005),
    "friction.coulomb_rotary": (0.0, 2.0, 0.005),
    "friction.viscous_linear": (0.0, 100.0, 0.5),
    "friction.coulomb_linear": (0.0, 50.0, 0.5),
    "friction.transition_speed": (0.0005, 0.1, 0.0005),
}
"""Ends and step of a slider in the unit shown, where they do not follow from Appendix 4's value."""

_SIGNED = {"N": (200.0, 1.0), "N m": (20.0, 0.1), "m": (200.0, 0.5)}
"""Largest size and step of numbers with a sign, in the unit shown."""

_BY_UNIT = {"kg": (3.0, 10.0, 0.0005), "kg m^2": (3.0, 0.1, 0.00005), "m": (2.0, 100.0, 0.25)}
"""The range in times of Appendix 4's value, the range if that is zero, and the step.

With twice a length, the other lengths unchanged, the pantograph can still close."""


_POWERS = {
    "m": 1, "kg": 3, "kg m^2": 5, "N": 3, "N m": 4, "N s/m": 3, "N m s/rad": 4,
}  # fmt: skip
"""Powers of the lengths that numbers of robots of one shape and one density grow with."""


def shrunk(value: float, unit: str, geometry: Geometry) -> float:
    """Return an end or a step of an input as a small robot needs it, by powers of ten.

    The numbers of a micro-manipulator would all be in a slider's first pixel, and less than a step.
    For a large robot sliders grow, see `fitted_range`.
    """
    size = math.log10(length_ratio(geometry))
    decades = round(size * _POWERS.get(unit, 0)) if round(size) < 0 else 0
    return float(f"{value * 10.0**decades:.6g}") if decades else value


def of_size(step: float, unit: str) -> Callable[[State], float]:
    """Return the step of an input of an SI unit, which is smaller for a small robot."""
    return lambda state: shrunk(step, unit, state.document.design.geometry)


def base_range(
    parameter: Parameter, geometry: Geometry = APPENDIX_4.geometry
) -> tuple[float, float, float]:
    """Return ends and step of a parameter's slider, in the unit shown.

    A larger or smaller number can be typed, and the slider grows to it.

    Args:
        parameter: The parameter.
        geometry: Lengths of the robot, beside which the ends are.
    """
    ends = _prototype_range(parameter)
    low, high, step = (shrunk(value, parameter.unit, geometry) for value in ends)
    return low, high, step


def _prototype_range(parameter: Parameter) -> tuple[float, float, float]:
    """Return the same at Appendix 4's lengths."""
    if parameter.path in RANGES:
        return RANGES[parameter.path]
    if parameter.signed:
        size, step = _SIGNED[parameter.unit]
        return -size, size, step
    times, otherwise, step = _BY_UNIT[parameter.unit]
    high = round_up(times * parameter.display.from_si(parameter.default)) or otherwise
    return (step if parameter.positive else 0.0), high, step


def round_up(value: float) -> float:
    """Return the next number with two significant figures, the second one 0 or 5."""
    if value <= 0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(value)) - 1) * 5
    return float(f"{math.ceil(value / unit - 1e-9) * unit:.12g}")


def fitted_range(path: str, ends: tuple[float, float], value: float) -> tuple[float, float]:
    """Return a slider's range, grown if it has to be to hold ``value`` with room above it."""
    low, high = ends
    if value > high:
        most = PARAMETER[path].display.from_si(PARAMETER[path].largest)
        high = min(round_up(1.5 * value), max(most, value))
    return min(low, value), high


def label(parameter: Parameter) -> str:
    """Return the text next to a parameter's slider, with the unit."""
    words = [symbol_text(parameter.symbol), NAMES.get(parameter.path, "")]
    if parameter.path.startswith("inertias.") and not words[1]:
        words[1] = "along" if parameter.path.endswith("axial") else "across"
    if unit := parameter.display.text:
        words.append(f"[{unit}]")
    return " ".join(filter(None, words))


def what(parameter: Parameter) -> str:
    """Return what a parameter is; the default that its label may end with is said by itself."""
    return capitalized(parameter.label.partition(" (default: ")[0])


def hint(parameter: Parameter) -> str:
    """Return what a parameter is, and Appendix 4's value."""
    default = parameter.display.format(parameter.default, DIGITS)
    if parameter.path == STROKE:
        default = "as long as l_B10, which it follows until it is set"
    name = what(parameter)
    if parameter.group == "elastic":
        return f"{name}. Default: {default}."
    if parameter.group == "load":
        return f"{name}. {BEARINGS}" if parameter.path in BEARING_PATHS else f"{name}."
    return f"{name}. Appendix 4: {default}."


def slider(parameter: Parameter, ends: tuple[float, float, float] | None = None) -> Slider:
    """Return the slider of a parameter; ends and step, in the unit shown, follow its default."""
    path, unit, symbol = parameter.path, parameter.display, symbol_text(parameter.symbol)

    def given_ends(state: State) -> tuple[float, float, float]:
        return base_range(parameter, state.document.design.geometry) if ends is None else ends

    default = unit.from_si(parameter.default)
    return Slider(
        f"design.{path}", label(parameter), range=lambda state: given_ends(state)[:2],
        step=lambda state: given_ends(state)[2], unit=unit,
        fit=partial(fitted_range, path), marks=((default, number(default, DIGITS)),),
        hint=hint(parameter),
        read=lambda state: state.document.design.value(path),
        apply=partial(set_value, path=path, name=symbol, unit=unit),
    )  # fmt: skip


def set_value(state: State, value: float, *, path: str, name: str, unit: DisplayUnit) -> State:
    """Give the design a number that the page shows by a name and in a unit.

    Raises:
        InvalidInput: If no machine can have it.
    """
    if value == state.document.design.value(path):  # nor is a length set that follows another one
        return state
    try:
        return actions.vary(state, {path: value})
    except InvalidDesign as error:
        # The model names the value that it misses; the person has to know which one was set.
        allowed = PARAMETER[path].refusal(value, unit) or error.allowed
        raise InvalidInput(f"{name} = {unit.format(value, DIGITS)}", allowed) from error


def is_changed(design: Design, path: str) -> bool:
    """Whether a design differs from Appendix 4 in the number at ``path``.

    A number that is set in one and left open in the other differs as well, as the guide stroke that
    follows l_B10 until it is set.
    """
    return design.stored(path) != APPENDIX_4.stored(path)
