"""Every example runs as it stands, and the gallery lists it."""

from __future__ import annotations

import re
import runpy
from dataclasses import replace
from pathlib import Path

import pytest

from paminsa_viz import identification
from paminsa_viz.identification import ExcitationSettings

pytestmark = pytest.mark.slow


EXAMPLES = Path(__file__).parent.parent / "examples"
SCRIPTS = sorted(EXAMPLES.glob("*.py"))
WRITTEN = {
    "calibration": {"measured.csv"},
    "design_study": {"design_study.csv"},
    "dynamic_torques": {"dynamic_torques.png"},
    "in_a_notebook": {"robot.html", "maps.html", "motion.html", "torques.svg"},
    "record_logs": {"example_log.csv", "example_log_other.csv", "example_log_payload.csv"},
    "static_maps": {"static_maps.png"},
}
PRINTED = {
    "accuracy": r"linear +6912\.9″, no bound: (.|\n)*bars and shafts to 20 µm: z off by 811 µm",
    "balance": r"M_p2 =  ? ?0\.0000 N, torques \[0\. 0\. 0\.\]",
    "calibration": r"30 combinations show (.|\n)*held back, RMS of z: .* 9\.2 µm after",
    "crossing": r"turn, Appendix 4: 0\.372 s, (.|\n)*cannot be held",
    "design_study": r"400 designs, \{'ok': 400\}",
    "dynamic_torques": r"two routes: \d\.\de-1[3-9]",
    "forces": r"in every horizontal direction: 83\.60 N, M1 limits",
    "misprints": r"all of them +0\.\d+",
    "payload_in_motion": r"at rest M1..M3 change by at most 0 N·m,\nM4 by k m g = 147\.15 N",
    "record_logs": r"seed 0: log det \d+, [1-9]\d above random motions",
    "singularities": r"θ = 73\.40°\n.*\n.* 268\.1 mm",
    "springs": r"zero free length, mast on slider 8 +largest torque 0\.000 N·m with 91\.0 N/m",
    "static_maps": r"M_p2 = 9\.100 N",
    "verify_with_mujoco": r"corrected: .* \d\.\de-1[3-9]",
}


def test_gallery_lists_every_script() -> None:
    listed = re.findall(
        r"^\| \[(\w+)\.py\]\(\1\.py\) \|", (EXAMPLES / "README.md").read_text(), re.M
    )
    assert sorted(listed) == [script.stem for script in SCRIPTS]
    assert set(WRITTEN) | set(PRINTED) == set(listed)


def shorter(settings: ExcitationSettings) -> ExcitationSettings:
    """Return settings of a short search for a short motion, which shows as much."""
    return replace(settings, evaluations=settings.evaluations // 4, random=8, periods=1, period=4.0)


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_example_runs_and_prints_its_result(script, tmp_path, monkeypatch, capsys) -> None:
    if script.stem in ("record_logs", "verify_with_mujoco"):
        pytest.importorskip("mujoco")
    if script.stem == "record_logs":
        whole = identification.optimize_excitation
        monkeypatch.setattr(
            identification, "optimize_excitation",
            lambda design, limits, settings: whole(design, limits, shorter(settings)),
        )  # fmt: skip
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script), run_name="__main__")
    assert re.search(PRINTED.get(script.stem, ""), capsys.readouterr().out)
    assert {path.name for path in tmp_path.iterdir()} == WRITTEN.get(script.stem, set())
    assert all(path.stat().st_size > 10_000 for path in tmp_path.iterdir())
    assert len(script.read_text().splitlines()) <= 45
