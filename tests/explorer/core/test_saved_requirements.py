"""Requirements in saved texts: read back, or refused with a reason."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import pytest

from paminsa_viz.explorer.core import persistence
from paminsa_viz.explorer.core.saved_requirements import (
    MOST_REQUIREMENTS,
    require_possible,
    requirements_data,
)
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.model import InvalidInput
from paminsa_viz.quantities.requirements import (
    Requirement,
    Requirements,
    Workspace,
    WorkspaceShape,
)

ALL = Requirements(
    (Requirement("condition", high=10.0),) * MOST_REQUIREMENTS,
    (-0.5, 0.5),
    Workspace(WorkspaceShape.BOX, (0.6, 0.5, 0.3), (0.0, None, -0.7)),
)
SAVED = requirements_data(ALL)


def test_the_most_requirements_of_a_page_fit_into_a_share_code() -> None:
    long, third = (-1 / 3, 1 / 7), 1 / 3
    one = Requirement("rms_tolerance_horizontal", -third, third, long, long)
    heavy = replace(ALL, bounds=(one,) * MOST_REQUIREMENTS)
    document = Document(requirements=heavy)
    assert persistence.open_share_code(persistence.share_code(document)) == document
    assert len(persistence.dump(document)) < persistence.LONGEST_TEXT / 4


@pytest.mark.parametrize(
    "changed",
    [
        {"bounds": [*SAVED["bounds"], {"quantity": "condition", "high": 1.0}]},
        {"bounds": [{"quantity": "nothing", "high": 1.0}]},
        {"bounds": [{"quantity": "condition"}]},
        {"bounds": [{"quantity": "condition", "high": "10"}]},
        {"theta": [1.0, 0.0]},
        {"theta": [0.0, 1e9]},
        {"workspace": SAVED["workspace"] | {"size": [0.1, 0.1, -1.0]}},
        {"workspace": SAVED["workspace"] | {"size": [0.1, 0.1, 1e9]}},
        {"workspace": SAVED["workspace"] | {"shape": "ball"}},
        {"workspace": 3},
    ],
    ids=str,
)
def test_impossible_requirements_are_refused(changed: dict[str, Any]) -> None:
    data = json.loads(persistence.dump(Document(requirements=ALL)))
    assert persistence.load(json.dumps(data)).requirements == ALL
    data["requirements"] |= changed
    with pytest.raises(InvalidInput):
        persistence.load(json.dumps(data))


def test_what_is_too_large_is_named_in_the_unit_that_is_seen() -> None:
    far, turned = (-5000.0, 0.0), (0.0, 7.5e4 * math.pi / 180)
    box, bound = Workspace(WorkspaceShape.BOX, (0.6, 0.5, 0.3)), ALL.bounds[0]
    for name, limit, held, wrong in (
        ("θ", "57295.8°", "75000°", Requirements(theta=turned)),
        ("θ", "57295.8°", "75000°", Requirements((replace(bound, theta=turned),))),
        ("z", "1·10⁶ mm", "−5·10⁶ mm", Requirements((replace(bound, z=far),))),
        ("workspace size", "1·10⁶ mm", "2·10⁶ mm",
         Requirements(workspace=replace(box, size=(0.6, 2e3, 0.3)))),
        ("workspace center", "1·10⁶ mm", "−5·10⁶ mm",
         Requirements(workspace=replace(box, center=(None, *far)))),
    ):  # fmt: skip
        with pytest.raises(InvalidInput) as caught:
            require_possible(wrong)
        problem = f"at most {limit} in size is possible, not {held}"
        assert (caught.value.argument, caught.value.problem) == (name, problem)
