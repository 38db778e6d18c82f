"""Files that the page offers: names, and contents that are read back."""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace
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
from paminsa_viz.explorer import actions, exports
from paminsa_viz.explorer.maps import FULL, MapStore
from paminsa_viz.explorer.panels.export_panel import export_entries
from paminsa_viz.explorer.state import State, initial_state
from paminsa_viz.files.design_file import save_design
from paminsa_viz.files.tables import TABLE_FORMATS
from paminsa_viz.model import InvalidInput, KneeBranch, inverse_kinematics, static_torques
from tests.support.desk import Desk, desk_with

STORE = MapStore()


def state_at(**pose: float) -> State:
    return actions.move(initial_state(), **pose)


class TestNames:
    def test_they_say_design_content_and_place(self) -> None:
        state = state_at(theta=np.pi / 3, z=-0.5)
        assert exports.file_name(state, "torque-maps", "png") == (
            "paminsa_appendix-4_torque-maps_theta60_z-500.png"
        )
        assert exports.file_name(state, "robot", "glb", at_pose=True) == (
            "paminsa_appendix-4_robot_x0_y0_theta60_z-500.glb"
        )

    def test_the_robot_s_file_is_named_after_where_it_stands(self) -> None:
        state = actions.move(state_at(x=0.03), x=9.0)
        assert "_x30_" in exports.file_name(state, "robot", "glb", at_pose=True)

    @pytest.mark.parametrize(
        ("name", "expected"),
        [
            ("../../etc/passwd", "etc-passwd"),
            ('a"b\r\nc: d', "a-b-c-d"),
            ("Große Türme №5", "groe-turme-no5"),
            ("机器人", ""),
            ("", ""),
            ("x" * 300, "x" * exports.LONGEST_NAME),
        ],
    )
    def test_any_design_s_name_becomes_a_harmless_one(self, name: str, expected: str) -> None:
        assert exports.plain(name) == expected


class TestContents:
    @pytest.mark.parametrize("single", [True, False])
    def test_numbers_equal_the_model_s(self, single: bool) -> None:
        state = state_at(theta=0.3).updated("map_view", quantity="f_4")
        file = exports.table(state, STORE, "npz", single)
        arrays = np.load(io.BytesIO(file.content))
        names = ["f4_N"] if single else ["tau1_Nm", "tau2_Nm", "tau3_Nm"]
        x, y = np.meshgrid(arrays["x_m"], arrays["y_m"])
        assert x.shape == (FULL, FULL)
        pose = np.stack([x, y, np.full_like(x, 0.3), np.full_like(x, arrays["pose"][3])], axis=-1)
        torque = static_torques(state.document.design, pose)
        ok = arrays["status"] == 0
        for i, name in enumerate(names):
            index = 3 if single else i
            np.testing.assert_allclose(arrays[name][ok], torque[..., index][ok], atol=1e-9)
            assert np.isnan(arrays[name][~ok]).all()

    def test_csv_and_npz_agree(self) -> None:
        state = state_at(theta=0.3)
        text = exports.table(state, STORE, "csv", True).content.decode()
        rows = [line for line in text.splitlines() if not line.startswith("#")]
        assert len(rows) == 1 + FULL**2
        values = np.array([float(row.split(",")[4] or "nan") for row in rows[1:]])
        arrays = np.load(io.BytesIO(exports.table(state, STORE, "npz", True).content))
        np.testing.assert_array_equal(values.reshape(FULL, FULL), arrays["max_tau_Nm"])

    def test_a_png_has_the_size_asked_for_and_is_not_blank(self) -> None:
        file = exports.figure(state_at(), STORE, "png", True, 90.0, 100.0)
        picture = np.asarray(Image.open(io.BytesIO(file.content)).convert("RGB"))
        assert picture.shape[1] == round(90 / 25.4 * 100)
        assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 100

    def test_svg_and_pdf(self) -> None:
        for kind, start in (("svg", b"<?xml"), ("pdf", b"%PDF")):
            file = exports.figure(state_at(), STORE, kind, True, 90.0, 100.0)
            assert file.content.startswith(start)
            assert file.name.endswith(f".{kind}")

    @pytest.mark.parametrize(
        ("kind", "width", "dpi"),
        [("png", 1e6, 300), ("png", 170, 5), ("png", 170, 1e9), ("png", -3, 300), ("gif", 90, 90)],
    )
    def test_what_can_not_be_made_is_refused(self, kind: str, width: float, dpi: float) -> None:
        with pytest.raises(InvalidInput):
            exports.figure(state_at(), STORE, kind, False, width, dpi)
        with pytest.raises(InvalidInput):
            exports.table(state_at(), STORE, "exe", False)

    def test_a_difference_is_said_to_be_one(self) -> None:
        state = actions.vary(actions.pin_reference(state_at()), {"links.b3": 1.0})
        state = state.updated("map_view", difference=True)
        file = exports.table(state, STORE, "npz", False)
        assert "difference" in file.name
        assert "delta_tau1_Nm" in np.load(io.BytesIO(file.content)).files

    def test_the_robot_stands_in_the_file_as_it_stands(self) -> None:
        state = actions.move(state_at(x=0.04, theta=0.5), x=9.0)
        scene: Any = trimesh.load(
            io.BytesIO(exports.robot(state).content), file_type="glb", force="scene"
        )
        place = scene.graph.get("platform")[0]
        configuration = inverse_kinematics(state.standing.geometry, state.standing.pose)
        x, y, _, z = configuration.pose
        np.testing.assert_allclose(place[:3, 3], (x, z, -y), atol=1e-6)  # y is up in a GLB


