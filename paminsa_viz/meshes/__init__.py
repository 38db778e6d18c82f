"""The robot's shape: parts, bodies made to the design's lengths, and their placement.

`make_body` gives a body in its own frame, `place_parts` says where each is, `assemble_glb` puts the
posed robot into one file. The fixed parts are mesh files that ``assets/make_parts.py`` writes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from paminsa_viz.dimensions.layout import FrameLayout, layout
from paminsa_viz.dimensions.placement import BODIES, Placement, place_parts
from paminsa_viz.late import late_names

if TYPE_CHECKING:  # trimesh takes half a second, which lengths alone do not need
    from paminsa_viz.meshes.bodies import (
        STANDING,
        body_glb,
        color_of,
        lengths_of,
        make_body,
        prepare,
    )
    from paminsa_viz.meshes.part import MeshPart, MissingMeshes, fixed_part
    from paminsa_viz.meshes.robot_files import assemble_glb

__all__ = [
    "BODIES",
    "STANDING",
    "FrameLayout",
    "MeshPart",
    "MissingMeshes",
    "Placement",
    "assemble_glb",
    "body_glb",
    "color_of",
    "fixed_part",
    "layout",
    "lengths_of",
    "make_body",
    "place_parts",
    "prepare",
]

__getattr__ = late_names(__name__)
