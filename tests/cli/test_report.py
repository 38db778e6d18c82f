"""``report``: one command, one file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from paminsa_viz.cli import main
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.units import tied

pytestmark = pytest.mark.slow


@pytest.mark.usefixtures("without_pictures")
def test_one_command_makes_it(folder, capsys) -> None:
    heavy = replace(APPENDIX_4.vary({"links.b4": 0.9}), name="Heavy")
    words = "--out r.html --no-verify --preset arch --knee upper --pose 30 0 10 520 --seed 4"
    words += f" --reference {save_design(heavy, 'heavy.toml')}"
    assert main(["report", *words.split()]) == 0
    printed = capsys.readouterr()
    assert printed.out == "r.html: written\n"
    assert "torque maps ..." in printed.err
    assert "verification ..." not in printed.err
    text = Path("r.html").read_text(encoding="utf-8")
    assert f"paminsa-viz report {words}" in text
    assert tied("Upper knee, pose x 30 mm") in text
    assert "pick-and-place arch" in text
    assert sorted(path.name for path in folder.iterdir()) == ["heavy.toml", "r.html"]
    # the reference: the numbers that differ, the difference of the maps, its torques on the motion
    assert "What differs from the reference “Heavy”." in text
    assert text.count("Map over x and y: Static torques of the rotary actuators, difference") == 1
    assert "M4, reference" in text
    assert "reference &quot;Heavy&quot;: can run it too" in text


@pytest.mark.usefixtures("report_of_the_motion", "without_pictures")
def test_the_motion_may_cross_a_singularity(folder, capsys) -> None:
    Path("poses.csv").write_text(
        "t_s,x_m,y_m,theta_rad,z_m\n0,0.03,0.02,0.8,-0.5\n1,0.03,0.02,1.75,-0.5\n"
    )
    words = "report --out r.html --no-verify --file poses.csv --cross --max-torque"
    assert main([*words.split(), "10"]) == 0
    text = Path("r.html").read_text(encoding="utf-8")
    assert "singular rotation" in text
    assert "Crossings of singularities and the torques in the limit" in text
    assert main([*words.split(), "5"]) != 0
    assert "times as large" in capsys.readouterr().err