class TestMujocoModel:
    @pytest.fixture
    def state(self) -> State:
        """A design of its own, mirrored and posed, and then asked for too much."""
        state = actions.set_knee(initial_state(), KneeBranch.UPPER)
        state = actions.vary(state, {"payload.mass": 3.25, "geometry.crank_length": 0.44})
        return actions.move(actions.move(state, x=0.04, y=-0.02, theta=0.5), x=9.0)

    def test_it_is_the_command_s(self, state: State, tmp_path: Path) -> None:
        save_design(state.document.design, tmp_path / "d.toml")
        x, y, theta, z = state.standing.pose
        pose = (1e3 * x, 1e3 * y, np.degrees(theta), 1e3 * z)
        words = ["--design", str(tmp_path / "d.toml"), "--assembly", "mirror"]
        words += ["--mjcf", str(tmp_path / "r.xml"), "--pose", *map(repr, map(float, pose))]
        assert main(["export", *words]) == 0
        file = exports.mujoco_model(state, meshes=False)
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

    def test_mujoco_loads_both_and_they_stand(self, state: State, tmp_path: Path) -> None:
        mujoco = pytest.importorskip("mujoco", reason="mujoco comes with the extra 'verify'")
        plain = exports.mujoco_model(state, meshes=False)
        (tmp_path / plain.name).write_bytes(plain.content)
        packed = exports.mujoco_model(state, meshes=True)
        with zipfile.ZipFile(io.BytesIO(packed.content)) as archive:
            archive.extractall(tmp_path)
        folder = packed.name.removesuffix(".zip")
        for path in (tmp_path / plain.name, tmp_path / folder / "robot.xml"):
            model = mujoco.MjModel.from_xml_path(str(path))
            data = mujoco.MjData(model)
            for _ in range(200):
                mujoco.mj_step(model, data)
            found = [data.joint(f"platform_{name}").qpos[0] for name in ("x", "y", "theta", "z")]
            np.testing.assert_allclose(found, state.standing.pose, atol=1e-4)
            assert model.body("payload").mass[0] == 3.25
        assert model.nmesh > 40

    def test_a_singular_pose_is_refused(self) -> None:
        with pytest.raises(InvalidInput, match="singular"):
            exports.mujoco_model(state_at(theta=np.radians(73.39845)), meshes=False)


