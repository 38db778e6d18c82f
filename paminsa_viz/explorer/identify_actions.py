"""What a person can ask of the identification, each as a pure function from state to state."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from paminsa_viz.explorer.actions import renamed_if_changed, with_document
from paminsa_viz.explorer.identifying import (
    EXPORT_RATE,
    ExcitationJob,
    ExcitationOutcome,
    IdentifyJob,
    IdentifyOutcome,
    parse_gains,
)
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.state import State
from paminsa_viz.files.example_logs import ExampleLog, example_log
from paminsa_viz.identification import Log
from paminsa_viz.model import InvalidInput

PLACES = ("log", "other", "loaded")
"""The logs: to identify, to validate with, with a payload."""


def change_settings(state: State, **changes: Any) -> State:
    """Change the settings.

    Raises:
        InvalidInput: If the gains are not four numbers.
    """
    parse_gains(changes.get("gains", ""))
    settings = replace(state.identifying.settings, **changes)
    return state.updated("identifying", settings=settings)


def use_log(state: State, place: str, log: Log) -> State:
    """Take a log; the first one is identified at once."""
    state = state.updated("identifying", **{place: log})
    return identify(state) if state.identifying.log is not None else state


def use_examples(state: State) -> State:
    """Take the logs that come with the program."""
    logs = [example_log(kind) for kind in ExampleLog]
    opened = dict(zip(PLACES, logs, strict=True))
    return identify(change_settings(state.updated("identifying", **opened), payload=2.0))


def close_logs(state: State) -> State:
    """Close the logs and what came of them."""
    nothing = {"log": None, "other": None, "loaded": None, "running": None, "outcome": None}
    return state.updated("identifying", **nothing)


def identify(state: State) -> State:
    """Start an identification.

    Raises:
        InvalidInput: If there is no log.
    """
    own = state.identifying
    if own.log is None:
        raise InvalidInput("log", "open one first")
    job = IdentifyJob(state.document.design, own.log, own.other, own.loaded, own.settings)
    return state.updated("identifying", running=job)


def receive(state: State, outcome: IdentifyOutcome) -> State:
    """Take over a result."""
    return state.updated("identifying", running=None, outcome=outcome)


def search(state: State) -> State:
    """Start a search for a motion."""
    job = ExcitationJob(state.document.design, state.identifying.settings)
    return state.updated("identifying", searching=job, done=0.0)


def stop(state: State) -> State:
    """Stop the search."""
    return state.updated("identifying", searching=None)


def receive_excitation(state: State, outcome: ExcitationOutcome) -> State:
    """Take over a motion."""
    return state.updated("identifying", searching=None, excited=outcome)


def search_progress(state: State, job: ExcitationJob, done: float) -> State:
    if state.identifying.searching is not job:
        return state
    return state.updated("identifying", done=done)


def use_design(state: State) -> State:
    """Make the nearest masses and the friction the design's.

    Raises:
        InvalidInput: If there are none.
    """
    found = state.identifying.findings
    if found is None:
        raise InvalidInput("log", "nothing has been identified yet")
    design = renamed_if_changed(replace(found.nearest.design, name=state.document.design.name))
    return with_document(state, replace(state.document, design=design))


def use_log_motion(state: State) -> State:
    """Let the robot run the motion of the log.

    Raises:
        InvalidInput: If there is none.
    """
    found = state.identifying.findings
    if found is None:
        raise InvalidInput("log", "nothing has been identified yet")
    return motions.play(motions.use_table(state, found.motion))


def use_excitation(state: State) -> State:
    """Make the motion that was found the current one.

    Raises:
        InvalidInput: If there is none.
    """
    outcome = state.identifying.excited
    if outcome is None or outcome.excitation is None:
        raise InvalidInput("motion", "none has been found yet")
    return motions.use_table(state, outcome.excitation.plan.sample(EXPORT_RATE))
