"""The design that a command line names: a file's, or the paper's."""

from __future__ import annotations

from pathlib import Path

from paminsa_viz.explorer.bounds import validate_limits
from paminsa_viz.files.design_file import load_design
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.model.design import APPENDIX_4, Design
from paminsa_viz.model.errors import InvalidDesign


def design_of(file: Path | None) -> Design:
    """Return a file's design, or Appendix 4's without one.

    Raises:
        DesignFileError: If the file cannot be read, is refused, or has numbers of a size that can
            not be worked with.
    """
    if file is None:
        return APPENDIX_4
    try:
        return validate_limits(load_design(file))
    except InvalidDesign as error:
        raise DesignFileError(str(file), str(error)) from error
