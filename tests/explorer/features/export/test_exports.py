"""Files that the page offers: names, contents, pictures of the view, one at a time."""

from __future__ import annotations

import html
import io
import shutil
import zipfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh
import viser
from PIL import Image

from paminsa_viz.cli import main
from paminsa_viz.codegen import controller_kit
from paminsa_viz.codegen.fmu import fmu_sources
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.maps import FULL, MapStore
from paminsa_viz.explorer.features.export import exports, pictures
from paminsa_viz.explorer.features.export.copying import LONGEST
from paminsa_viz.explorer.features.export.tab import export_entries, volume_choices
from paminsa_viz.explorer.kit import downloads
from paminsa_viz.explorer.kit.downloads import LONGEST_NAME, File, Place, file_name
from paminsa_viz.explorer.kit.entries import ButtonGroup
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.tabs import exports_of
from paminsa_viz.exports import CODE, TARGETS
from paminsa_viz.files.design_file import save_design
from paminsa_viz.files.tables import TABLE_FORMATS, table_csv, table_text
from paminsa_viz.model import InvalidInput, KneeBranch, inverse_kinematics, static_torques
from tests.support.desk import Desk, desk_with

STORE = MapStore()
PANEL = export_entries(STORE)


def state_at(**pose: float) -> State:
    return actions.move(initial_state(), **pose)


def arrays_of(file: File) -> Any:
    return np.load(io.BytesIO(file.content))


@pytest.mark.parametrize(
    ("content", "place", "name"),
    [
        ("torque-maps", "map", "paminsa_appendix-4_torque-maps_theta60_z-500.png"),
        ("robot", "pose", "paminsa_appendix-4_robot_x30_y0_theta60_z-500.png"),
        ("bearings", "", "paminsa_appendix-4_bearings.png"),
    ],
)
def test_file_name_has_design_content_and_last_reachable_pose(
    content: str, place: Place, name: str
) -> None:
    state = state_at(x=0.03, theta=np.pi / 3, z=-0.5)
    state = actions.move(state, x=9.0 if place == "pose" else 0.03)
    assert file_name(state, content, "png", place) == name


@pytest.mark.parametrize(
    ("name", "plain"),
    [
        ("../../etc/passwd", "etc-passwd"),
        ('a"b\r\nc: d', "a-b-c-d"),
        ("Große Türme №5", "groe-turme-no5"),
        ("机器人", ""),
        ("", ""),
        ("x" * 300, "x" * LONGEST_NAME),
    ],
    ids=len,
)
def test_any_design_name_becomes_a_plain_one(name: str, plain: str) -> None:
    assert downloads.plain(name) == plain


@pytest.mark.slow
@pytest.mark.parametrize(
    ("single", "columns"), [(True, ["f4_N"]), (False, ["tau1_Nm", "tau2_Nm", "tau3_Nm"])]
)
def test_map_table_holds_the_models_numbers_in_every_format(
    single: bool, columns: list[str]
) -> None:
    state = state_at(theta=0.3).updated("map_view", quantity="f_4")
    state = state.updated("export", single=single)
    arrays = arrays_of(exports.table(state, STORE, "npz"))
    x, y = np.meshgrid(arrays["x_m"], arrays["y_m"])
    pose = np.stack([x, y, np.full_like(x, 0.3), np.full_like(x, arrays["pose"][3])], axis=-1)
    torque = static_torques(state.document.design, pose)
    found = np.stack([arrays[name] for name in columns], axis=-1)
    expected = np.where(arrays["status"][..., None] == 0, torque, np.nan)
    expected = expected[..., 3:] if single else expected[..., :3]
    np.testing.assert_allclose(found, expected, atol=1e-9)
    assert found.shape[:2] == (FULL, FULL)

    text = exports.table(state, STORE, "csv").content.decode()
    header, *rows = (line.split(",") for line in text.splitlines() if not line.startswith("#"))
    index = header.index(columns[0])
    values = np.array([float(row[index] or "nan") for row in rows]).reshape(FULL, FULL)
    np.testing.assert_array_equal(values, arrays[columns[0]])


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%")])
def test_figure_is_written_in_its_format_and_size(kind: str, start: bytes) -> None:
    file = exports.figure(
        state_at().updated("export", single=True, width=90.0, dpi=100.0), STORE, kind
    )
    assert file.content.startswith(start)
    assert file.name.endswith(f".{kind}")
    if kind == "png":
        pixels = np.asarray(Image.open(io.BytesIO(file.content)).convert("RGB"))
        assert pixels.shape[1] == round(90 / 25.4 * 100)
        assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 100


