"""Words, marks and data of searches and sweeps that are made up.

No two numbers are alike, so that each cell can be told from all others.
"""

from __future__ import annotations

import math
from collections import Counter
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.blocks import answer_checks, requirements, synthesis
from paminsa_viz.blocks.data import plain
from paminsa_viz.blocks.excitation import excitation_blocks, excitation_data, limits_table
from paminsa_viz.blocks.sweep import sweep_blocks, sweep_data
from paminsa_viz.identification.excitation import KeptLimit
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.studies.metrics import RUNS
from paminsa_viz.studies.study import OK
from paminsa_viz.synthesis import Buildability
from paminsa_viz.synthesis.proof.evidence import Verdict
from paminsa_viz.synthesis.search.case import Regime
from paminsa_viz.synthesis.search.result import BoundOutcome
from paminsa_viz.synthesis.volume.causes import CauseKind, VolumeCause
from paminsa_viz.trajectory import PRESET
from paminsa_viz.units import NONE
from tests.blocks.said import cells, said

PLACE = Workspace(WorkspaceShape.BOX, (0.2, 0.1, 0.3), (0.01, 0.02, -0.5))
CONDITION = Requirement("condition", high=8.0)
TORQUE = Requirement("max_torque", high=15.0)

# --------------------------------------------------------------------------------------- synthesis


def built(**changes: Any) -> Buildability:
    values: dict[str, Any] = {
        "center": (0.0, 0.0, -0.61), "within_reach": 1.0, "clearance": 0.012,
        "bodies": ("arm", "guide"), "worst": np.array([0.1, 0.2, 0.3, -0.4]), "overlapping": 0.0,
        "stiffness": 21e3, "frequency": 7.5, "guide": 0.5, "needed_guide": 0.4, "shaft": 0.9,
        "needed_shaft": 0.8, "moving_mass": 33.0,
    }  # fmt: skip
    return Buildability(**values | changes)


REFERENCE = built(
    center=(0.0, 0.0, -0.55), within_reach=0.995, clearance=0.007, bodies=("slider", "joint 1"),
    overlapping=0.02, stiffness=19e3, frequency=5.5, guide=0.3, needed_guide=0.35, shaft=0.7,
    needed_shaft=0.6, moving_mass=28.0,
)  # fmt: skip


def test_a_robot_that_can_be_built_beside_the_reference() -> None:
    table = synthesis.buildability_table(built(), REFERENCE)
    assert cells(table) == [
        ("Least clearance as drawn", "12 mm", "7 mm"),
        ("Between", "arm and guide", "slider and joint 1"),
        ("Poses that overlap", "0 %", "2 %"),
        ("Least horizontal stiffness", "21 N/mm", "19 N/mm"),
        ("Least first natural frequency", "7.5 Hz", "5.5 Hz"),
        ("Guide B10", "500 mm, needed 400 mm", "300 mm, needed 350 mm"),
        ("Shaft B2", "900 mm, needed 800 mm", "700 mm, needed 600 mm"),
        ("Moving mass", "33 kg", "28 kg"),
        ("Center of the workspace, z", "−610 mm", "−550 mm"),
        ("Poses within reach", "100 %", "99.5 %"),
    ]
    assert not any(row.kind == "marked" for row in table.rows)  # the reference's faults are none


@pytest.mark.parametrize(
    ("fault", "marked"),
    [
        ({"clearance": -0.001}, [0, 1]), ({"clearance": 0.0}, [0, 1]),
        ({"clearance": math.nan, "bodies": ("", "")}, [0, 1]), ({"overlapping": 0.001}, [2]),
        ({"frequency": math.nan}, [4]), ({"guide": 0.39}, [5]), ({"guide": 0.4}, []),
        ({"shaft": 0.79}, [6]), ({"shaft": 0.8}, []), ({"within_reach": 0.999}, [9]),
    ],
)  # fmt: skip
def test_faults_of_a_robot_are_marked(fault: dict[str, Any], marked: list[int]) -> None:
    rows = synthesis.buildability_table(built(**fault), REFERENCE).rows
    assert [place for place, row in enumerate(rows) if row.kind == "marked"] == marked
    kinds = [getattr(row.cells[1], "kind", "") for row in rows]
    assert kinds == ["bad" if place in marked else "plain" for place in range(len(rows))]
    if math.isnan(fault.get("clearance", 0.0)):
        assert [row.cells[1] for row in rows[:2]] == [NONE, NONE]


