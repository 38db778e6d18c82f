"""The frozen state of one session, and nothing else: what the page shows follows from it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from paminsa_viz.explorer.state.accuracy import EncoderState, WorstErrorsState
from paminsa_viz.explorer.state.balance import BalanceState
from paminsa_viz.explorer.state.calibration import CalibrationState, sized_calibration
from paminsa_viz.explorer.state.clearance import ClearanceState, sized_clearance
from paminsa_viz.explorer.state.document import Document, LastReachable
from paminsa_viz.explorer.state.drives import DrivesState
from paminsa_viz.explorer.state.export import ExportSettings
from paminsa_viz.explorer.state.identification import IdentificationState
from paminsa_viz.explorer.state.inspector import RobotPart
from paminsa_viz.explorer.state.layers import default_layers
from paminsa_viz.explorer.state.loads import LoadsState
from paminsa_viz.explorer.state.maps import MapView
from paminsa_viz.explorer.state.monte_carlo import MonteCarloState
from paminsa_viz.explorer.state.motion import Playback, PlotView, PointEditing, sized_motion
from paminsa_viz.explorer.state.outcome import TaskState
from paminsa_viz.explorer.state.pins import PinsState
from paminsa_viz.explorer.state.requirements import RequirementsState
from paminsa_viz.explorer.state.simulation import Answer, SimulationState, sized_simulation
from paminsa_viz.explorer.state.springs import SpringsState, sized_springs
from paminsa_viz.explorer.state.stiffness import StiffnessState
from paminsa_viz.explorer.state.synthesis import SynthesisState
from paminsa_viz.explorer.state.tolerances import TolerancesState
from paminsa_viz.explorer.state.view import Appearance, Camera, Docks, WorkspaceView
from paminsa_viz.model import APPENDIX_4, Design, Geometry
from paminsa_viz.model.reach import home_pose
from paminsa_viz.model.singular_limit import CONDITION_LIMIT
from paminsa_viz.palette import DARK, LIGHT, Theme


@dataclass(frozen=True)
class Steps:
    """Whether there is a step to undo, and one to redo."""

    back: bool = False
    forward: bool = False


@dataclass(frozen=True)
class State:
    """Everything one browser tab shows.

    Attributes:
        document, last_reachable: What is worked on, and where the robot is.
        map_view: How the maps are drawn.
        layers: Keys of the visible layers of the scene, see `paminsa_viz.explorer.state.layers`.
        floor_opacity: Opacity of the map on the ground.
        playback, plots: Where the motion is played, and how it is plotted.
        point_editing: Which of the poses that a motion is built from is edited, and how.
        simulation to pins, engine_answer: What a person set in the features of these names, their
            jobs, and what came of them.
        condition_limit: Largest condition number of a pose that counts, see
            `paminsa_viz.model.singular_limit`.
        export, recording: How files are exported, and what is made of a motion's picture.
        table_at_rest: Whether a motion in an opened file starts and ends at rest.
        appearance: Which theme the page has.
        browser_dark: Whether the browser asks for a dark one.
        docks: Widths of the page's docks.
        inspected: Part of the robot that the inspector shows, None while it is closed.
        workspace: Name of the workspace that is open, empty until the page has said so.
        workspaces: How the others were left.
        answer: Key of the answer that the left dock shows, empty until one was chosen.
        camera: Where a person has put the camera, None for a preset. These four are no difference
            of two states.
        offered: What the tab has kept from before, if it came after something was set; else empty.
        ended: Names of the tasks that a reload has ended, or whose results it lost.
        steps: What can be undone and redone; no difference of two states.
    """

    document: Document
    last_reachable: LastReachable
    map_view: MapView = field(default_factory=MapView)
    layers: frozenset[str] = field(default_factory=default_layers)
    floor_opacity: float = 0.85
    playback: Playback = field(default_factory=Playback)
    plots: PlotView = field(default_factory=PlotView)
    point_editing: PointEditing = field(default_factory=PointEditing)
    simulation: SimulationState = field(default_factory=SimulationState)
    balance: BalanceState = field(default_factory=BalanceState)
    springs: SpringsState = field(default_factory=SpringsState)
    tolerances: TolerancesState = field(default_factory=TolerancesState)
    clearance: ClearanceState = field(default_factory=ClearanceState)
    drives: DrivesState = field(default_factory=DrivesState)
    encoder: EncoderState = field(default_factory=EncoderState)
    worst_errors: WorstErrorsState = field(default_factory=WorstErrorsState)
    monte_carlo: MonteCarloState = field(default_factory=MonteCarloState)
    loads: LoadsState = field(default_factory=LoadsState)
    stiffness: StiffnessState = field(default_factory=StiffnessState)
    identification: IdentificationState = field(default_factory=IdentificationState)
    calibration: CalibrationState = field(default_factory=CalibrationState)
    requirements: RequirementsState = field(default_factory=RequirementsState)
    synthesis: SynthesisState = field(default_factory=SynthesisState)
    pins: PinsState = field(default_factory=PinsState)
    engine_answer: Answer | None = None
    condition_limit: float = CONDITION_LIMIT
    export: ExportSettings = field(default_factory=ExportSettings)
    recording: TaskState[str, bytes] = TaskState()
    table_at_rest: bool = False
    appearance: Appearance = Appearance.BROWSER
    browser_dark: bool = False
    docks: Docks = field(default_factory=Docks)
    inspected: RobotPart | None = None
    workspace: str = field(default="", compare=False)
    workspaces: tuple[WorkspaceView, ...] = field(default=(), compare=False)
    answer: str = field(default="", compare=False)
    camera: Camera | None = field(default=None, compare=False)
    offered: str = ""
    ended: tuple[str, ...] = ()
    steps: Steps = field(default=Steps(), compare=False)

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
        """Return the state with other attributes of a part, such as ``"simulation.settings"``."""
        return _updated(self, part, changes)


def _updated(data: Any, part: str, changes: dict[str, Any]) -> Any:
    if not part:
        return replace(data, **changes)
    name, _, rest = part.partition(".")
    return replace(data, **{name: _updated(getattr(data, name), rest, changes)})


def initial_state(design: Design = APPENDIX_4) -> State:
    """Return the state a new session starts with."""
    pose = home_pose(design.geometry)
    state = State(Document(design, pose), LastReachable(design.geometry, pose))
    return sized(state, APPENDIX_4.geometry)


def sized(state: State, was: Geometry) -> State:
    """Return the state with what follows the robot's lengths and the size of its bodies.

    What a person has chosen stays.

    Args:
        state: The state.
        was: Lengths that its motion and settings were for.
    """
    document, now = state.document, state.document.design.geometry
    if was == now:
        return state
    springs = sized_springs(state.springs.settings, was, now)
    simulation = sized_simulation(state.simulation.settings, was, now)
    clearance = sized_clearance(state.clearance.settings, was, now)
    state = state.updated("springs", settings=springs).updated("simulation", settings=simulation)
    calibration = sized_calibration(state.calibration.settings, was, now)
    state = state.updated("clearance", settings=clearance)
    state = state.updated("calibration", settings=calibration)
    return state.updated("document", motion=sized_motion(document.motion, was, now))
