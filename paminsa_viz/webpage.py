"""The explorer in one file, for commands and docs: an HTML page that needs no server."""

from __future__ import annotations

from paminsa_viz.model import Design
from paminsa_viz.quantities.requirements import Requirements


def design_page(design: Design, requirements: Requirements | None = None) -> str:
    """Return the page with a design, at the pose that the served page opens with.

    Args:
        design: The design.
        requirements: What the robot is needed for, which links and share codes of the page keep.

    Raises:
        InvalidInput: If the design has what the page does not know, such as counterweights, or
            there are more requirements than a share code keeps.
    """
    from paminsa_viz.explorer.core.saved_requirements import require_possible
    from paminsa_viz.explorer.features.one_file import one_file
    from paminsa_viz.explorer.page import opening_state

    if requirements is not None:
        require_possible(requirements)
    return one_file(opening_state(design, requirements).document)


def code_design(code: str) -> Design:
    """Return the design that a share code describes.

    Raises:
        PaminsaError: If the code is none or damaged.
    """
    from paminsa_viz.explorer.core.persistence import open_share_code

    return open_share_code(code).design


def code_page(code: str) -> str:
    """Return the page with what a share code describes.

    Raises:
        PaminsaError: If the code is none or damaged, or has what the page does not know.
    """
    from paminsa_viz.explorer.core.persistence import open_share_code
    from paminsa_viz.explorer.features.one_file import one_file

    return one_file(open_share_code(code))