def answer(**changes: Any) -> Any:
    case = SimpleNamespace(
        name="a case", objective="footprint", seed=7, clear=True, reference=APPENDIX_4,
        requirements=SimpleNamespace(theta=(-0.1, 0.2)), paths=("geometry.base_radius", "links.b1"),
    )  # fmt: skip
    values: dict[str, Any] = {
        "case": case, "feasible": True, "objective": 0.578, "regime": Regime.SMALLER,
        "workspace": PLACE, "trials": 1234, "canceled": False, "poses": 567, "refused": {},
        "outcomes": (), "relaxed": (), "buildability": None, "design": APPENDIX_4, "proof": None,
    }  # fmt: skip
    return SimpleNamespace(**values | changes)


def test_an_answer_says_what_it_is_and_how_it_was_found() -> None:
    found = said(synthesis.synthesis_blocks(answer()))
    place = "box 200 × 100 × 300 mm about x 10 mm, y 20 mm, z −500 mm"
    assert found == [
        (f"Least footprint radius found: 578 mm, with {Regime.SMALLER.value}, for the {place}.",
         "ok"),
        ("The search tried 1,234 robots and has no proof that there is none better; requirements "
         "were verified on 567 poses, θ −5.73° to 11.46° from the heading where joints 5 are "
         "toward their leg axes.", "muted"),
    ]  # fmt: skip
    assert ", with , for" in said(synthesis.synthesis_blocks(answer(regime=None)))[0][0]
    none = answer(
        feasible=False,
        canceled=True,
        objective=math.nan,
        refused={Regime.LARGER: "1 >= |R_b - R_pl|, over-stretched"},
    )
    assert said(synthesis.synthesis_blocks(none)) == [
        ("No robot meets all requirements; below is the nearest one.", "bad"),
        ("The search tried 1,234 robots before it was stopped.", "muted"),
        (f"{Regime.LARGER.value} is excluded: 1 ≥ |R_b − R_pl|, over-stretched.", "plain"),
    ]
    assert synthesis.effort_note(answer(trials=1)).text.startswith("The search tried 1 robot and")
    assert synthesis.objective_text("footprint", 0.123456) == "footprint radius 123.5 mm"
    assert synthesis.objective_text("footprint", 0.123456, 3) == "footprint radius 123 mm"


def test_parts_of_an_answer_are_there_where_they_say_something() -> None:
    """Outcomes with a value, lengths that changed, a proof, and whether it can be built."""

    def captions(**changes: Any) -> list[str]:
        blocks = synthesis.synthesis_blocks(answer(**changes))
        return [getattr(block, "caption", "")[:20] for block in blocks if hasattr(block, "rows")]

    kept, unknown = (
        BoundOutcome(TORQUE, 1.0, 2.0, False),
        BoundOutcome(TORQUE, math.nan, math.nan, False),
    )
    assert captions() == captions(outcomes=(unknown,)) == []
    assert captions(outcomes=(unknown, kept)) == ["Requirements at the "]
    longer = APPENDIX_4.vary({"geometry.base_radius": 0.4})
    assert captions(design=longer) == ["Lengths and masses t"]
    proof = SimpleNamespace(verdict=Verdict.PROVEN, sampled=(), evidence=(), pose=None)
    assert captions(proof=proof) == ["What the proof rests"]
    notes = said(synthesis.synthesis_blocks(answer(proof=proof)))
    assert notes[-1] == ("Proof over the whole workspace: proven.", "plain")
    assert captions(buildability=(built(), REFERENCE)) == ["Whether the robot ca"]
    case = SimpleNamespace(**vars(answer().case) | {"clear": False})
    overlaps = answer(case=case, buildability=(built(), REFERENCE))
    assert said(synthesis.buildability_blocks(overlaps)) == [(synthesis.OVERLAP_ALLOWED, "warn")]
    assert said(synthesis.buildability_blocks(answer(buildability=(built(), REFERENCE)))) == []


