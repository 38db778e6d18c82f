"""Requirements that contradict, the fewest of them, and the nearest bounds that do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirements import Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.synthesis.volume.conflict import smallest_conflict
from paminsa_viz.synthesis.volume.grid import COARSE
from paminsa_viz.synthesis.volume.solve import solve_volume
from tests.synthesis.robots import needs


def conflict_of(*texts: str, workspace: Workspace | None = None):  # type: ignore[no-untyped-def]
    volume = solve_volume(APPENDIX_4, needs(*texts), resolution=COARSE)
    return volume, smallest_conflict(volume, workspace)


def test_no_conflict_where_a_volume_is_left() -> None:
    assert conflict_of("condition <= 10", "max_torque <= 15")[1] is None
    assert conflict_of()[1] is None


def test_two_bounds_of_one_quantity_contradict_and_the_others_are_not_named() -> None:
    volume, found = conflict_of(
        "f_4 <= 450", "condition <= 5", "max_torque <= 50", "condition >= 7"
    )
    assert volume.empty
    assert found.requirements == (1, 3)
    # the nearest: somewhere kappa's least and largest over the headings are closest
    least = 7.0 + volume.margins[3]
    largest = 5.0 - volume.margins[1]
    down, up = found.relaxations
    assert down.by == pytest.approx(np.nanmin(np.where(least >= 7.0, largest, np.nan)) - 5.0)
    assert down.relaxed.high == pytest.approx(5.0 + down.by)
    assert up.relaxed.low == pytest.approx(7.0 - up.by)


def test_one_impossible_bound_is_a_conflict_of_its_own() -> None:
    _, found = conflict_of("condition <= 1.2", "max_torque <= 15")
    assert found.requirements == (0,)
    assert found.relaxations[0].relaxed.high == pytest.approx(np.sqrt(2.0))
    assert found.relaxations[0].center[:2] == pytest.approx((0.0, 0.0))


@pytest.mark.parametrize(
    "texts",
    [("condition <= 1.3", "f_4 <= 450"), ("max_torque <= 0.5", "condition >= 4", "f_4 <= 450")],
)
def test_relaxed_requirement_leaves_something(texts: tuple[str, ...]) -> None:
    volume, found = conflict_of(*texts)
    assert found is not None
    for relaxation in found.relaxations:
        assert relaxation.by > 0.0
        bounds = list(volume.requirements.bounds)
        for share, empty in ((1.0 + 1e-9, False), (0.99, True)):
            moved = relaxation.by * share
            bound = volume.requirements.bounds[relaxation.requirement]
            bounds[relaxation.requirement] = replace(
                bound,
                low=None if bound.low is None else bound.low - moved,
                high=None if bound.high is None else bound.high + moved,
            )
            requirements = Requirements(tuple(bounds), volume.requirements.theta)
            assert solve_volume(APPENDIX_4, requirements, resolution=COARSE).empty is empty


def test_side_of_a_two_sided_bound_that_breaks_is_moved() -> None:
    _, found = conflict_of("1 <= condition <= 1.2")
    assert found.relaxations[0].relaxed.low == 1.0
    assert found.relaxations[0].relaxed.high == pytest.approx(np.sqrt(2.0))
    _, found = conflict_of("|tau_1| <= 0.0001", "condition >= 4")
    relaxed = found.relaxations[0].relaxed
    assert relaxed.low == -relaxed.high


def test_nothing_to_reach_is_no_requirement_s_fault() -> None:
    wide = needs("condition <= 10", theta=(-1.5, 1.5))
    found = smallest_conflict(solve_volume(APPENDIX_4, wide, resolution=COARSE))
    assert found is not None
    assert found.requirements == ()


def test_workspace_that_does_not_fit_names_what_keeps_it_out() -> None:
    wide = Workspace(WorkspaceShape.CYLINDER, (0.3, 0.3, 0.2), (None, None, None))
    volume, found = conflict_of("condition <= 3", "f_4 <= 450", workspace=wide)
    assert not volume.empty
    assert found.requirements == (0,)
    relaxed = (found.relaxations[0].relaxed, volume.requirements.bounds[1])
    eased = Requirements(relaxed, volume.requirements.theta)
    center = found.relaxations[0].center
    # nodes lie within the cylinder, samples up to its boundary: the check needs a little more
    eased = replace(eased, bounds=(replace(relaxed[0], high=1.4 * relaxed[0].high), relaxed[1]))
    placed = replace(eased, workspace=replace(wide, center=center))
    assert check_requirements(APPENDIX_4, placed).holds


def test_workspace_larger_than_the_reach() -> None:
    huge = Workspace(WorkspaceShape.BOX, (0.9, 0.9, 0.9), (0.0, 0.0, None))
    assert conflict_of("condition <= 10", workspace=huge)[1].requirements == ()


def test_the_fewest_are_found_among_many() -> None:
    loose = [f"f_4 <= {500 + index}" for index in range(9)]
    _, found = conflict_of("condition <= 5", *loose, "condition >= 7")
    assert found.requirements == (0, 10)
