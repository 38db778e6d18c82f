"""The explorer in one file, for commands and docs: an HTML page that needs no server."""

from __future__ import annotations

from paminsa_viz.model import Design


def design_page(design: Design) -> str:
    """Return the page with a design, at the pose that the served page opens with.

    Raises:
        InvalidInput: If the design has what the page does not know, such as counterweights.
    """
    from paminsa_viz.explorer.features.one_file import one_file
    from paminsa_viz.explorer.page import opening_state

    return one_file(opening_state(design).document)


def code_page(code: str) -> str:
    """Return the page with what a share code describes.

    Raises:
        PaminsaError: If the code is none or damaged, or has what the page does not know.
    """
    from paminsa_viz.explorer.core.persistence import open_share_code
    from paminsa_viz.explorer.features.one_file import one_file

    return one_file(open_share_code(code))