def test_an_answer_as_data() -> None:
    outcome = BoundOutcome(TORQUE, 14.5, 0.5, True)
    relaxed = SimpleNamespace(bound=CONDITION, nearest=9.0, change=0.125)
    data = plain(
        synthesis.synthesis_data(
            answer(
                outcomes=(outcome,), relaxed=(relaxed,), refused={Regime.LARGER: "why"},
                buildability=(built(), REFERENCE),
            ), 1.23456,
        )
    )  # fmt: skip
    robots = data.pop("buildability")
    assert data.pop("design")["geometry.base_radius"] == APPENDIX_4.geometry.base_radius
    assert data == {
        "case": "a case", "feasible": True, "objective": {"key": "footprint", "value": 0.578},
        "regime": Regime.SMALLER.value, "refused": {Regime.LARGER.value: "why"},
        "seed": 7, "seconds": 1.235, "trials": 1234, "poses": 567,
        "workspace_center_m": [0.01, 0.02, -0.5], "overlap_allowed": False,
        "requirements": [
            {
                "text": "max_torque <= 15 N m", "worst": 14.5, "unit": "N m", "margin": 0.5,
                "active": True,
            }
        ],
        "relaxed": [{"text": "condition <= 8", "unit": "1", "nearest": 9.0, "change": 0.125}],
        "proof": None,
    }  # fmt: skip
    assert robots["reference"] == {
        "workspace_center_m": [0.0, 0.0, -0.55], "within_reach": 0.995, "clearance_m": 0.007,
        "nearest_bodies": ["slider", "joint 1"], "nearest_at": [0.1, 0.2, 0.3, -0.4],
        "overlapping": 0.02, "stiffness_horizontal_N_per_m": 19e3, "frequency_1_Hz": 5.5,
        "guide_m": 0.3, "needed_guide_m": 0.35, "shaft_m": 0.7, "needed_shaft_m": 0.6,
        "moving_mass_kg": 28.0,
    }  # fmt: skip
    assert robots["robot"]["moving_mass_kg"] == 33.0
    assert synthesis.synthesis_data(answer(), 1.0)["buildability"] is None
    proof = SimpleNamespace(verdict=Verdict.PROVEN)
    assert plain(synthesis.synthesis_data(answer(proof=proof), 1.0)["proof"]) == "proven"


def test_what_was_asked_for_besides_an_answer() -> None:
    asked = {"prices": None, "built": None, "mujoco": None, "conflict": None}

    def both(**given: Any) -> tuple[list, dict[str, Any]]:
        checks = answer_checks.AnswerChecks(**asked | given)
        result = answer(inner=None)
        blocks = answer_checks.answer_blocks(result, checks)
        return blocks, answer_checks.checks_data(result, checks)

    assert both() == ([], {})
    blocks, data = both(prices=())
    assert (len(blocks), data) == (1, {"prices": ()})
    fraction = SimpleNamespace(low=0.91, high=0.98, confidence=0.95, passed=96, samples=100)
    blocks, data = both(built=SimpleNamespace(fraction=fraction, missed={"reach": 3}, worst="w"))
    assert len(blocks) == 2
    assert data["built"] == vars(fraction) | {"missed": {"reach": 3}, "worst": "w"}
    blocks, data = both(mujoco="missing")
    assert data == {"mujoco": {"passed": None, "reason": "missing"}}
    check = SimpleNamespace(version="3", passed=True, difference=1e-9, rows=(), left_out=())
    blocks, data = both(mujoco=check)
    assert (len(blocks), data) == (2, {"mujoco": vars(check)})
    blocks, data = both(conflict=SimpleNamespace(items=(TORQUE,), proven=True))
    assert cells(blocks[0]) == [("max_torque <= 15 N m",)]
    assert data == {"conflict": {"items": ["max_torque <= 15 N m"], "proven": True}}


def test_masses_and_springs_of_an_answer_as_data() -> None:
    spring = SimpleNamespace(
        first=SimpleNamespace(name="A"), second=SimpleNamespace(name="B"), stiffness=1234.0,
        free_length=0.05,
    )  # fmt: skip
    inner = SimpleNamespace(
        goal="mass", objective=1.5, lower_bound=1.25, springs=(spring,), active=("m",),
        design=SimpleNamespace(counterweights=(SimpleNamespace(place="B3", mass=0.75),)),
    )  # fmt: skip
    checks = answer_checks.AnswerChecks(None, None, None, None)
    assert answer_checks.checks_data(answer(inner=inner), checks) == {
        "inner": {
            "goal": "mass", "value": 1.5, "lower_bound": 1.25, "active": ("m",),
            "counterweights": [{"place": "B3", "mass_kg": 0.75}],
            "springs": [
                {"first": "A", "second": "B", "stiffness_N_per_m": 1234.0, "free_length_m": 0.05}
            ],
        }
    }  # fmt: skip


