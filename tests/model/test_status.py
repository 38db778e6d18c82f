"""Every result that may have no value says so in one form: status, leg, ok, reason."""

from __future__ import annotations

import inspect
from dataclasses import is_dataclass, replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, Limit, Status, WithStatus, check_reach, solve_field
from paminsa_viz.model.grids import Grid
from paminsa_viz.precision import Bound, Closure, UnequalPose, drive_errors
from tests.test_api import CALLABLES

RESULTS = sorted(
    {
        value for value in CALLABLES.values()
        if inspect.isclass(value) and is_dataclass(value)
        and "NDArray[np.uint8]" in str(value.__annotations__.get("status"))
    },
    key=lambda kind: kind.__name__,
)  # fmt: skip
"""Public results with a code of why there is no value."""

OTHER_WORDS = ("bound", "closure", "valid", "stable", "good")
"""How results have said it before."""


def test_results_with_a_status_have_one_form() -> None:
    assert len(RESULTS) >= 8
    assert [kind.__name__ for kind in RESULTS if not issubclass(kind, WithStatus)] == ["MapData"]
    for kind in RESULTS:
        assert not any(isinstance(getattr(kind, name, None), property) for name in OTHER_WORDS)


def test_no_public_result_has_another_mask() -> None:
    for place, kind in CALLABLES.items():
        if not (inspect.isclass(kind) and is_dataclass(kind)):
            continue
        for name, annotation in kind.__annotations__.items():
            mask = "bool_" in str(annotation) or "uint8" in str(annotation)
            assert not (mask and name in OTHER_WORDS), f"{place}.{name}"


@pytest.mark.parametrize("kind", [Limit, Bound, Closure])
def test_codes_start_with_a_value_and_give_their_reasons(kind: type[Status]) -> None:
    codes: list[Any] = list(kind.__members__.values())
    assert [code.value for code in codes] == list(range(len(codes)))
    assert codes[0].name == "OK"
    for code in codes:
        assert "{" not in code.reason()
        assert "leg 2" not in code.reason()
        if "{leg}" in code._reason:
            assert code.reason(1).count("leg 2") == 1


def test_a_result_gives_the_reason_of_a_place_and_none_where_there_is_a_value() -> None:
    line = np.linspace(-0.6, 0.6, 41)
    found = solve_field(APPENDIX_4.geometry, Grid.over((0.0, 0.0, 0.3, -0.5), x=line, y=line))
    np.testing.assert_array_equal(found.ok, found.status == Limit.OK)
    said = set()
    for place in np.ndindex(found.status.shape):
        reason = found.reason(place)
        assert (reason == "") == found.ok[place]
        limit, leg = Limit(int(found.status[place])), int(found.leg[place])
        assert reason == ("" if limit is Limit.OK else limit.reason(leg))
        said.add(reason)
    assert len(said) >= 4
    far = drive_errors(APPENDIX_4.geometry, APPENDIX_4.accuracy, (5.0, 0.0, 0.0, -0.5))
    leg = int(check_reach(APPENDIX_4.geometry, (5.0, 0.0, 0.0, -0.5)).leg) + 1
    assert far.reason() == f"the pose is out of reach of leg {leg}"
    assert not far.ok


def test_the_reason_of_a_result_without_legs() -> None:
    status = np.array([Closure.OK, Closure.OPEN], np.uint8)
    poses = UnequalPose(*(np.zeros((2, n)) for n in (4, 2, 3, 4)), status=status)
    assert poses.reason(0) == ""
    assert poses.reason(1) == Closure.OPEN.reason()
    assert replace(poses, status=status[::-1]).ok.tolist() == [False, True]
