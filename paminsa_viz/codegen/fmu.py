"""The robot as Functional Mock-up Units (FMI 2.0, co-simulation) for Simulink, Modelica and others.

``plant`` is the robot moved by its actuators, ``inverse`` the torques that a motion asks for, a
block without states. Both are C around the controller kit's header; the sources are inside, with
the binary of the platform that wrote them.
"""

from __future__ import annotations

import os
import shutil
import sys
import uuid
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from importlib.resources import files
from typing import Literal, NamedTuple

import numpy as np

from paminsa_viz.codegen.add_platform import NotBuilt, with_platform
from paminsa_viz.codegen.kit import design_header, header, template
from paminsa_viz.engines.poses import start_pose
from paminsa_viz.errors import InvalidInput, PaminsaError, printable
from paminsa_viz.files.archives import zipped
from paminsa_viz.model.accuracy import noting_equal_legs
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.model.statics import static_torques
from paminsa_viz.version import MADE_BY

FmuKind = Literal["plant", "inverse"]

STEP_MAX = 1e-4
"""Largest step of the plant's integration [s]."""

DESCRIPTIONS: dict[FmuKind, str] = {
    "plant": "PAMINSA moved by its actuators: torques in; pose, actuators and rates out",
    "inverse": "PAMINSA's actuator torques for a motion of the platform",
}


class NoCompiler(PaminsaError):
    """There is no C compiler, or it fails."""


class FmuVariable(NamedTuple):
    """A real variable; its value reference is its place in the list."""

    name: str
    unit: str
    description: str
    start: float | None = None


class _Variables(NamedTuple):
    """Variables in the order of their value references."""

    inputs: list[FmuVariable]
    tunable: list[FmuVariable]
    fixed: list[FmuVariable]
    outputs: list[FmuVariable]

    @property
    def set_by_user(self) -> list[FmuVariable]:
        return [*self.inputs, *self.tunable, *self.fixed]


@of_design
def build_fmu(design: Design, kind: FmuKind) -> bytes:
    """Return an FMU with its sources and the binary of this platform.

    Args:
        design: The robot.
        kind: ``plant`` or ``inverse``.

    Raises:
        InvalidInput: If there is no such kind.
        NoCompiler: If there is no C compiler (``cc``, ``gcc``, ``clang``, or ``CC`` of the
            environment), or it fails.
        UnreachablePose: If the design has no regular configuration at the center, where it starts.
    """
    if kind not in DESCRIPTIONS:
        raise InvalidInput("kind", f"{' or '.join(DESCRIPTIONS)} is needed, not {kind!r}")
    packed = zipped({name: text.encode() for name, text in fmu_sources(design, kind).items()})
    compiler = os.environ.get("CC") or next(filter(shutil.which, ("cc", "gcc", "clang")), None)
    if compiler is None:
        raise NoCompiler("an FMU needs a C compiler: install gcc or clang, or name one in CC")
    try:
        return with_platform(packed, _platform(), compiler)
    except NotBuilt as error:
        raise NoCompiler(str(error)) from None


def fmu_sources(design: Design, kind: FmuKind) -> dict[str, str]:
    """Return the texts inside an FMU by their names; arguments and errors as of `build_fmu`."""
    name = f"paminsa_{kind}"
    variables = _variables(design, kind)
    sources = {
        f"{name}.c": template(f"{kind}.c"),
        "fmu.h": template("fmu.h"),
        "paminsa.h": header(),
        "design.h": design_header(design),
    }
    guid = uuid.uuid5(uuid.NAMESPACE_URL, repr((name, variables, sources)))
    sources["model.h"] = _model_header(variables, f"{{{guid}}}")
    about = f'{DESCRIPTIONS[kind]}; design "{printable(design.name)}"'
    about = noting_equal_legs(about, design.deviations)
    described = _description(kind, about, variables, f"{{{guid}}}", list(sources))
    return {
        "modelDescription.xml": described,
        **{f"sources/{name}": text for name, text in sources.items()},
    }