def test_robots_of_a_front_with_the_lengths_that_may_change() -> None:
    wider = APPENDIX_4.vary({"geometry.base_radius": 0.41234567})
    points = tuple(
        SimpleNamespace(values=(size, mass), result=answer(
            design=one, buildability=(built(), REFERENCE)))
        for size, mass, one in ((0.5, 21.0, APPENDIX_4), (0.6, 19.0, wider))
    )  # fmt: skip
    front: Any = SimpleNamespace(
        objectives=("footprint", "moving_mass"), points=points, dominated=3, searches=9, failed=4,
        canceled=False,
    )  # fmt: skip
    case = answer().case
    table, *rest = synthesis.front_blocks(case, front)
    assert cells(table) == [
        ("1", "500 mm", "21 kg", "0.35"), ("2", "600 mm", "19 kg", "0.4123"),
    ]  # fmt: skip
    first, second = (synthesis.find_objective(name).label for name in front.objectives)
    assert table.head == ("", first, second, "base_radius")  # type: ignore
    assert table.caption == (  # type: ignore
        "2 Pareto-optimal robots by 9 searches; 3 dominated, 4 without a robot."
    )
    assert said(rest) == [("Robot 1", "plain"), ("Robot 2", "plain")]
    assert len(rest) == 4
    data = synthesis.front_data(case, front, 1.23456)
    assert [point["values"] for point in data["points"]] == [(0.5, 21.0), (0.6, 19.0)]
    assert data["points"][1]["numbers"] == {"geometry.base_radius": 0.41234567}
    assert data["points"][0]["buildability"]["robot"]["frequency_1_Hz"] == 7.5
    assert data["points"][0]["workspace_center_m"] == PLACE.center
    assert {key: data[key] for key in data if key != "points"} == {
        "case": "a case", "overlap_allowed": False, "seed": 7, "seconds": 1.235,
        "objectives": ("footprint", "moving_mass"), "dominated": 3, "searches": 9, "failed": 4,
        "canceled": False,
    }  # fmt: skip
    front.points, front.searches = points[:1], 1
    assert synthesis.front_blocks(case, front)[0].caption.startswith(  # type: ignore
        "1 Pareto-optimal robot by 1 search; "
    )


# ---------------------------------------------------------------------------------- a volume


