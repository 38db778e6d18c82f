"""The frozen state of one session, and nothing else: what the page shows follows from it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any

from paminsa_viz.explorer.balancing.jobs import Balancing
from paminsa_viz.explorer.balancing.springs import Springing
from paminsa_viz.explorer.balancing.tolerances import Tolerating
from paminsa_viz.explorer.clearing import ClearanceSettings, Clearing
from paminsa_viz.explorer.drives import Driving
from paminsa_viz.explorer.elasticity import ElasticView
from paminsa_viz.explorer.identifying import Identifying
from paminsa_viz.explorer.loads import LoadsState
from paminsa_viz.explorer.manufacture import Manufacture
from paminsa_viz.explorer.motion.description import Motion, Playback, PlotView, Pose
from paminsa_viz.explorer.motion.jobs import Answer, Simulating
from paminsa_viz.explorer.motion.planning import PointEditing
from paminsa_viz.explorer.requirements.jobs import Requiring
from paminsa_viz.explorer.scene.layers import default_layers
from paminsa_viz.explorer.synthesis.jobs import Synthesizing
from paminsa_viz.explorer.tasks import TaskState
from paminsa_viz.model import APPENDIX_4, Design, Geometry
from paminsa_viz.model.reach import home_pose
from paminsa_viz.model.singular_limit import CONDITION_LIMIT
from paminsa_viz.palette import DARK, LIGHT, Theme
from paminsa_viz.quantities.requirements import Requirements


@dataclass(frozen=True)
class LastReachable:
    """The last reachable pose; the robot stays there while a requested one is out of reach.

    Attributes:
        geometry: The lengths and the knee's root it was solved with.
        pose: Platform pose [m, m, rad, m].
    """

    geometry: Geometry
    pose: Pose


class RangeMode(Enum):
    """How a map's color range is found."""

    AUTO = "robust"
    FULL = "full"
    MANUAL = "manual"


class Appearance(Enum):
    """Which theme the page has."""

    BROWSER = "as the browser"
    LIGHT = "light"
    DARK = "dark"


@dataclass(frozen=True)
class MapView:
    """How the torque maps are drawn.

    Attributes:
        quantity: Key of what the single map and the floor show; the other figure shows torques.
        range_mode: How the color range is found.
        low, high: The manual range, in the quantity's SI unit.
        shared: Whether the three torque maps have one range.
        logarithmic: Whether colors follow a symmetric logarithm.
        difference: Whether the maps show the difference from the reference design.
        hatched: Whether cells that break a requirement are hatched.
    """

    quantity: str = "max_torque"
    range_mode: RangeMode = RangeMode.AUTO
    low: float = -10.0
    high: float = 10.0
    shared: bool = True
    logarithmic: bool = False
    difference: bool = False
    hatched: bool = True


@dataclass(frozen=True)
class Document:
    """What a person works on: undo, saving and share codes are about this.

    Attributes:
        design: The robot.
        pose: The requested pose; it may be out of reach.
        reference: A pinned design to compare with, or None.
        motion: The motion that is planned.
        requirements: What the robot is needed for.
    """

    design: Design = APPENDIX_4
    pose: Pose = (0.0, 0.0, 0.0, 0.0)
    reference: Design | None = None
    motion: Motion = field(default_factory=Motion)
    requirements: Requirements = field(default_factory=Requirements)


@dataclass(frozen=True)
class Dock:
    """One of the page's docks, as a person has left it; None for what the page itself chooses.

    Attributes:
        width: Width [px].
        folded: Whether it is folded.
    """

    width: int | None = None
    folded: bool | None = None


@dataclass(frozen=True)
class Docks:
    """The dock of the maps, left, and that of the tabs, right."""

    left: Dock = Dock()
    right: Dock = Dock()


@dataclass(frozen=True)
class ExportSettings:
    """How files are exported.

    Attributes:
        single: The single map instead of the three torque maps.
        width: Width of a figure [mm].
        dpi: Its resolution [pixels per inch].
        view_size: Width and height of the 3D view's picture [pixels]; None for the page's own.
    """

    single: bool = False
    width: float = 170.0
    dpi: float = 300.0
    view_size: tuple[int, int] | None = None


