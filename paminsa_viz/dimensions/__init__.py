"""What the bodies measure and where they are: read by what draws them and by what checks them.

`layers` holds the sizes of a leg's bodies and of the machine's fixed parts, `layout` the heights
of the frame, `attached` the sizes of payload and counterweights, `placement` where every body is
in a configuration. Lengths in meters.
"""

from __future__ import annotations

from paminsa_viz.dimensions.layout import FrameLayout
from paminsa_viz.dimensions.needs import missing_room, needed_guide, needed_shaft
from paminsa_viz.dimensions.placement import BODIES, Placement, place_parts

__all__ = [
    "BODIES",
    "FrameLayout",
    "Placement",
    "missing_room",
    "needed_guide",
    "needed_shaft",
    "place_parts",
]