def fmu_folder(design: Design, kinds: Iterable[FmuKind]) -> dict[str, str | bytes]:
    """Return the kit's folder of FMUs: contents by name, with the program for other platforms.

    Raises:
        NoCompiler, UnreachablePose: As `build_fmu`.
    """
    script = (files("paminsa_viz.codegen") / "add_platform.py").read_text(encoding="utf-8")
    made = {f"fmu/paminsa_{kind}.fmu": build_fmu(design, kind) for kind in kinds}
    return {**made, "fmu/add_platform.py": script}


def _platform() -> str:
    system = {"win32": "win", "darwin": "darwin"}.get(sys.platform, "linux")
    return f"{system}{64 if sys.maxsize > 2**32 else 32}"


_POSE = (("x", "m"), ("y", "m"), ("theta", "rad"), ("z", "m"))
_ACTUATORS = (("theta_1", "rad"), ("theta_2", "rad"), ("theta_3", "rad"), ("lift", "m"))
_TORQUES = (("tau_1", "N.m"), ("tau_2", "N.m"), ("tau_3", "N.m"), ("F_4", "N"))


def _variables(design: Design, kind: FmuKind) -> _Variables:
    pose = start_pose(design)
    held = static_torques(design, pose)
    if not measure_singularity(design.geometry, pose).condition < np.inf:
        held = np.zeros(4)

    def coordinates(
        what: str, after: str = "", per: str = "", start: list[float] | None = None
    ) -> list[FmuVariable]:
        starts = start or [None] * 4
        return [
            FmuVariable(name + after, unit + per, f"{what} of the platform in {name}", value)
            for (name, unit), value in zip(_POSE, starts, strict=True)
        ]

    def actuators(what: str, after: str = "", per: str = "") -> list[FmuVariable]:
        return [
            FmuVariable(name + after, unit + per, f"{what} of {motor}")
            for (name, unit), motor in zip(_ACTUATORS, ACTUATORS, strict=True)
        ]

    def torques(start: list[float] | None = None) -> list[FmuVariable]:
        starts = start or [None] * 4
        return [
            FmuVariable(name, unit, f"{'Force' if unit == 'N' else 'Torque'} of {motor}", value)
            for (name, unit), motor, value in zip(_TORQUES, ACTUATORS, starts, strict=True)
        ]

    payload = [
        FmuVariable("payload_mass", "kg", "Mass of the payload", design.payload.mass),
        FmuVariable(
            "payload_inertia", "kg.m2", "Inertia of the payload about the vertical",
            design.payload.inertia,
        ),
    ]  # fmt: skip
    nothing = [0.0, 0.0, 0.0, 0.0]
    if kind == "inverse":
        motion = coordinates("Position", start=pose.tolist())
        motion += coordinates("Rate", "_rate", "/s", nothing)
        motion += coordinates("Acceleration", "_acceleration", "/s2", nothing)
        return _Variables(motion, payload, [], torques() + actuators("Position"))
    fixed = coordinates("Position at the start", "_start", start=pose.tolist())
    fixed += coordinates("Rate at the start", "_rate_start", "/s", nothing)
    fixed.append(FmuVariable("step_max", "s", "Largest step of the integration", STEP_MAX))
    outputs = coordinates("Position") + coordinates("Rate", "_rate", "/s")
    outputs += actuators("Position") + actuators("Speed", "_rate", "/s")
    return _Variables(torques(held.tolist()), payload, fixed, outputs)


