"""The volume as a file to download."""

from __future__ import annotations

from paminsa_viz.explorer.exports import File, plain
from paminsa_viz.explorer.state import State
from paminsa_viz.files.tables import TABLE_FORMATS

VOLUME_KINDS = ("stl", "glb", *TABLE_FORMATS)
"""Endings of the files, see `synthesis.volume.surface.VOLUME_FORMATS`."""


def volume_file(state: State, kind: str) -> File:
    """Write the volume where all requirements hold, finely sampled.

    Raises:
        InvalidInput: If it is empty and has no surface to write.
    """
    from paminsa_viz.synthesis.volume.solve import solve_volume
    from paminsa_viz.synthesis.volume.surface import volume_bytes  # loads SciPy

    document, known = state.document, state.requiring.fine
    if known is not None and known.result is not None and known.job.serves(document):
        volume = known.result.volume
    else:
        volume = solve_volume(document.design, document.requirements)
    parts = ("paminsa", plain(document.design.name), "volume")
    return File("_".join(part for part in parts if part) + f".{kind}", volume_bytes(volume, kind))
