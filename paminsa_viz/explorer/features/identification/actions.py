"""What a person can ask of the identification, each as a pure function from state to state."""

from __future__ import annotations

from dataclasses import replace

from paminsa_viz.errors import printable
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.actions import with_design
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.features.identification.solving import identify_logs, search_excitation
from paminsa_viz.explorer.kit.task import Task
from paminsa_viz.explorer.state.identification import EXPORT_RATE, ExcitationJob, IdentifyJob
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.design_writer import NAME_CHARACTERS
from paminsa_viz.files.example_logs import ExampleLog, example_log
from paminsa_viz.identification import Excitation, Log
from paminsa_viz.identification.findings import Findings
from paminsa_viz.model import InvalidInput

PLACES = ("log", "other", "loaded")
"""The logs: to identify, to validate with, with a payload."""


def use_log(state: State, place: str, log: Log) -> State:
    """Take a log; the first one is identified at once."""
    state = state.updated("identification", **{place: log})
    return IDENTIFY.start(state) if state.identification.log is not None else state


def use_examples(state: State) -> State:
    """Take the logs that come with the program."""
    logs = [example_log(kind) for kind in ExampleLog]
    state = state.updated("identification", **dict(zip(PLACES, logs, strict=True)))
    return IDENTIFY.start(state.updated("identification.settings", payload=2.0))


def close_logs(state: State) -> State:
    """Close the logs and what came of them."""
    return IDENTIFY.forget(state.updated("identification", **dict.fromkeys(PLACES)))


def _identify_job(state: State) -> IdentifyJob:
    own = state.identification
    if own.log is None:
        raise InvalidInput("log", "open one first")
    settings = own.settings.of_log
    return IdentifyJob(state.document.design, own.log, own.other, own.loaded, settings)


def _identify_again(state: State, outcome: Outcome[IdentifyJob, Findings]) -> IdentifyJob:
    """Return the job anew; a design that has what it found by now is no other one."""
    job, found = _identify_job(state), outcome.result
    own = found is not None and job.design == found.nearest.design
    return replace(job, design=outcome.job.design) if own else job


IDENTIFY = Task(
    Place(lambda state: state.identification), _identify_job, identify_logs,
    again=_identify_again,
)  # fmt: skip
"""Identifies the design's parameters from the open logs."""

SEARCH = Task(
    Place(lambda state: state.identification.excitation),
    lambda state: ExcitationJob(state.document.design, state.identification.settings.of_excitation),
    search_excitation,
)
"""Searches for a motion to record a log with."""


def findings(state: State) -> Findings:
    """Return what the last identification found.

    Raises:
        InvalidInput: If there is nothing.
    """
    _, found = IDENTIFY.required(state, "log", "nothing has been identified yet")
    return found


def use_design(state: State) -> State:
    """Make the nearest masses and the friction the design's, under a name that says so.

    Raises:
        InvalidInput: If there are none.
    """
    found = findings(state)
    name = f"Identified from {printable(found.identification.log.name)}"[:NAME_CHARACTERS]
    return with_design(state, replace(found.nearest.design, name=name))


def use_log_motion(state: State) -> State:
    """Let the robot run the motion of the log.

    Raises:
        InvalidInput: If there is none.
    """
    return motions.play(motions.use_table(state, findings(state).motion))


def excitation(state: State) -> tuple[ExcitationJob, Excitation]:
    """Return the last search for a motion, and the motion that it found.

    Raises:
        InvalidInput: If there is none.
    """
    return SEARCH.required(state, "motion", "none has been found yet")


def use_excitation(state: State) -> State:
    """Make the motion that was found the current one.

    Raises:
        InvalidInput: If there is none.
    """
    _, found = excitation(state)
    return motions.use_table(state, found.plan.sample(EXPORT_RATE))
