"""Robots whose code is tried: with all that the code knows of, and of other sizes."""

from __future__ import annotations

from dataclasses import replace

from paminsa_viz.model import APPENDIX_4, Design, Drive, KneeBranch, LoadCase, LoadFrame
from paminsa_viz.model.lumped import MASS_PATHS
from paminsa_viz.model.statics import BODIES
from tests.support.samples import enlarged, prototype_times


def loaded_robot() -> Design:
    """A robot with everything that the header knows of: drives, friction, load, payload."""
    drive = Drive(rotor_inertia=2e-5, gear_ratio=80.0, viscous=1e-5, coulomb=2e-3)
    lift = replace(drive, transmission="screw", lead=0.01)
    load = LoadCase(5.0, -3.0, -20.0, 0.3, 0.2, 0.7, 0.05, -0.02, 0.1, LoadFrame.PLATFORM)
    design = APPENDIX_4.vary(
        {"payload.mass": 3.0, "payload.inertia": 0.01, "friction.coulomb_rotary": 0.4}
    )
    return replace(design, drives=(drive, None, drive, lift), load=load)


WEIGHTLESS = APPENDIX_4.vary({path: 0.0 for path in MASS_PATHS if path != "platform.mass"})

DESIGNS = {
    "appendix-4": APPENDIX_4,
    "upper-knee": APPENDIX_4.with_knee(KneeBranch.UPPER),
    "loaded": loaded_robot(),
    # never singular in some places, however it turns: that distance is infinite
    "wide-platform": APPENDIX_4.vary(
        {"geometry.base_radius": 0.15, "geometry.platform_radius": 0.33}
    ),
    # joints 5 on posts: with the upper knee the platform itself hangs below the guides
    # nothing resists a turn of the platform: no torque makes a finite acceleration
    "weightless": WEIGHTLESS,
    "posts": APPENDIX_4.with_knee(KneeBranch.UPPER).vary({"geometry.platform_joint_height": 1.2}),
}

_TOY = enlarged(APPENDIX_4, 0.003)
HEAVY_TOY = _TOY.vary({path: 100.0 * _TOY.value(path) for path in BODIES})

SIZES = {
    "twentieth": prototype_times(0.05),
    "fifth": prototype_times(0.2),
    "five": prototype_times(5.0),
    # of millimeters, where gravity makes angular accelerations of some thousand rad/s^2
    "heavy-toy": HEAVY_TOY,
}