def _model_header(variables: _Variables, guid: str) -> str:
    known = variables.set_by_user
    names = [variable.name.upper() for variable in (*known, *variables.outputs)]
    starts = ", ".join(repr(float(variable.start or 0.0)) for variable in known)
    first_fixed = len(variables.inputs) + len(variables.tunable)
    listed = "\n".join(f"    {name}," for name in names)
    return (
        "/* model.h: the variables of modelDescription.xml by their value references. */\n"
        f'#define GUID "{guid}"\n#define FIRST_FIXED {first_fixed}\n'
        f"#define FIRST_OUTPUT {len(known)}\n#define START {{{starts}}}\n\n"
        f"enum {{\n{listed}\n    COUNT\n}};\n"
    )


_UNITS: dict[str, dict[str, int]] = {
    "m": {"m": 1}, "m/s": {"m": 1, "s": -1}, "m/s2": {"m": 1, "s": -2},
    "rad": {"rad": 1}, "rad/s": {"rad": 1, "s": -1}, "rad/s2": {"rad": 1, "s": -2},
    "s": {"s": 1}, "kg": {"kg": 1}, "kg.m2": {"kg": 1, "m": 2},
    "N": {"kg": 1, "m": 1, "s": -2}, "N.m": {"kg": 1, "m": 2, "s": -2},
}  # fmt: skip
"""Exponents of the base units."""


def _description(
    kind: FmuKind, about: str, variables: _Variables, guid: str, sources: list[str]
) -> str:
    """Return modelDescription.xml."""
    name = f"paminsa_{kind}"
    root = ET.Element(
        "fmiModelDescription", fmiVersion="2.0", modelName=name, guid=guid,
        description=about, generationTool=MADE_BY, variableNamingConvention="flat",
    )  # fmt: skip
    cosimulation = ET.SubElement(
        root, "CoSimulation", modelIdentifier=name, canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUstate="true", canSerializeFMUstate="true",
    )  # fmt: skip
    listed = ET.SubElement(cosimulation, "SourceFiles")
    for source in sources:
        if source.endswith(".c"):
            ET.SubElement(listed, "File", name=source)
    units = ET.SubElement(root, "UnitDefinitions")
    every = (*variables.set_by_user, *variables.outputs)
    for unit in sorted({variable.unit for variable in every}):
        base = ET.SubElement(ET.SubElement(units, "Unit", name=unit), "BaseUnit")
        for key, value in _UNITS[unit].items():
            base.set(key, str(value))
    ET.SubElement(root, "DefaultExperiment", startTime="0", stopTime="1", stepSize="0.001")
    model = ET.SubElement(root, "ModelVariables")
    kinds = [
        (variables.inputs, "input", "continuous"), (variables.tunable, "parameter", "tunable"),
        (variables.fixed, "parameter", "fixed"), (variables.outputs, "output", "continuous"),
    ]  # fmt: skip
    reference = 0
    for group, causality, variability in kinds:
        for variable in group:
            scalar = ET.SubElement(
                model, "ScalarVariable", name=variable.name, valueReference=str(reference),
                causality=causality, variability=variability, description=variable.description,
            )  # fmt: skip
            if causality != "input":
                scalar.set("initial", "exact" if causality == "parameter" else "calculated")
            real = ET.SubElement(scalar, "Real", unit=variable.unit)
            if variable.start is not None:
                real.set("start", repr(float(variable.start)))
            if variable in variables.tunable:
                real.set("min", "0")
            reference += 1
    status = ET.SubElement(
        model, "ScalarVariable", name="status", valueReference="0", causality="output",
        variability="discrete", initial="calculated",
        description="0: all is well; else why not, a PaminsaStatus of paminsa.h",
    )  # fmt: skip
    ET.SubElement(status, "Integer")
    structure = ET.SubElement(root, "ModelStructure")
    first = len(variables.set_by_user) + 1
    for part in ("Outputs", "InitialUnknowns"):
        found = ET.SubElement(structure, part)
        for index in range(first, reference + 2):
            ET.SubElement(found, "Unknown", index=str(index))
    ET.indent(root)
    return ET.tostring(root, encoding="unicode", xml_declaration=True) + "\n"
