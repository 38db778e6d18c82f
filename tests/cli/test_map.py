"""``map``: the explorer's own figures and tables, from a command line."""

from __future__ import annotations

import json
import math
from contextlib import nullcontext
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from paminsa_viz.cli import map as command
from paminsa_viz.cli.map import Map, maps_of, scales_of
from paminsa_viz.explorer.core.maps import MapStore
from paminsa_viz.explorer.features.export.exports import figure, table
from paminsa_viz.explorer.state.maps import MapView, RangeMode
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Field,
    Geometry,
    KneeBranch,
    backend,
    measure_singularity,
    static_torques,
)
from paminsa_viz.model.reach import home_pose
from paminsa_viz.plots import map_figure
from paminsa_viz.plots.map_values import COARSE, workspace_field
from tests.support import commands
from tests.support.samples import with_knee

run = partial(commands.run, "map")
run_json = partial(commands.run_json, "map")

LIGHT = replace(APPENDIX_4.vary({"links.b4": 0.3}), name="Light")


@pytest.fixture(scope="module", autouse=True)
def one_backend() -> None:
    """The compiled formulas from the start, so that equal maps are equal to the last bit."""
    backend.compile_now()


def state_of(pose: tuple[float, ...], view: MapView, reference: Design | None = None) -> State:
    """Return the explorer's state that shows the same maps."""
    state = initial_state(APPENDIX_4)
    document = replace(state.document, pose=pose, reference=reference)
    return replace(state, document=document, map_view=view)


def test_maps_of_several_figures_are_computed_once(
    capsys, folder, monkeypatch: pytest.MonkeyPatch
) -> None:
    said: list[str] = []
    sizes: list[int] = []

    def solved(geometry: Geometry, theta: float, z: float, cells: int, half: float) -> Field:
        sizes.append(cells)
        return workspace_field(geometry, theta, z, cells, half)

    monkeypatch.setattr(command, "status_line", lambda text: nullcontext(said.append(text)))
    monkeypatch.setattr(command, "workspace_field", solved)
    monkeypatch.setattr(map_figure, "render_maps", lambda *_, **__: b"")
    run(capsys, "--cells", "10", "--out", "a.png", "--out", "a.svg")
    assert sizes == [10, COARSE]
    assert said == ["computing the maps"]
    run(capsys, "--cells", "10", "--out", "a.csv")
    assert sizes[2:] == [10]  # colors are for figures


@pytest.mark.slow
def test_files_are_those_of_the_explorer(capsys, folder) -> None:
    words = ("--z", "-500", "--at", "50", "-30", "--out", "a.svg", "--out", "a.csv", "--width",
             "120", "--dpi", "60")  # fmt: skip
    run_json(capsys, *words)
    state = state_of((0.05, -0.03, math.pi / 3, -0.5), MapView())
    state = state.updated("export", width=120, dpi=60)
    store = MapStore()
    assert (folder / "a.svg").read_bytes() == figure(state, store, "svg").content
    assert (folder / "a.csv").read_bytes() == table(state, store, "csv").content


@pytest.mark.slow
def test_a_difference_is_that_of_the_explorer(capsys, folder) -> None:
    save_design(LIGHT, "light.toml")
    words = ("--quantity", "max-torque", "--log", "--range", "-2", "3", "--reference", "light.toml",
             "--out", "a.svg", "--dpi", "60")  # fmt: skip
    run_json(capsys, *words)
    view = MapView("max_torque", RangeMode.MANUAL, -2.0, 3.0, logarithmic=True, difference=True)
    state = state_of((0.0, 0.0, math.pi / 3, home_pose(APPENDIX_4.geometry)[3]), view, LIGHT)
    state = state.updated("export", single=True, dpi=60)
    assert (folder / "a.svg").read_bytes() == figure(state, MapStore(), "svg").content


@pytest.mark.slow
@pytest.mark.parametrize("knee", list(KneeBranch))
def test_numbers_are_static_torques(capsys, folder, knee) -> None:
    z = -0.5 if knee is KneeBranch.LOWER else 0.5
    found = run_json(capsys, "--theta", "20", "--z", str(1e3 * z), "--cells", "40", "--knee",
                 knee.value, "--out", "a.npz")  # fmt: skip
    with np.load(folder / "a.npz") as arrays:
        x, y = np.meshgrid(arrays["x_m"], arrays["y_m"])
        tau = arrays[next(name for name in arrays if name.startswith("tau2"))]
    pose = np.stack([x, y, np.full_like(x, math.radians(20)), np.full_like(x, z)], axis=-1)
    expected = static_torques(with_knee(APPENDIX_4, knee), pose)[..., 1]
    np.testing.assert_allclose(tau, expected, rtol=1e-9, atol=1e-12)
    counts = measure_singularity(APPENDIX_4.geometry, pose)
    counted = expected[(counts.condition <= 10) & (counts.serial_distance >= 0.01)]
    assert found["maps"]["tau_2"]["largest"] == pytest.approx(counted.max())
    assert found["cells_by_status"]["ok"] == np.isfinite(expected).sum()
    assert sum(found["cells_by_status"].values()) == 1600