@pytest.mark.parametrize(
    ("kind", "width", "dpi"),
    [("png", 1e6, 300), ("png", 170, 5), ("png", 170, 1e9), ("png", -3, 300), ("gif", 90, 90)],
)
def test_impossible_figure_or_format_is_refused(kind: str, width: float, dpi: float) -> None:
    with pytest.raises(InvalidInput):
        exports.figure(state_at().updated("export", width=width, dpi=dpi), STORE, kind)
    with pytest.raises(InvalidInput):
        exports.table(state_at(), STORE, "exe")


def test_difference_is_named_in_file_and_columns() -> None:
    state = actions.vary(actions.pin_reference(state_at()), {"links.b3": 1.0})
    file = exports.table(state.updated("map_view", difference=True), STORE, "npz")
    assert "difference" in file.name
    assert "delta_tau1_Nm" in arrays_of(file).files


@pytest.mark.slow
def test_robot_is_exported_at_its_last_reachable_pose() -> None:
    state = actions.move(state_at(x=0.04, theta=0.5), x=9.0)
    content = io.BytesIO(exports.robot(state).content)
    scene: Any = trimesh.load(content, file_type="glb", force="scene")
    place = scene.graph.get("platform")[0]
    x, y, _, z = inverse_kinematics(state.last_reachable.geometry, state.last_reachable.pose).pose
    np.testing.assert_allclose(place[:3, 3], (x, z, -y), atol=1e-6)  # y is up in a GLB


@pytest.fixture
def mirrored() -> State:
    """A design of its own, on the upper knee, posed, and then asked for too much."""
    state = actions.set_knee(initial_state(), KneeBranch.UPPER)
    state = actions.vary(state, {"payload.mass": 3.25, "geometry.crank_length": 0.44})
    return actions.move(actions.move(state, x=0.04, y=-0.02, theta=0.5), x=9.0)


def test_mujoco_model_is_the_commands(mirrored: State, tmp_path: Path) -> None:
    save_design(mirrored.document.design, tmp_path / "d.toml")
    x, y, theta, z = mirrored.last_reachable.pose
    pose = (1e3 * x, 1e3 * y, np.degrees(theta), 1e3 * z)
    arguments = ["--design", str(tmp_path / "d.toml"), "--knee", "upper"]
    arguments += ["--mjcf", str(tmp_path / "r.xml"), "--pose", *map(repr, map(float, pose))]
    assert main(["export", *arguments]) == 0
    file = exports.mujoco_model(mirrored, meshes=False)
    assert file.name.endswith("_mujoco_x40_y-20_theta29_z497.xml")
    wanted, found = (
        {
            (element.tag, element.get("name"), key): value
            for element in ElementTree.fromstring(text).iter()
            for key, value in element.attrib.items()
        }
        for text in ((tmp_path / "r.xml").read_bytes(), file.content)
    )
    assert found.keys() == wanted.keys()
    for key, value in wanted.items():
        if found[key] != value:  # the command reads millimeters
            own, other = (np.array(text.split(), float) for text in (found[key], value))
            np.testing.assert_allclose(own, other, atol=1e-9, err_msg=str(key))


def zip_of(file: File) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(file.content)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@pytest.mark.parametrize("name", ["usd", "dxf", "urdf"])
def test_programs_get_what_the_command_writes(name: str, mirrored: State) -> None:
    file = exports.program(mirrored, TARGETS[name], name)
    design = mirrored.shown_design
    wanted = TARGETS[name].files(design, np.array(mirrored.last_reachable.pose))
    elsewhere = TARGETS[name].files(design, np.array([0.0, 0.0, 0.1, 0.5]))
    assert (elsewhere != wanted) == TARGETS[name].posed
    if name != "urdf":
        assert file.name.endswith(f"_{name}_x40_y-20_theta29_z497{TARGETS[name].endings[0]}")
        assert [file.content] == list(wanted.values())
        return
    stem = file.name.removesuffix(".zip")
    assert stem.endswith("_urdf")
    assert zip_of(file) == {f"{stem}/{stem}{end}": content for end, content in wanted.items()}


