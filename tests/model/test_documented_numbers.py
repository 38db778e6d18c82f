"""Every number of a design has the default and the sign that the page on design files says."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.files.design_schema import KEYS
from paminsa_viz.model import APPENDIX_4, PARAMETER
from paminsa_viz.model.parameters import LARGEST, LARGEST_OTHER, SMALLEST, SMALLEST_OF

PAGE = Path(__file__).parents[2] / "docs" / "design-file.md"


def documented() -> dict[tuple[str, str], tuple[str, str]]:
    """Default and what is allowed, by table and key."""
    found, table = {}, ""
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if heading := re.fullmatch(r"## \[+(\w+)\]+.*", line):
            table = heading[1]
        cells = [cell.strip() for cell in line.strip("| ").split(" | ")]
        if len(cells) == 5 and cells[0].startswith("`"):
            found[table, cells[0].strip("`")] = cells[3], cells[4]
    return found


DOCUMENTED = documented()
WITH_TABLE = [key for key in KEYS if (key.table, key.name) in DOCUMENTED]


def test_all_tables_of_numbers_are_on_the_page() -> None:
    missing = {key.table for key in KEYS} - {key.table for key in WITH_TABLE}
    assert missing <= {"", "accuracy", "leg1", "leg2", "leg3", "tolerances"}
    assert len(WITH_TABLE) > 90


def is_taken(path: str, number: float) -> bool:
    """Whether a number is possible, or refused for what it is beside other numbers alone."""
    try:
        APPENDIX_4.vary({path: number})
    except InvalidDesign as error:
        if "above" in str(error) or "0 or more" in str(error) or "is needed" in str(error):
            return False
        return PARAMETER[path].signed
    return True


def test_numbers_have_their_documented_defaults_and_signs() -> None:
    for key in WITH_TABLE:
        default, allowed = DOCUMENTED[key.table, key.name]
        parameter = key.parameter
        path, value = parameter.path, APPENDIX_4.value(parameter.path)
        if default == "rigid":  # a file leaves it out
            assert value == math.inf, path
        elif default != "as l_B10":
            assert float(default) == pytest.approx(value, rel=1e-5), path
        least = 1.5 if allowed == "above 1" else 10 * SMALLEST_OF.get(parameter.unit, SMALLEST)
        assert PARAMETER[path].positive == (allowed in ("above 0", "above 1")), path
        assert PARAMETER[path].signed == (allowed == "any number"), path
        assert is_taken(path, 0.0) == (allowed in ("0 or more", "any number")), path
        assert is_taken(path, -least) == (allowed == "any number"), path


def test_numbers_have_ends_beyond_which_there_is_no_machine() -> None:
    """A hundred meters, ten tons, a hundred million times the stiffness of steel."""
    for unit, path in (("m", "geometry.arm_length"), ("kg", "links.b1")):
        most = LARGEST[unit]
        assert APPENDIX_4.vary({path: most}).value(path) == most
        with pytest.raises(InvalidDesign):
            APPENDIX_4.vary({path: np.nextafter(most, np.inf)})
    assert (LARGEST["m"], LARGEST["kg"], LARGEST[""]) == (1e2, 1e4, 1e2)
    # The heaviest bar of the largest length about its center, and its weight, are no error.
    assert LARGEST["kg"] * LARGEST["m"] ** 2 / 12 < LARGEST["kg m^2"] == 1e7
    assert LARGEST["kg"] * 9.81 < LARGEST["N"] == 1e6
    assert LARGEST["kg"] * 9.81 * LARGEST["m"] / 2 < LARGEST["N m"] == 1e7
    assert {LARGEST[unit] for unit in ("Pa", "N/m", "N m/rad")} == {1e18}
    assert (LARGEST_OTHER, SMALLEST) == (1e4, 1e-6)
    assert LARGEST["m/s^2"] == pytest.approx(100 * 9.81, rel=0.02)  # a hundred times the Earth's
    assert APPENDIX_4.vary({"links.b1": 0.0}).links.b1 == 0.0
