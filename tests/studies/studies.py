"""Studies that tests run."""

from __future__ import annotations

from dataclasses import replace

from paminsa_viz.model import (
    APPENDIX_4,
)
from paminsa_viz.studies import (
    METRICS,
    DesignAxis,
    DesignGrid,
    DesignRange,
    RandomDesigns,
    Study,
    default_region,
)
from paminsa_viz.trajectory import PRESET

NAMES = [metric.column for metric in METRICS]
GRID = DesignGrid(
    (DesignAxis("links.b3", (0.2, 0.4)), DesignAxis("geometry.coupler_length", (0.1, 0.5, 0.63)))
)
SMALL = Study(APPENDIX_4, GRID, replace(default_region(APPENDIX_4), cells=8))
RANDOM = replace(
    SMALL,
    variation=RandomDesigns(
        (
            DesignRange("joints.j7", 0.1, 0.5),
            DesignRange.around(APPENDIX_4, "geometry.base_radius", 0.5),
        ),
        40,
        seed=3,
    ),
)


MOTION = PRESET["arch"].build(APPENDIX_4.geometry).sample(200.0)
MOVED = replace(
    RANDOM,
    trajectory=MOTION,
    variation=RandomDesigns(
        (
            DesignRange("joints.j7", 0.1, 0.5),
            DesignRange("friction.coulomb_rotary", 0.0, 0.5),
            DesignRange("geometry.base_radius", 0.15, 0.7),
        ),
        40,
        seed=1,
    ),
)