@pytest.mark.slow
def test_code_is_the_designs(mirrored: State) -> None:
    design = mirrored.shown_design
    kit = exports.program(mirrored, CODE["controller"], "controller")
    assert kit.name.endswith("_controller.zip")
    inside = zip_of(kit)
    assert inside["controller/design.h"].decode() == controller_kit(design)["design.h"]
    if shutil.which("cc"):
        unit = exports.program(mirrored, CODE["inverse"], "inverse")
        assert unit.name.endswith(".fmu")
        wanted = fmu_sources(design, "inverse")
        assert zip_of(unit)["sources/design.h"].decode() == wanted["sources/design.h"]


def test_each_program_has_a_line_and_a_button() -> None:
    entries: dict[str, Any] = {entry.key: entry for entry in PANEL}
    listed = entries["export.programs"].content
    every = [*CODE.values(), *(each for name, each in TARGETS.items() if name != "glb")]
    buttons = {
        label
        for key in ("export.code", "export.models", "export.mujoco")
        for label in entries[key].choices
    }
    for each in every:
        assert f"<b>{each.label}</b> \N{NO-BREAK SPACE}{each.use}" in html.unescape(listed)
        assert each.label in buttons


def test_every_button_is_in_the_command_palette() -> None:
    groups = [entry for entry in PANEL if isinstance(entry, ButtonGroup)]
    named = [command.key for command in exports_of(PANEL)]
    assert len(set(named)) == len(named)
    for group in groups:
        choices = volume_choices() if callable(group.choices) else group.choices
        assert {f"{group.key}.{label}" for label in choices} <= set(named)


@pytest.mark.slow
def test_mujoco_loads_both_models_and_they_hold_their_pose(
    mujoco: Any, mirrored: State, tmp_path: Path
) -> None:
    plain, packed = (exports.mujoco_model(mirrored, meshes=meshes) for meshes in (False, True))
    (tmp_path / plain.name).write_bytes(plain.content)
    with zipfile.ZipFile(io.BytesIO(packed.content)) as archive:
        archive.extractall(tmp_path)
    for path in (tmp_path / plain.name, tmp_path / packed.name.removesuffix(".zip") / "robot.xml"):
        model = mujoco.MjModel.from_xml_path(str(path))
        data = mujoco.MjData(model)
        for _ in range(200):
            mujoco.mj_step(model, data)
        found = [data.joint(f"platform_{name}").qpos[0] for name in ("x", "y", "theta", "z")]
        np.testing.assert_allclose(found, mirrored.last_reachable.pose, atol=1e-4)
        assert model.body("payload").mass[0] == 3.25
    assert model.nmesh > 40


def test_mujoco_model_at_a_singular_pose_is_refused() -> None:
    with pytest.raises(InvalidInput, match="singular"):
        exports.mujoco_model(state_at(theta=np.radians(73.39845)), meshes=False)


def client(picture: Any, size: tuple[int, int] = (640, 480)) -> Any:
    """Return a tab whose page answers with a picture of height and width."""
    camera = SimpleNamespace(image_width=size[0], image_height=size[1])
    return SimpleNamespace(
        camera=camera, get_render=lambda height, width, **_: picture(height, width)
    )


@pytest.mark.parametrize(
    ("window", "size", "expected"),
    [
        ((640, 480), None, (640, 480)),
        ((640, 480), (320, 200), (320, 200)),
        ((2**40, 10), None, pictures.VIEW_SIDES[::-1]),
    ],
)
def test_view_has_the_size_chosen_or_that_of_the_window_within_limits(
    window: tuple[int, int], size: tuple[int, int] | None, expected: tuple[int, int]
) -> None:
    page = client(lambda h, w: np.full((h, w, 4), 7, dtype=np.uint8), window)
    file = pictures.view(state_at().updated("export", view_size=size), page)
    assert Image.open(io.BytesIO(file.content)).size == expected


@pytest.mark.parametrize(
    "answer",
    [
        lambda h, w: (_ for _ in ()).throw(TimeoutError()),
        lambda h, w: (_ for _ in ()).throw(SyntaxError("not a PNG")),
        lambda h, w: np.zeros((3, 3, 4), np.uint8),
        lambda h, w: np.zeros((h, w, 4), np.float64),
        lambda h, w: None,
    ],
    ids=["no answer", "no PNG", "another size", "no bytes", "nothing"],
)
def test_page_that_returns_no_picture_is_reported(answer: Any) -> None:
    with pytest.raises(pictures.NoView):
        pictures.view(state_at(), client(answer))