class TestView:
    asked: tuple[int, int] = (0, 0)

    def client(self, picture: Any, size: tuple[int, int] = (640, 480)) -> Any:
        def render(height: int, width: int, **_: Any) -> Any:
            self.asked = (width, height)
            return picture(height, width)

        camera = SimpleNamespace(image_width=size[0], image_height=size[1])
        return SimpleNamespace(camera=camera, get_render=render)

    @pytest.mark.parametrize("size", [None, (320, 200)])
    def test_it_has_the_size_asked_for(self, size: tuple[int, int] | None) -> None:
        client = self.client(lambda h, w: np.full((h, w, 4), 7, dtype=np.uint8))
        file = exports.view(state_at(), client, size)
        assert Image.open(io.BytesIO(file.content)).size == (size or (640, 480))

    def test_a_page_that_claims_a_huge_window(self) -> None:
        client = self.client(lambda h, w: np.zeros((h, w, 4), np.uint8), (2**40, 10))
        exports.view(state_at(), client, None)
        assert self.asked == (exports.VIEW_SIDES[1], exports.VIEW_SIDES[0])

    @pytest.mark.parametrize(
        "answer",
        [
            lambda h, w: (_ for _ in ()).throw(TimeoutError()),
            lambda h, w: (_ for _ in ()).throw(SyntaxError("not a PNG")),
            lambda h, w: np.zeros((3, 3, 4), np.uint8),
            lambda h, w: np.zeros((h, w, 4), np.float64),
            lambda h, w: None,
        ],
    )
    def test_a_page_that_gives_no_picture(self, answer: Any) -> None:
        with pytest.raises(exports.NoView):
            exports.view(state_at(), self.client(answer), None)


PANEL = export_entries(STORE)


def started(desk: Desk) -> list[dict[str, Any]]:
    return [m for m in desk.page.received() if m["type"] == "FileTransferStartDownload"]


class TestPanel:
    def test_a_registered_table_format_has_a_button(
        self, server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setitem(TABLE_FORMATS, "txt", lambda table: b"x" * len(table.columns))
        with desk_with(server, export_entries(STORE)) as desk:
            desk.set(desk.handle("export.table"), "TXT")
            desk.until(lambda: any(title == "Exported" for title, _ in desk.told))
            assert started(desk)[0]["filename"].endswith(".txt")

    def test_a_button_sends_the_file(self, desk: Desk) -> None:
        desk.set(desk.handle("export.table"), "NPZ")
        desk.until(lambda: any(title == "Exported" for title, _ in desk.told))
        (file,) = started(desk)
        assert file["filename"].endswith(".npz")
        assert file["size_bytes"] > 10_000
        assert file["save_immediately"]

    def test_the_newest_state_is_saved(self, desk: Desk) -> None:
        desk.dispatch(lambda s: actions.move(s, theta=0.7))
        desk.dispatch(lambda s: s.updated("map_view", quantity="tau_3"))
        desk.set(desk.handle("export.single"), "single map")
        desk.until(lambda: desk.state.export.single)
        desk.set(desk.handle("export.table"), "NPZ")
        desk.until(lambda: any("tau-3_theta40" in body for _, body in desk.told))

    def test_an_impossible_size_is_told_and_the_next_one_works(self, desk: Desk) -> None:
        desk.set(desk.handle("export.dpi"), 1e9)
        desk.until(lambda: any("50 to 600 is possible" in body for _, body in desk.told))
        desk.until(lambda: desk.handle("export.dpi").value == 300.0)
        desk.set(desk.handle("export.scene"), "Robot as GLB")
        desk.until(lambda: any("robot" in body for _, body in desk.told))
        desk.set(desk.handle("export.mujoco"), "MJCF with meshes")
        desk.until(lambda: any(".zip" in body for _, body in desk.told))

    def test_one_at_a_time(self, desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
        waiting: list[bool] = []

        def slow(state: State) -> exports.File:
            waiting.append(True)
            desk.until(lambda: any(title == "One at a time" for title, _ in desk.told))
            return exports.File("slow.glb", b"x")

        monkeypatch.setattr(exports, "robot", slow)
        desk.set(desk.handle("export.scene"), "Robot as GLB")
        desk.until(lambda: waiting)
        desk.set(desk.handle("export.table"), "CSV")
        desk.until(lambda: any(body.startswith("slow.glb") for _, body in desk.told))
        assert [m["filename"] for m in started(desk)] == ["slow.glb"]

    def test_a_fault_is_told_and_logged(
        self, desk: Desk, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
    ) -> None:
        def broken(state: State) -> exports.File:
            raise ZeroDivisionError

        monkeypatch.setattr(exports, "robot", broken)
        desk.set(desk.handle("export.scene"), "Robot as GLB")
        desk.until(lambda: any(title == "Not exported" for title, _ in desk.told))
        assert "export failed" in caplog.text

    def test_it_says_what_the_single_map_is(self, desk: Desk) -> None:
        desk.dispatch(lambda s: replace(s, map_view=replace(s.map_view, quantity="condition")))
        desk.until(lambda: "condition number" in desk.handle("export.maps_heading").content)