def test_percentiles_are_of_cells_that_count(capsys, folder) -> None:
    words = ("--theta", "60", "--cells", "40", "--out", "a.npz")
    found, wider = run_json(capsys, *words), run_json(capsys, *words, "--max-condition", "40")
    with np.load(folder / "a.npz") as arrays:
        x, y = np.meshgrid(arrays["x_m"], arrays["y_m"])
        tau = arrays[next(name for name in arrays if name.startswith("tau2"))]
    z = home_pose(APPENDIX_4.geometry)[3]
    pose = np.stack([x, y, np.full_like(x, math.pi / 3), np.full_like(x, z)], axis=-1)
    counts = measure_singularity(APPENDIX_4.geometry, pose).condition <= 10
    assert found["counting_cells"] == counts.sum()
    assert found["maps"]["tau_2"]["p90_size"] == pytest.approx(
        np.percentile(np.abs(tau[counts]), 90)
    )
    assert found["maps"]["tau_2"]["p90_size"] < wider["maps"]["tau_2"]["p90_size"]
    assert found["maps"]["tau_2"]["largest"] < wider["maps"]["tau_2"]["largest"]
    assert "Median |tau|" in run(capsys, "--cells", "20")[1]


def test_ranges_are_in_shown_units() -> None:
    flags = Map(quantity="reach-margin", range=(0.0, 200.0))
    data = maps_of(flags, APPENDIX_4, None, 20)
    (scale,) = scales_of(flags, data, data)
    assert (scale.low, scale.high) == (0.0, 0.2)


def test_the_summary_is_for_people(capsys) -> None:
    code, out, err = run(capsys, "--cells", "30", "--quantity", "reach-margin")
    assert (code, err) == (0, "")
    assert "theta = 60°" in out
    assert "[mm]" in out
    assert "singular circle: radius 312.2 mm" in out
    out.encode("cp1252")  # a terminal of Windows can print it


@pytest.mark.slow
def test_where_nothing_is_reached_the_exit_code_is_1(capsys, folder) -> None:
    code, out, err = run(capsys, "--z", "-2000", "--cells", "20", "--out", "a.png", "--dpi", "50")
    assert code == 1
    assert "no position can be reached at 60° and z = -2000 mm" in err
    assert "a.png: written" in out
    assert (folder / "a.png").read_bytes().startswith(b"\x89PNG")
    code, out, _ = run(capsys, "--z", "-2000", "--cells", "20", "--json")
    assert json.loads(out)["maps"]["tau_1"]["largest"] is None


def test_load_of_the_command_line_is_the_designs(capsys) -> None:
    flags = ["--theta", "10", "--z", "-550", "--cells", "20"]
    load = ["--load", "30", "-20", "-50", "9", "8", "2", "--load-point", "50", "0", "0"]
    plain, loaded = run_json(capsys, *flags), run_json(capsys, *flags, *load)
    assert loaded["maps"] != plain["maps"]
    bearings = run_json(capsys, *flags, *load[:4], "0", "0", *load[6:])  # carry these moments alone
    assert bearings["maps"] == loaded["maps"]
    turned = run_json(capsys, *flags, *load, "--load-frame", "platform")
    assert turned["maps"] != loaded["maps"]


@pytest.mark.slow
def test_published_torques_are_compared_where_they_are(capsys, tmp_path) -> None:
    """Those of statics itself are met to the last digit, and what is added to them comes back."""
    position = np.array([[0.05, -0.03], [-0.02, 0.06], [5.0, 0.0]])
    rest = np.broadcast_to([math.radians(40), -0.5], (3, 2))
    torque = static_torques(APPENDIX_4, np.hstack([position, rest]))
    rows = [f"{1e3 * x!r},{1e3 * y!r},{t[0]!r},{t[1] + 0.25!r}" for (x, y), t in
            zip(position.tolist(), np.nan_to_num(torque).tolist(), strict=True)]  # fmt: skip
    path, figure = tmp_path / "published.csv", tmp_path / "map.png"
    path.write_text("\n".join(["# of statics", "x_mm,y_mm,tau1_Nm,tau2_Nm", *rows]) + "\n")
    flags = ("--theta", "40", "--z", "-500", "--cells", "21", "--published", str(path))
    found = run_json(capsys, *flags)["published"]
    assert found.keys() == {"tau1_Nm", "tau2_Nm"}
    assert found["tau1_Nm"]["positions"] == 2  # the third is out of reach
    assert found["tau1_Nm"]["largest_difference"] < 1e-12
    assert found["tau2_Nm"]["rms_difference"] == pytest.approx(0.25, rel=1e-12)
    plain = tmp_path / "plain.png"
    run_json(capsys, *flags, "--out", str(figure), "--dpi", "60")
    run_json(capsys, *flags[:-2], "--out", str(plain), "--dpi", "60")
    assert figure.read_bytes() != plain.read_bytes()


@pytest.mark.parametrize("quantity", ["tolerance-x", "deviation-x", "error-x", "torques"])
def test_deviations_of_legs_are_said_to_be_left_out_where_they_are(quantity: str, capsys) -> None:
    save_design(APPENDIX_4.vary({"leg2.bar_94": 1e-3}), "crooked.toml")
    words = ("--quantity", quantity, "--cells", "20", "--json")
    maps = [
        run_json(capsys, *words, *design)["maps"] for design in ((), ("--design", "crooked.toml"))
    ]
    _, out, _ = run(capsys, *words[:-1], "--design", "crooked.toml")
    assert ("legs are equal, the design's deviations" in out) == (maps[0] == maps[1])