def test_what_ends_a_volume_and_what_each_requirement_removes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Causes by their share of the surface, the largest first, then those without any."""
    inside, reach, first, second = (
        VolumeCause(0, CauseKind.INSIDE, "inside", "in"),
        VolumeCause(5, CauseKind.REACH, "leg 2 is stretched", "stretched", leg=1),
        VolumeCause(16, CauseKind.REQUIREMENT, "", "", 0),
        VolumeCause(17, CauseKind.REQUIREMENT, "", "", 1),
    )  # fmt: skip
    areas = {first: 0.5, reach: 1.5}
    monkeypatch.setattr(
        requirements, "volume_surface", lambda volume: SimpleNamespace(areas=lambda: areas)
    )
    volume: Any = SimpleNamespace(
        cause=np.zeros((30, 20, 2)), cell=0.0123456, sampled_headings=5, empty=False,
        home_inside=True, volume=0.0123, error=0.000456, reachable_share=0.25,
        reachable_volume=0.0492, requirements=Requirements((CONDITION, TORQUE), (-0.1, 0.1)),
        shares=lambda: {inside: 0.25, first: 0.5, second: 0.15, reach: math.nan},
        removed_alone=np.array([0.6, 0.3]), removed_last=np.array([0.4, math.nan]),
    )  # fmt: skip
    note, table = requirements._volume(volume, lambda bound: bound.quantity)
    nodes = "On 1,200 nodes 12.3 mm apart and 5 headings."
    assert said([note]) == [
        ("All requirements hold in 12.30 ± 0.46 dm³, 25.0 % of 49.2 dm³ that can be reached with "
         f"every heading from home without a singularity between. {nodes}", "plain"),
    ]  # fmt: skip
    assert cells(table) == [
        (reach.text, "75.0 %", NONE, "", ""), ("condition", "25.0 %", "50.0 %", "60.0 %", "40.0 %"),
        ("max_torque", "", "15.0 %", "30.0 %", NONE),
    ]  # fmt: skip
    volume.home_inside = False
    note, _ = requirements._volume(volume, lambda bound: bound.quantity)
    assert said([note])[0][0].endswith("Home is not in it: it is the largest connected part.")
    volume.empty = True
    areas.clear()
    volume.shares = lambda: {inside: 1.0}
    assert said(requirements._volume(volume, lambda bound: bound.quantity)) == [
        (f"The volume where all requirements hold is empty. {nodes}", "bad")
    ]


# ------------------------------------------------------------------------------------------ sweeps


def test_a_sweep_with_a_motion_and_one_that_went_on(tmp_path: Any) -> None:
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(20)
    extremes = {
        "a": SimpleNamespace(least=1.5, least_row=3, largest=2.5, largest_row=0),
        "b": SimpleNamespace(least=math.nan, least_row=-1, largest=math.nan, largest_row=-1),
    }
    summary: Any = SimpleNamespace(
        extremes=extremes, found=2, rows=9, status=Counter({OK: 6, "bad": 3}),
        motion=Counter({RUNS: 4, "stretched": 5}),
        study=SimpleNamespace(design=APPENDIX_4, trajectory=motion),
    )  # fmt: skip
    table, *notes = sweep_blocks(tmp_path, summary, 1.25)
    assert cells(table) == [("a", "1.5", "3", "2.5", "0"), ("b", *[NONE] * 4)]
    assert [text for text, _ in said(notes)] == [
        f"{tmp_path}: 9 designs, 2 of them found there, 3 bad, 1.2 s",
        f"{motion.name}: 4 designs can run it, 5 stretched",
        *(f"  {note}" for note in motion.notes),
    ]
    data = sweep_data(tmp_path, summary, 1.23456)
    assert data["motion"] == {
        "name": motion.name, "duration_s": motion.duration, "notes": motion.notes,
        "samples": motion.size, "status": summary.motion,
    }  # fmt: skip
    assert (data["seconds"], data["rows"], data["found"]) == (1.235, 9, 2)
    summary.motion = Counter({"stretched": 9})
    text = f"{motion.name}: 0 designs can run it, 9 stretched"
    assert text in [text for text, _ in said(sweep_blocks(tmp_path, summary, 1.25))]
    summary.study.trajectory, summary.found, summary.motion = None, 0, Counter()
    assert said(sweep_blocks(tmp_path, summary, 1.25)) == [
        (f"{tmp_path}: 9 designs, 3 bad, 1.2 s", "plain")
    ]
    assert sweep_data(tmp_path, summary, 1.0)["motion"] is None


# -------------------------------------------------------------------------------------- excitation


def test_how_an_exciting_motion_was_found() -> None:
    found: Any = SimpleNamespace(
        settings=SimpleNamespace(periods=3, period=12.5, harmonics=5), evaluations=200,
        seconds=4.5678, parameters=13, log_det=-1.25, random=30, random_log_det=-9.75,
        narrowing=1.3866, limits=(KeptLimit("force", 2.34567, 4.56789, "N", 0.123456),),
    )  # fmt: skip
    first, second, table = excitation_blocks(found)
    assert said([first, second]) == [
        ("3 periods of 12.5 s, 5 harmonics; 200 evaluations in 4.57 s.", "plain"),
        ("log det of the information of 13 parameters −1.2, of the best of 30 random motions "
         "−9.8: intervals narrower by a factor of 1.39 on average.", "plain"),
    ]  # fmt: skip
    assert cells(table) == [("force", "2.35 N", "≤ 4.57 N", "0.123 s", "51 %")]
    found.settings.periods = found.evaluations = 1
    once = "1 period of 12.5 s, 5 harmonics; 1 evaluation in 4.57 s."
    assert said(excitation_blocks(found)[:1]) == [(once, "plain")]
    found.settings.periods, found.evaluations = 3, 200
    found.plan = SimpleNamespace(duration=37.5)
    assert excitation_data(APPENDIX_4, found) == {
        "design": APPENDIX_4.name, "knee": "lower", "period_s": 12.5, "harmonics": 5,
        "duration_s": 37.5,
        "log_det_random": -9.75, "parameters": 13, "log_det": -1.25, "random": 30,
        "evaluations": 200, "seconds": 4.5678,
        "limits": [{"name": "force", "value": 2.34567, "limit": 4.56789, "unit": "N",
                    "t_s": 0.123456, "least": False, "kept": True}],
    }  # fmt: skip
    odd = (
        KeptLimit("none", 0.0, 0.5, "m", 0.0, True), KeptLimit("free", 3.0, math.inf, "N", 0.0),
        KeptLimit("broken", 5.0, 4.0, "N", 0.0),
    )  # fmt: skip
    rows = limits_table(SimpleNamespace(limits=odd)).rows  # type: ignore
    assert [row.cells[4] for row in rows] == [NONE, NONE, "125 %"]
    assert [row.cells[4].kind for row in rows] == ["bad", "plain", "bad"]  # type: ignore
    assert [row.kind for row in rows] == ["marked", "plain", "marked"]
