"""Files: the volume of the Export tab, and requirements in design files."""

from __future__ import annotations

import io

import numpy as np
import pytest
import trimesh

from paminsa_viz.explorer.features.export.exports import volume_file
from paminsa_viz.explorer.features.files.tab import open_content
from paminsa_viz.explorer.features.requirements import actions
from paminsa_viz.explorer.features.requirements.volumes import find_volume
from paminsa_viz.explorer.page import opening_state
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.requirements import VolumeJob
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.files.design_file import read_content, write_design
from paminsa_viz.model import InvalidInput
from paminsa_viz.quantities.requirements import Requirement
from paminsa_viz.synthesis.volume.surface import VOLUME_FORMATS


def solved(state: State) -> State:
    """Return a state whose fine volume is a coarse one: files are of what is there."""
    document = state.document
    outcome = solve(find_volume, VolumeJob(document.design, document.requirements))
    return state.updated("requirements", fine=outcome)


@pytest.mark.slow
def test_the_volume_that_is_shown_is_written_in_every_format() -> None:
    state = solved(actions.suggest(initial_state()))
    volume = state.requirements.fine.result.volume  # type: ignore[union-attr]
    assert volume is not None
    files = {kind: volume_file(state, kind) for kind in VOLUME_FORMATS}
    assert all(file.name == f"paminsa_appendix-4_volume.{kind}" for kind, file in files.items())
    mesh = trimesh.load(io.BytesIO(files["stl"].content), file_type="stl")
    assert abs(mesh.volume) / 1e9 == pytest.approx(volume.volume, rel=0.02)  # drawn by cells
    arrays = np.load(io.BytesIO(files["npz"].content))
    assert (arrays["cause"] == volume.cause).all()


def test_an_empty_volume_has_no_surface_to_write() -> None:
    asked = actions.change(initial_state(), bounds=(Requirement("condition", high=1.001),))
    with pytest.raises(InvalidInput, match="empty"):
        volume_file(solved(asked), "stl")


def test_requirements_come_with_their_design_file_and_stay_without_any() -> None:
    asked = actions.suggest(initial_state())
    design, requirements = asked.document.design, asked.document.requirements
    text = write_design(design, requirements=requirements).encode()
    opened = open_content(initial_state(), read_content(text, "robot.toml"))
    assert opened.document.requirements == requirements
    plain = read_content(write_design(design).encode(), "robot.toml")
    assert open_content(asked, plain).document.requirements == requirements
    assert opening_state(design, requirements).document.requirements == requirements
