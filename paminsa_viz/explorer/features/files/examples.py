"""The example gallery: what is opened with a click."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.features.springs import actions as springs
from paminsa_viz.explorer.state.springs import SpringSettings
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.example_designs import ExampleDesign, example_design
from paminsa_viz.model import InvalidInput
from paminsa_viz.quantities.requirements import (
    Requirement,
    Requirements,
    Workspace,
    WorkspaceShape,
)


@dataclass(frozen=True)
class Example:
    """An example of the gallery.

    Attributes:
        key: Its name in messages of the page.
        label: What a person reads.
        note: What can be seen on it.
        design: The robot.
        opens: Name of the section where that is.
        prepare: What else of the state it changes, once the design is open.
    """

    key: str
    label: str
    note: str
    design: ExampleDesign
    opens: str
    prepare: Callable[[State], State] = lambda state: state


def _with_springs(state: State) -> State:
    return springs.FIT.start(state.updated("springs", settings=SpringSettings()))


CYLINDER = Workspace(WorkspaceShape.CYLINDER, (0.2, 0.2, 0.2), (0.0, 0.0, -0.599))
"""What the compact robot was searched for: ``assets/make_designs.py`` [m]."""


def _in_cylinder(state: State) -> State:
    """Ask for what the compact robot was searched for, at the middle of its cylinder."""
    turn = math.radians(30)
    bounds = (
        Requirement("condition", high=10.0),
        Requirement("reach_margin", low=0.01),
        Requirement("clearance", low=0.005),
    )
    required = Requirements(bounds, (-turn, turn), CYLINDER)
    asked = actions.change_document(state, requirements=required)
    x, y, z = (float(place or 0.0) for place in CYLINDER.center)
    return actions.move_to(asked, (x, y, 0.0, z))


EXAMPLES: tuple[Example, ...] = (
    Example(
        "appendix-4", "Appendix 4", "The paper’s prototype: gravity loads M1 to M3.",
        ExampleDesign.APPENDIX_4, "Pose",
    ),
    Example(
        "masses", "Balanced by masses",
        "The least added mass for M_p2 = 0: no torque of M1 to M3 at rest, anywhere.",
        ExampleDesign.BALANCED, "Balance",
    ),
    Example(
        "springs", "Balanced by springs",
        "Appendix 4, and a spring of free length zero on each leg. They are fitted next to the "
        "design, which stays unbalanced without them; torques with them are above the tabs.",
        ExampleDesign.APPENDIX_4, "Balance", _with_springs,
    ),
    Example(
        "payload", "Heavy payload",
        "10 kg on the balanced robot: only M4 holds it at rest. Drives are chosen for the preset "
        "motion, see the sections Path and Drives.",
        ExampleDesign.PAYLOAD, "Drives", lambda state: motions.choose_preset(state, "paper-like"),
    ),
    Example(
        "compact", "Compact robot",
        "Lengths by global search for a cylinder of r 100 mm and 200 mm height with θ ± 30°: "
        "0.48 m of footprint radius, Appendix 4 has 0.73 m. It opens with that as requirements.",
        ExampleDesign.COMPACT, "Requirements", _in_cylinder,
    ),
)  # fmt: skip
"""The gallery, in the order of the page."""


def example_named(key: str) -> Example:
    """Return an example by its key.

    Raises:
        InvalidInput: If there is none.
    """
    found = next((example for example in EXAMPLES if example.key == key), None)
    if found is None:
        raise InvalidInput("example", f"one of {', '.join(e.key for e in EXAMPLES)} is needed")
    return found


def open_example(state: State, key: str) -> State:
    """Work on an example, at the current pose if it can be taken; springs of before are removed.

    Raises:
        InvalidInput: If there is no such example.
    """
    found = example_named(key)
    opened = actions.load_design(springs.FIT.forget(state), example_design(found.design))
    return found.prepare(opened)
