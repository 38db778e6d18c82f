"""What the page hands out and takes in: exports, design files, clicks on maps, the handle."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from paminsa_viz.explorer import actions
from paminsa_viz.files.design_file import read_design
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.model import APPENDIX_4, static_torques
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser


def download(tab: Tab, click: Any) -> tuple[str, bytes]:
    """Click something and return the name and the content of the file that comes down."""
    with tab.page.expect_download() as waiting:
        click()
    return waiting.value.suggested_filename, Path(waiting.value.path()).read_bytes()


def export(tab: Tab, button: str) -> tuple[str, bytes]:
    """Use a button of the export tab."""
    tab.open_tab("Export")
    return download(
        tab, lambda: tab.page.get_by_role("button", name=button, exact=True).first.click()
    )


def as_picture(content: bytes) -> np.ndarray:
    """Return a picture's pixels, (height, width, 3)."""
    return np.asarray(Image.open(io.BytesIO(content)).convert("RGB"))


@pytest.fixture
def posed(tab: Tab) -> Tab:
    """The tab at a pose with torques."""
    tab.session.dispatch("test", lambda s: actions.move(s, x=0.05, y=-0.03, theta=0.4))
    tab.wait_pose(0, 0.05)
    return tab


def test_figures(posed: Tab) -> None:
    name, content = export(posed, "PNG")
    assert name.endswith(".png")
    pixels = as_picture(content)
    assert abs(pixels.shape[1] - round(170 / 25.4 * 300)) <= 1
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 100
    name, content = export(posed, "SVG")
    assert name.endswith(".svg")
    assert b"<svg" in content
    assert "τ₁".encode() in content or b"tau" in content or b"glyph" in content
    name, content = export(posed, "PDF")
    assert name.endswith(".pdf")
    assert content.startswith(b"%PDF")
    assert b"%%EOF" in content[-64:]


def test_map_data_are_the_models_numbers(posed: Tab) -> None:
    name, content = export(posed, "CSV")
    assert name.endswith(".csv")
    lines = [line for line in content.decode().splitlines() if not line.startswith("#")]
    columns = lines[0].split(",")
    rows = [dict(zip(columns, line.split(","), strict=True)) for line in lines[1:]]
    good = [row for row in rows if row["status"] == "ok"][::997]
    assert len(good) > 5
    _, _, theta, z = posed.state.standing.pose
    poses = np.array([[float(r["x_m"]), float(r["y_m"]), theta, z] for r in good])
    found = np.array([[float(r[f"tau{j}_Nm"]) for j in (1, 2, 3)] for r in good])
    np.testing.assert_allclose(found, static_torques(APPENDIX_4, poses)[:, :3], rtol=1e-8)

    name, content = export(posed, "NPZ")
    with np.load(io.BytesIO(content)) as arrays:
        assert sum(array.size for array in arrays.values()) > 3 * 200 * 200


def test_the_robot_and_the_view(posed: Tab) -> None:
    name, content = export(posed, "Robot as GLB")
    assert name.endswith(".glb")
    scene = trimesh.load(io.BytesIO(content), file_type="glb")
    assert len(scene.geometry) > 10
    assert 0.5 < scene.extents.max() < 5.0
    name, content = export(posed, "View as PNG")
    assert name.endswith(".png")
    assert as_picture(content).std() > 5


def test_the_mujoco_model_runs(posed: Tab) -> None:
    mujoco = pytest.importorskip("mujoco", reason="mujoco comes with the extra 'verify'")
    name, content = export(posed, "MJCF")
    assert name.endswith(".xml")
    model = mujoco.MjModel.from_xml_string(content.decode())
    data = mujoco.MjData(model)
    for _ in range(100):
        mujoco.mj_step(model, data)
    assert abs(data.joint("platform_x").qpos[0] - 0.05) < 1e-4
    name, content = export(posed, "MJCF with meshes")
    assert name.endswith(".zip")
    assert content.startswith(b"PK")


def test_a_saved_design_restores_it(tab: Tab) -> None:
    tab.session.dispatch(
        "test", lambda s: actions.vary(s, {"links.b3": 0.777, "payload.mass": 3.0})
    )
    until(lambda: tab.state.document.design.links.b3 == 0.777, "the design changes")
    saved = tab.state.document.design
    tab.open_tab("File")
    _, content = download(
        tab, lambda: tab.page.get_by_role("button", name="Download as TOML").click()
    )
    assert read_design(content, "download") == saved
    tab.page.get_by_role("button", name="Appendix 4 (prototype)").click()
    until(lambda: tab.state.document.design == APPENDIX_4, "Appendix 4 is back")
    upload(tab, "mine.toml", content)
    until(lambda: tab.state.document.design == saved, "the upload restores the design")


def upload(tab: Tab, name: str, content: bytes) -> None:
    """Give a file to the upload button."""
    field = tab.page.locator('input[type="file"]').first
    field.set_input_files([{"name": name, "mimeType": "text/plain", "buffer": content}])


def test_a_broken_upload_is_told_and_changes_nothing(tab: Tab) -> None:
    tab.open_tab("File")
    before = tab.state.document
    text = write_design(APPENDIX_4).replace("b3_kg = 0.406", "b3_kg = -1")
    assert "b3_kg = -1" in text
    upload(tab, "broken.toml", text.encode())
    tab.page.get_by_text("b3_kg").first.wait_for()
    assert tab.state.document == before


def test_a_click_on_a_map_goes_there(tab: Tab) -> None:
    tab.open_tab("Torque maps")
    plot = tab.page.locator(".js-plotly-plot:visible .nsewdrag").first
    plot.wait_for(state="attached")
    box = tab.steady_box(plot)
    tab.page.mouse.click(box["x"] + 0.56 * box["width"], box["y"] + 0.45 * box["height"])
    until(lambda: tab.state.standing.pose[0] > 0.02, "the robot goes to the right")
    assert tab.state.standing.pose[1] > 0.01
