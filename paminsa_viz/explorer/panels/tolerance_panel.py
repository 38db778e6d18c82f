"""Tolerances of the balance: what masses and lengths within them do to the static torques."""

from __future__ import annotations

from paminsa_viz.explorer.background import BackgroundJob
from paminsa_viz.explorer.balancing import tolerances
from paminsa_viz.explorer.balancing.tolerances import LengthJob, LengthOutcome, of_masses, run
from paminsa_viz.explorer.entries import Button, Custom, Entry, Html
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.inputs import PERCENT, Number, attribute
from paminsa_viz.explorer.panels import render
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.model import PARAMETER

LEADING = 3
"""Masses that are named, by their share in the variance."""


def wanted(state: State) -> LengthJob:
    """Return the sample of the current state."""
    document, limit = state.document, state.condition_limit
    _, _, theta, z = document.pose
    return LengthJob(document.design, theta, z, state.tolerating.settings.length, limit)


def start(state: State) -> State:
    """Draw robots of the current state."""
    return state.updated("tolerating", running=wanted(state))


def receive(state: State, outcome: LengthOutcome) -> State:
    """Take over the result of the sample that runs; that of an older one is dropped."""
    if state.tolerating.running is not outcome.job:
        return state
    return state.updated("tolerating", running=None, outcome=outcome)


def masses_html(frame: Frame) -> str:
    """Return the spread of M_p2 and of the torques at this pose from the tolerance of masses."""
    state = frame.state
    mass = state.tolerating.settings.mass
    found = of_masses(frame.shown_design, state.last_reachable.pose, mass)
    rows = [("M_p2", found.nominal, found.deviation, abs(found.nominal) + found.worst, "N")]
    rows += [
        (f"M{j + 1}", float(found.torque[j]), float(found.torque_deviation[j]),
         float(found.torque_worst[j]), "N·m")
        for j in range(3)
    ]  # fmt: skip
    shares = [(_symbol(path), share) for path, share in list(found.shares.items())[:LEADING]]
    return render("tolerance_masses.j2", rows=rows, shares=shares)


def _symbol(path: str) -> str:
    if path in PARAMETER:
        return PARAMETER[path].symbol
    return f"counterweight {int(path.split('.')[1]) + 1}"


def lengths_html(frame: Frame) -> str:
    """Return the spread of the peak torque from the tolerance of lengths."""
    tolerating = frame.state.tolerating
    outcome = tolerating.outcome
    if tolerating.running is not None:
        return render("status.j2", testid="tolerance", level="plain", title="Computing …", lines=[])
    if outcome is None:
        return ""
    if outcome.found is None:
        return render(
            "status.j2", testid="tolerance", level="bad", title="No sample",
            lines=[outcome.problem],
        )  # fmt: skip
    found = outcome.found
    return render(
        "tolerance_lengths.j2", found=found, robots=found.peaks.size,
        lost=int((found.lost > 0).sum()), stale=outcome.job != wanted(frame.state),
    )  # fmt: skip


class RobotDrawer:
    """Draws the robots that are asked for."""

    def __init__(self, session: Session) -> None:
        self._job: BackgroundJob[LengthJob, LengthOutcome] = BackgroundJob(
            session, "tolerance", lambda job, _: run(job), receive, undo=False,
            failed=lambda job, problem: LengthOutcome(job, None, problem),
        )  # fmt: skip

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Start what is requested."""
        del dragging
        self._job.request(frame.state.tolerating.running)


TOLERANCES: tuple[Entry, ...] = (
    Custom("tolerance.drawer", make=RobotDrawer),
    Number(
        "tolerance.mass", "Masses ± [%]", range=tolerances.MASSES, step=0.5, unit=PERCENT,
        hint="Of every mass of joints, links and counterweights, in each leg by itself",
        **attribute("tolerating.settings.mass"),
    ),
    Html("tolerance.masses", content=masses_html, idle=True),
    Number(
        "tolerance.length", "Lengths ± [%]", range=tolerances.LENGTHS, step=0.05, unit=PERCENT,
        hint="Of k, R_b, R_pl, the bars, l_B5 and the places of counterweights, in all legs alike",
        **attribute("tolerating.settings.length"),
    ),
    Button(
        "tolerance.draw", "Draw robots", effect=start, undo=False,
        disabled=lambda state: state.tolerating.running is not None,
        hint="200 robots within the tolerance of lengths, on the map at this θ and z",
    ),
    Html("tolerance.lengths", content=lengths_html, idle=True),
)  # fmt: skip
