"""The list of a design's numbers against Appendix 4, retyped here."""

from __future__ import annotations

from dataclasses import fields

from paminsa_viz.model import APPENDIX_4, PARAMETER, PARAMETERS
from paminsa_viz.model.load import WRENCH

APPENDIX_4_RETYPED = {
    "k": 3.0, "R_b": 0.35, "R_pl": 0.1, "l_B1": 0.308, "l_B2": 0.442, "l_B3 = l_B8": 0.42,
    "l_B4 = k l_B7": 0.63, "l_B5": 0.0275, "l_B10": 0.3635,
    "m_2": 0.214, "m_3": 0.338, "m_4": 0.262, "m_5": 0.233, "m_7": 0.28, "m_8": 0.305,
    "m_9": 0.259, "m_pl": 2.301,
    "m_B1": 1.221, "m_B2": 0.921, "m_B3": 0.406, "m_B4": 0.672, "m_B7": 0.107, "m_B8": 0.403,
    "m_B10": 0.436,
    "I_XX^(B3)": 0.0038, "I_YY^(B3)": 0.02, "I_XX^(B4)": 0.0012, "I_YY^(B4)": 0.048,
    "I_XX^(B7)": 8e-4, "I_YY^(B7)": 0.003, "I_XX^(B8)": 0.0024, "I_YY^(B8)": 0.02,
    "I_B2": 0.003, "I_B10": 0.02, "I_pl": 0.015,
    "g": 9.81,
}  # fmt: skip
"""Appendix 4 (and g from Appendix 3), by the paper's symbols."""

NOT_IN_THE_PAPER = {
    "geometry.guide_stroke": 0.3635,
    "geometry.axis_clearance": 0.0,
    "payload.mass": 0.0,
    "payload.inertia": 0.0,
    "friction.viscous_rotary": 0.0,
    "friction.coulomb_rotary": 0.0,
    "friction.viscous_linear": 0.0,
    "friction.coulomb_linear": 0.0,
    "friction.transition_speed": 1e-3,
    **{f"load.{name}": 0.0 for name in WRENCH},
    **{f"load.point_{axis}": 0.0 for axis in "xyz"},
}
"""What the paper leaves out or does not have, at values that change nothing of the paper."""


def test_the_default_is_appendix_4() -> None:
    of_the_paper = {p.symbol: p.default for p in PARAMETERS if p.path not in NOT_IN_THE_PAPER}
    assert of_the_paper == APPENDIX_4_RETYPED
    assert {p: PARAMETER[p].default for p in NOT_IN_THE_PAPER} == NOT_IN_THE_PAPER


def test_every_number_of_a_design_is_listed_once() -> None:
    found = []
    for item in fields(APPENDIX_4):
        value = getattr(APPENDIX_4, item.name)
        if hasattr(value, "__dataclass_fields__"):
            found += [f"{item.name}.{inner.name}" for inner in fields(value)]
        elif item.name not in ("name", "counterweights", "drives"):
            found.append(item.name)
    for choice in ("geometry.knee", "load.frame"):
        found.remove(choice)  # no number
    assert [p.path for p in PARAMETERS] == found
    assert list(PARAMETER) == found
    assert all(PARAMETER[p.path] is p for p in PARAMETERS)


def test_every_number_can_be_shown_to_a_person() -> None:
    assert all(p.label and p.symbol for p in PARAMETERS)
    assert (
        len({p.symbol for p in PARAMETERS}) == len({p.label for p in PARAMETERS}) == len(PARAMETERS)
    )
    units = {"joints": {"kg"}, "links": {"kg"}, "inertias": {"kg m^2"}, "geometry": {"", "m"}}
    for p in PARAMETERS:
        assert p.unit in units.get(p.group, {p.unit})
        assert bool(p.unit) == (p.symbol != "k")
    assert {p.path: p.unit for p in PARAMETERS if p.group in ("platform", "payload", "design")} == {
        "platform.mass": "kg",
        "platform.inertia": "kg m^2",
        "payload.mass": "kg",
        "payload.inertia": "kg m^2",
        "gravity": "m/s^2",
    }


def test_groups_are_the_fields_of_a_design() -> None:
    others = ("gravity", "name", "counterweights", "drives")
    names = [item.name for item in fields(APPENDIX_4) if item.name not in others]
    assert list(dict.fromkeys(p.group for p in PARAMETERS)) == [*names, "design"]
    assert PARAMETER["gravity"].group == "design"