@dataclass(frozen=True)
class State:
    """Everything one browser tab shows.

    Attributes:
        document, last_reachable: What is worked on, and where the robot is.
        map_view: How the maps are drawn.
        layers: Keys of the visible layers of the scene, see `paminsa_viz.explorer.scene.layers`.
        floor_opacity: Opacity of the map on the ground.
        playback, plots: Where the motion is played, and how it is plotted.
        point_editing: Which of the poses that a motion is built from is edited, and how.
        simulating, balancing, springing, tolerating, clearing, driving, manufacture, loads,
            elastic_view, identifying, requiring, synthesizing, engine_answer: Jobs of the session
            and what came of them.
        clearance_view: Which pairs of bodies are checked for clearance, and what is enough.
        condition_limit: Largest condition number of a pose that counts, see
            `paminsa_viz.model.singular_limit`.
        export, recording: How files are exported, and what is made of a motion's picture.
        table_at_rest: Whether a motion in an opened file starts and ends at rest.
        appearance: Which theme the page has.
        browser_dark: Whether the browser asks for a dark one.
        docks: Widths of the page's docks.
    """

    document: Document
    last_reachable: LastReachable
    map_view: MapView = field(default_factory=MapView)
    layers: frozenset[str] = field(default_factory=default_layers)
    floor_opacity: float = 0.85
    playback: Playback = field(default_factory=Playback)
    plots: PlotView = field(default_factory=PlotView)
    point_editing: PointEditing = field(default_factory=PointEditing)
    simulating: Simulating = field(default_factory=Simulating)
    balancing: Balancing = field(default_factory=Balancing)
    springing: Springing = field(default_factory=Springing)
    tolerating: Tolerating = field(default_factory=Tolerating)
    clearance_view: ClearanceSettings = field(default_factory=ClearanceSettings)
    clearing: Clearing = field(default_factory=Clearing)
    driving: Driving = field(default_factory=Driving)
    manufacture: Manufacture = field(default_factory=Manufacture)
    loads: LoadsState = field(default_factory=LoadsState)
    elastic_view: ElasticView = field(default_factory=ElasticView)
    identifying: Identifying = field(default_factory=Identifying)
    requiring: Requiring = field(default_factory=Requiring)
    synthesizing: Synthesizing = field(default_factory=Synthesizing)
    engine_answer: Answer | None = None
    condition_limit: float = CONDITION_LIMIT
    export: ExportSettings = field(default_factory=ExportSettings)
    recording: TaskState[str, bytes] = TaskState()
    table_at_rest: bool = False
    appearance: Appearance = Appearance.BROWSER
    browser_dark: bool = False
    docks: Docks = field(default_factory=Docks)

    @property
    def theme(self) -> Theme:
        """Colors of the page; what is exported is always light."""
        follows = self.appearance is Appearance.BROWSER
        dark = self.browser_dark if follows else self.appearance is Appearance.DARK
        return DARK if dark else LIGHT

    @property
    def shown_design(self) -> Design:
        """The design as it is shown: with the lengths of the last reachable pose."""
        design, shown = self.document.design, self.last_reachable.geometry
        return design if design.geometry == shown else replace(design, geometry=shown)

    def updated(self, part: str, **changes: Any) -> State:
        """Return the state with other attributes of a part, such as ``"simulating.settings"``."""
        return _updated(self, part, changes)


def _updated(data: Any, part: str, changes: dict[str, Any]) -> Any:
    if not part:
        return replace(data, **changes)
    name, _, rest = part.partition(".")
    return replace(data, **{name: _updated(getattr(data, name), rest, changes)})


def initial_state(design: Design = APPENDIX_4) -> State:
    """Return the state a new session starts with."""
    pose = home_pose(design.geometry)
    document = Document(design, pose)
    return State(document, LastReachable(design.geometry, pose))
