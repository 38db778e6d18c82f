"""The description of an FMU's model: variables, their units, starts and roles, and its GUID."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from paminsa_viz.codegen import fmu
from paminsa_viz.codegen.fmu import STEP_MAX, FmuKind, fmu_sources
from paminsa_viz.engines.poses import start_pose
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Drive,
    KneeBranch,
    LoadCase,
    LoadFrame,
    measure_singularity,
    singular_rotation,
    static_torques,
)
from tests.codegen.test_kit import loaded_robot

DRIVEN = replace(
    APPENDIX_4.vary({"friction.viscous_rotary": 0.3, "payload.mass": 1.0}),
    drives=(Drive(rotor_inertia=2e-5, gear_ratio=80.0), None, None, None),
    load=LoadCase(5.0, -3.0, -20.0, 0.3, 0.2, 0.7, 0.05, -0.02, 0.1, LoadFrame.PLATFORM),
)
"""Drives, friction and a load, but no Coulomb friction, whose steep step DOP853 takes long for."""

KINDS: tuple[FmuKind, ...] = get_args(FmuKind)
TORQUES = ("tau_1", "tau_2", "tau_3", "F_4")
POSE = ("x", "y", "theta", "z")
ACTUATORS = ("theta_1", "theta_2", "theta_3", "lift")
RATES = tuple(f"{name}_rate" for name in POSE)


def described(design: Design, kind: FmuKind) -> ET.Element:
    return ET.fromstring(fmu_sources(design, kind)["modelDescription.xml"])


@pytest.mark.parametrize("kind", KINDS)
def test_description_says_what_is_left_out_of_the_legs(kind: FmuKind) -> None:
    plain = described(DRIVEN, kind).attrib["description"]
    note = described(DRIVEN.vary({"leg1.bar_43": 2e-4}), kind).attrib["description"]
    assert "legs" not in plain
    assert note == f"{plain}; legs are equal, the design's deviations of single legs are left out"


def test_description_names_the_design() -> None:
    for kind in KINDS:
        named = described(replace(APPENDIX_4, name='Arm "2" <ä>\x01'), kind)
        assert named.attrib["description"].endswith('; design "Arm "2" <ä>?"')


def test_files_to_be_compiled_are_listed() -> None:
    """An importer that builds the binary itself compiles these, and takes the rest as headers."""
    for kind in KINDS:
        inside = fmu_sources(APPENDIX_4, kind)
        root = ET.fromstring(inside["modelDescription.xml"])
        listed = [one.attrib["name"] for one in root.findall("CoSimulation/SourceFiles/File")]
        assert [f"sources/{name}" for name in listed] == [n for n in inside if n.endswith(".c")]


@pytest.mark.parametrize("kind", KINDS)
def test_variables_have_references_starts_and_roles(kind: FmuKind) -> None:
    """Inputs, payload and fixed numbers first, with starts; a plant starts where it is held."""
    design = DRIVEN
    root, pose = described(design, kind), start_pose(design)
    found = {}
    for number, variable in enumerate(root.iter("ScalarVariable")):
        real = variable.find("Real")
        role = variable.attrib["causality"], variable.attrib["variability"]
        if real is None:
            assert (variable.attrib["name"], number) == ("status", len(found))
            assert role == ("output", "discrete")
            continue
        assert variable.attrib["valueReference"] == str(number)
        found[variable.attrib["name"]] = role, variable.attrib.get("initial"), real.attrib
    rates = tuple(f"{name}_rate" for name in ACTUATORS)
    still = [0.0] * 4
    load = design.payload
    tunable = dict(zip(("payload_mass", "payload_inertia"), (load.mass, load.inertia), strict=True))
    fixed: dict[str, float] = {}
    if kind == "plant":
        inputs = dict(zip(TORQUES, static_torques(design, pose), strict=True))
        starts = [f"{name}_start" for name in (*POSE, *RATES)]
        fixed = dict(zip(starts, [*pose, *still], strict=True)) | {"step_max": STEP_MAX}
        outputs = (*POSE, *RATES, *ACTUATORS, *rates)
    else:
        moving = [*POSE, *RATES, *(f"{name}_acceleration" for name in POSE)]
        inputs = dict(zip(moving, [*pose, *still, *still], strict=True))
        outputs = (*TORQUES, *ACTUATORS)
    assert list(found) == [*inputs, *tunable, *fixed, *outputs]
    for group, role, initial in (
        (inputs, ("input", "continuous"), None), (tunable, ("parameter", "tunable"), "exact"),
        (fixed, ("parameter", "fixed"), "exact"),
    ):  # fmt: skip
        for name, start in group.items():
            assert found[name][:2] == (role, initial)
            assert float(found[name][2]["start"]) == start
            assert ("min" in found[name][2]) == (group is tunable)
    for name in outputs:
        assert found[name][:2] == (("output", "continuous"), "calculated")
        assert "start" not in found[name][2]
    for part in root.findall("ModelStructure/*"):  # from 1; the status is one of them
        places = [int(unknown.attrib["index"]) for unknown in part]
        first = len(inputs) + len(tunable) + len(fixed) + 1
        assert places == list(range(first, first + len(outputs) + 1))
    header = fmu_sources(design, kind)["sources/model.h"]
    defined = dict(re.findall(r"#define (\w+) (.*)", header))
    assert int(defined["FIRST_FIXED"]) == len(inputs) + len(tunable)
    assert int(defined["FIRST_OUTPUT"]) == len(inputs) + len(tunable) + len(fixed)
    listed = [float(number) for number in defined["START"].strip("{}").split(",")]
    assert listed == [*inputs.values(), *tunable.values(), *fixed.values()]
    names = re.findall(r"^    (\w+),?$", header, re.MULTILINE)
    assert names == [*(name.upper() for name in found), "COUNT"]


def test_a_plant_that_starts_at_a_singularity_is_not_held(monkeypatch: pytest.MonkeyPatch) -> None:
    lower = np.array([0.0, 0.0, singular_rotation(DRIVEN.geometry), start_pose(DRIVEN)[3]])
    assert measure_singularity(DRIVEN.geometry, lower).condition == np.inf
    monkeypatch.setattr(fmu, "start_pose", lambda _: lower)
    text = fmu_sources(DRIVEN, "plant")["modelDescription.xml"]
    assert text.startswith("<?xml version")
    root = ET.fromstring(text)
    starts = {one.attrib["name"]: one[0].attrib.get("start") for one in root.iter("ScalarVariable")}
    assert [starts[name] for name in TORQUES] == ["0.0"] * 4
    assert [float(starts[f"{name}_start"] or "nan") for name in POSE] == lower.tolist()


def test_another_design_has_another_guid() -> None:
    def guid(design: Design, kind: FmuKind = "plant") -> str:
        text = fmu_sources(design, kind)["modelDescription.xml"]
        return text.partition('guid="')[2].partition('"')[0]

    robots = [APPENDIX_4, APPENDIX_4.with_knee(KneeBranch.UPPER), loaded_robot()]
    assert len({guid(APPENDIX_4, "inverse"), *map(guid, robots)}) == 4
    assert guid(APPENDIX_4) == guid(APPENDIX_4.vary({}))


def test_units_are_products_of_the_base_units() -> None:
    bases = {"m": {"m": 1}, "rad": {"rad": 1}, "s": {"s": 1}, "kg": {"kg": 1}}
    bases["N"] = {"kg": 1, "m": 1, "s": -2}
    for kind in KINDS:
        units = list(described(APPENDIX_4, kind).iter("Unit"))
        names = [unit.attrib["name"] for unit in units]
        assert names == sorted(set(names))  # the same file whenever it is written
        for unit in units:
            over, _, under = unit.attrib["name"].partition("/")
            expected: dict[str, int] = {}
            for sign, factors in ((1, over.split(".")), (-1, under.split("."))):
                for factor in filter(None, factors):
                    name = factor.rstrip("2")
                    for base, power in bases[name].items():
                        times = 2 if factor.endswith("2") else 1
                        expected[base] = expected.get(base, 0) + sign * power * times
            (base_unit,) = unit
            assert {key: int(power) for key, power in base_unit.attrib.items()} == expected
