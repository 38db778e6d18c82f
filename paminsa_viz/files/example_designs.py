"""Designs that come with the program, made by ``assets/make_designs.py``."""

from __future__ import annotations

from enum import Enum
from functools import cache
from importlib.resources import files

from paminsa_viz.checks import kinds_checked
from paminsa_viz.files.design_file import read_design
from paminsa_viz.model import APPENDIX_4, Design


class ExampleDesign(Enum):
    """The designs; values are the names of the files, empty for `APPENDIX_4`."""

    APPENDIX_4 = ""
    """The paper's prototype."""
    BALANCED = "example_balanced.toml"
    """The same, statically balanced by masses of the least weight (Eqs. 7-8)."""
    PAYLOAD = "example_payload.toml"
    """Balanced, with 10 kg on the platform, and drives that carry it on the preset motion."""
    COMPACT = "example_compact.toml"
    """The least footprint and bars for a cylinder r 100 x 200 mm, theta up to 30 deg; balanced."""


@kinds_checked
@cache
def example_design(kind: ExampleDesign) -> Design:
    """Return a design that comes with the program."""
    if kind is ExampleDesign.APPENDIX_4:
        return APPENDIX_4
    content = files("paminsa_viz.files").joinpath(kind.value).read_bytes()
    return read_design(content, kind.value)