def started(desk: Desk) -> list[dict[str, Any]]:
    """Wait for files that come down, and return what the page is told of them."""
    return desk.until(
        lambda: [m for m in desk.page.received() if m["type"] == "FileTransferStartDownload"]
    )


def test_registered_table_format_has_a_button(
    server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(TABLE_FORMATS, "txt", lambda table: b"x" * len(table.columns))
    with desk_with(server, export_entries(STORE)) as desk:
        desk.set("export.table", "TXT")
        assert started(desk)[0]["filename"].endswith(".txt")
        assert desk.notices == []  # the page says itself that a file has come down


def test_latest_state_is_exported(desk: Desk) -> None:
    desk.dispatch(lambda s: actions.move(s, theta=0.7).updated("map_view", quantity="tau_3"))
    desk.until(lambda: "τ₃" in desk.handle("export.maps_heading").content)
    desk.dispatch(lambda state: actions.vary(state, {"leg1.bar_43": 2e-4}))
    desk.until(lambda: "legs are equal" in desk.handle("export.robot_heading").content)
    desk.set("export.single", "single map")
    desk.until(lambda: desk.state.export.single)
    desk.set("export.table", "NPZ")
    (file,) = started(desk)
    assert "tau-3_theta40" in file["filename"]
    assert file["filename"].endswith(".npz")
    assert file["size_bytes"] > 10_000
    assert file["save_immediately"]


@pytest.mark.slow
def test_refused_size_stops_no_later_export(desk: Desk) -> None:
    desk.set("export.dpi", 1e9)
    desk.noticed("50 to 600 is possible")
    desk.until(lambda: desk.handle("export.dpi").value == 300.0)
    desk.dispatch(lambda state: state.updated("export", single=True, width=80.0, dpi=50.0))
    for key, button, ending in (
        ("export.figure", "PNG", ".png"), ("export.figure", "SVG", ".svg"),
        ("export.figure", "PDF", ".pdf"), ("export.table", "CSV", ".csv"),
        ("export.scene", "Robot as GLB", ".glb"), ("export.mujoco", "MJCF", ".xml"),
        ("export.mujoco", "MJCF with meshes", ".zip"), ("export.models", "URDF", ".zip"),
        ("export.models", "USD", ".usda"), ("export.code", "C", ".zip"),
    ):  # fmt: skip
        desk.set(key, button)
        assert started(desk)[0]["filename"].endswith(ending)


def test_one_export_runs_at_a_time(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    waiting: list[bool] = []

    def slow(state: State) -> File:
        waiting.append(True)
        desk.noticed("One at a time")
        return File("slow.glb", b"x")

    monkeypatch.setattr(exports, "robot", slow)
    desk.set("export.scene", "Robot as GLB")
    desk.until(lambda: waiting)
    desk.set("export.table", "CSV")
    assert [m["filename"] for m in started(desk)] == ["slow.glb"]


def test_the_next_export_may_be_asked_for_when_a_file_comes_down(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    held: list[bool] = []
    client = desk.session.client
    monkeypatch.setattr(exports, "robot", lambda state: File("quick.glb", b"x"))
    monkeypatch.setattr(
        client, "send_file_download",
        lambda *_, **__: held.append(desk.session.exporting.locked()),
    )  # fmt: skip
    desk.set("export.scene", "Robot as GLB")
    desk.until(lambda: held)
    assert held == [False]


def test_unexpected_error_is_notified_and_logged(
    desk: Desk, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def broken(state: State) -> File:
        raise ZeroDivisionError

    monkeypatch.setattr(exports, "robot", broken)
    desk.set("export.scene", "Robot as GLB")
    desk.noticed("Not exported")
    assert "export failed" in caplog.text


@pytest.mark.slow
@pytest.mark.parametrize("make", [
    lambda state: exports.maps_table(state, STORE),
    lambda state: exports.motion_series(state)[1],
], ids=["maps", "motion"])  # fmt: skip
def test_copied_table_reads_as_the_file_with_tabs(make: Any) -> None:
    table = make(state_at(x=0.03, theta=np.pi / 3, z=-0.552))  # where the page opens, but for x
    text, file = table_text(table), table_csv(table).decode().splitlines()
    copied, length = text.splitlines(), len(text)
    assert length <= LONGEST
    head = [line for line in copied if line.startswith("#")]
    assert head == file[: len(head)]
    assert [line.split("\t") for line in copied[len(head) :]] == [
        line.split(",") for line in file[len(head) :]
    ]
