"""The explorer in one file, opened from a disk: its numbers, what it refuses, and how it works."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.explorer.core.persistence import dump, open_share_code, share_code
from paminsa_viz.explorer.features.one_file import one_file
from paminsa_viz.explorer.features.pose.tab import pose_limits
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.files.design_file import read_design
from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    InvalidInput,
    KneeBranch,
    LoadCase,
    LoadFrame,
    backend,
    check_reach,
    inverse_kinematics,
    static_torques,
    torque_breakdown,
)
from paminsa_viz.model.drive import Drive
from paminsa_viz.model.singularity import measure_singularity
from paminsa_viz.model.statics import static_imbalance
from paminsa_viz.quantities.requirements import Requirement, Requirements
from paminsa_viz.trajectory import PRESET
from tests.explorer.core.test_persistence import pack
from tests.explorer.features.one_file.opened import OTHER, START, Opened
from tests.support.chromium import until
from tests.support.samples import random_design, random_poses


def test_what_the_page_does_not_know_is_refused() -> None:
    weights = (Counterweight("b4", 9, 0.1, 1.0),)
    for place in ("design", "reference"):
        document = replace(START, **{place: replace(APPENDIX_4, counterweights=weights)})
        with pytest.raises(InvalidInput, match="counterweights"):
            one_file(document)


@pytest.mark.slow
def test_text_of_a_design_does_not_become_script() -> None:
    name = "</script><script>alert(1)//@PAGE@"
    text = one_file(replace(START, design=replace(APPENDIX_4, name=name)))
    assert text.count("</script>") == 1
    assert len(text.encode()) < 1_500_000


SOLVE = """async (rows) => {
  const { openShareCode, robotOf, solvePose } = window.paminsaPage;
  const found = [];
  for (const [code, c, s] of rows) {
    const doc = await openShareCode(code);
    const robot = robotOf(doc);
    const solved = solvePose(robot, doc.pose, c, s);
    found.push([solved.ok ? 1 : 0, robot.imbalance, solved.margin, ...solved.torques,
      ...solved.actuators, solved.determinant, solved.condition, solved.position,
      solved.rotation].map((value) => Number.isFinite(value) ? value : null));
  }
  return found;
}"""


def random_documents(count: int) -> Iterator[Document]:
    """Yield random designs at usable poses; both knees, half of them with a load."""
    rng = np.random.default_rng(32)
    while count > 0:
        design = random_design(rng)
        design = design.with_knee(list(KneeBranch)[rng.integers(2)])
        if rng.random() < 0.5:
            frame = list(LoadFrame)[rng.integers(2)]
            design = replace(design, load=LoadCase(*rng.normal(size=9), frame=frame))
        for x, y, theta, z in random_poses(rng, design, 5).tolist():
            yield Document(design=design, pose=(x, y, theta, z))
            count -= 1


@pytest.mark.browser
@pytest.mark.slow
def test_numbers_of_links_are_those_of_python(opened: Opened) -> None:
    documents = list(random_documents(300))
    rows = [[share_code(d), np.cos(d.pose[2]), np.sin(d.pose[2])] for d in documents]
    found = np.array(opened.page.evaluate(SOLVE, rows), dtype=float)
    wanted = []
    with backend.use_numpy():  # kernels round fewer times
        for document in documents:
            design, pose = document.design, document.pose
            reach = check_reach(design.geometry, pose)
            far = measure_singularity(design.geometry, pose)
            wanted.append([
                float(reach.ok), static_imbalance(design), reach.margins.min(),
                *static_torques(design, pose),
                *inverse_kinematics(design.geometry, pose).actuators,
                far.determinant, far.condition, far.position_distance, far.rotation_distance,
            ])  # fmt: skip
    wanted = np.array(wanted)
    wanted[~np.isfinite(wanted)] = np.nan
    np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-12)
    # Without arc functions and sums of products, cosine and sine given, they are the same bits.
    loaded = np.array([document.design.load.acts for document in documents])
    exact = [0, 1, 2, 3, 4, 5, 6]
    np.testing.assert_array_equal(found[~loaded][:, exact], wanted[~loaded][:, exact])


@pytest.mark.browser
@pytest.mark.slow
def test_maps_are_those_of_python(opened: Opened) -> None:
    run = """async ([code, radius, n]) => {
      const doc = await window.paminsaPage.openShareCode(code);
      const robot = window.paminsaPage.robotOf(doc);
      const [, , theta, z] = doc.pose;
      const maps = window.paminsaPage.solveMaps(robot, theta, z, radius, n);
      return maps.map((map) => Array.from(map, (v) => Number.isFinite(v) ? v : null));
    }"""
    radius, n = 0.3, 81
    for document in (START, OTHER):
        values = opened.page.evaluate(run, [share_code(document), radius, n])
        place = radius * (2 * (np.arange(n) + 0.5) / n - 1)
        y, x = np.meshgrid(place, place, indexing="ij")
        rest = [np.full(x.shape, value) for value in document.pose[2:]]
        torque = static_torques(document.design, np.stack([x, y, *rest], axis=-1))[..., :3]
        wanted = np.moveaxis(torque, -1, 0).reshape(3, -1)
        found = np.array(values, dtype=float)
        assert np.isfinite(found).mean() > 0.5
        # Next to a singularity the rounding of cos theta counts.
        np.testing.assert_allclose(found, wanted, rtol=1e-9)


@pytest.mark.browser
@pytest.mark.slow
def test_person_changes_undoes_shares_and_saves(opened: Opened) -> None:
    opened.open(share_code(START))
    page = opened.page
    x = page.locator('[id="pose.0.range"]')
    x.focus()
    x.press("ArrowRight")
    opened.wait(lambda found: found.pose[0] == 0.081)
    torque = static_torques(APPENDIX_4, (0.081, *START.pose[1:]))
    for value in torque[:3]:
        assert f"{value:.3f}".replace("-", "−") in opened.text("actuators")
    arm = page.locator('label[for="links.b1"]')
    assert arm.inner_html() == "<i>m</i><sub>B1</sub> arm [kg]"
    page.get_by_label("m₇ B3, B7 [kg]", exact=True).fill("1.25")
    page.get_by_label("m₇ B3, B7 [kg]", exact=True).press("Enter")
    page.get_by_role("button", name="Pin").click()
    page.get_by_role("button", name="Balance by m₇").click()
    balanced = opened.wait(lambda found: abs(static_imbalance(found.design)) < 1e-12)
    assert balanced.reference == APPENDIX_4.vary({"joints.j7": 1.25})
    assert "balanced by m₇ =\t3.063 kg" in opened.text("quality")
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Design as TOML").click()
    saved = read_design(Path(waiting.value.path()).read_bytes(), "download")
    assert saved == balanced.design
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Maps as PNG").click()
    assert Path(waiting.value.path()).read_bytes().startswith(b"\x89PNG")
    for redo in ("Control+Shift+Z", "Control+y"):
        page.keyboard.press("Control+z")
        opened.wait(lambda found: found.design.joints.j7 == 1.25)
        page.keyboard.press(redo)
        opened.wait(lambda found: found == balanced)
    page.reload()
    opened.wait_drawn()
    opened.wait(lambda found: found == balanced)
    assert page.get_by_role("columnheader", name="Difference").count() == 1


@pytest.mark.browser
@pytest.mark.slow
def test_drives_are_pinned_and_saved_and_what_a_file_lacks_is_said(opened: Opened) -> None:
    motor = Drive(
        name='Motor "A"', gear_ratio=50.0, rotor_inertia=1.5e-7, top_speed=400.0,
        envelope=((0.0, 2.0), (100.0, 0.5)), encoder_counts=2048.0, brake=True,
    )  # fmt: skip
    screw = Drive(transmission="screw", lead=0.01, lead_efficiency=0.9)
    driven = replace(APPENDIX_4, drives=(motor, None, motor, screw))
    required = Requirements((Requirement("condition", high=10.0),))
    opened.open(share_code(replace(START, design=driven, requirements=required)))
    page = opened.page
    page.get_by_label("Design name").fill("Arm\u00a02\u200b")  # as pasted; no file may have it
    page.get_by_label("Design name").press("Enter")
    page.get_by_role("button", name="Pin").click()
    found = opened.wait(lambda found: found.reference is not None)
    assert found.design == found.reference == driven
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Design as TOML").click()
    saved = read_design(Path(waiting.value.path()).read_bytes(), "download")
    assert saved == driven
    assert saved.name == "Arm?2?"
    assert "without the requirements" in page.locator("#message").inner_text()


MIDDLE = """(width) => {
  const most = Math.max(SHARE * innerHeight, 10 * LETTERS);
  const { panels: [, { left, top }], side } = layoutOf(width, most, LETTERS, 457);
  return [left + side / 2, top + side / 2];
}"""
"""Where the middle of the second map is in the picture of all [px]."""


@pytest.mark.browser
@pytest.mark.slow
def test_click_on_a_map_goes_there_and_the_knee_is_mirrored(opened: Opened) -> None:
    opened.open(share_code(START))
    box = opened.page.locator("#map").bounding_box()
    x, y = opened.page.evaluate(MIDDLE, box["width"])
    opened.page.mouse.click(box["x"] + x, box["y"] + y)
    opened.wait(lambda found: max(map(abs, found.pose[:2])) < 2e-3)
    assert "τ₂" in opened.page.locator("#hover").inner_text()
    opened.page.get_by_label("Knee branch").select_option("upper")
    found = opened.wait(lambda found: found.design.geometry.knee is KneeBranch.UPPER)
    assert check_reach(found.design.geometry, found.pose).ok


@pytest.mark.browser
@pytest.mark.slow
def test_presets_play_with_torques_by_cause_in_one_step(opened: Opened) -> None:
    opened.open(share_code(OTHER))
    page = opened.page
    page.get_by_label("Preset").select_option("quintic")
    plan = PRESET["quintic"].build(OTHER.design.geometry)
    opened.wait(lambda found: np.allclose(found.pose, plan.at(0.0).pose, atol=1e-9))
    page.get_by_role("button", name="Play").click()
    opened.wait(lambda found: np.allclose(found.pose, plan.at(plan.duration).pose, atol=1e-9))
    assert page.get_by_role("button", name="Play").is_visible()
    page.get_by_role("button", name="Undo").click()
    opened.wait(lambda found: np.allclose(found.pose, plan.at(0.0).pose, atol=1e-9))
    page.get_by_label("Time, share of the duration").fill("0.25")
    state = plan.at(0.25 * plan.duration)
    opened.wait(lambda found: np.allclose(found.pose, state.pose, atol=1e-9))
    parts = torque_breakdown(OTHER.design, *state)
    for values in (parts.gravity, parts.inertial, parts.velocity, parts.total):
        row = "\t".join(f"{value:.3f}" for value in values[:3]).replace("-", "−")
        assert row in opened.text("causes")
    # ranges and margins are those of the design of the link
    limits = pose_limits(OTHER.design.geometry)
    for index in (0, 1, 3):
        slider = page.locator(f'[id="pose.{index}.range"]')
        ends = float(slider.get_attribute("min") or 0), float(slider.get_attribute("max") or 0)
        assert ends == pytest.approx(limits[index])
    margins = check_reach(OTHER.design.geometry, state.pose).margins
    assert f"{1e3 * margins.ravel()[0]:.1f}" in opened.text("margins")


@pytest.mark.browser
@pytest.mark.slow
def test_a_duration_that_is_not_possible_is_refused(opened: Opened) -> None:
    opened.open(share_code(START))
    page = opened.page
    page.get_by_label("Preset").select_option("quintic")
    duration = page.get_by_label("Duration [s]")
    for typed in ("0,5", "100", "0.01", "-3", "1,000", "abc"):
        duration.fill(typed)
        duration.press("Enter")
        refused = typed != "0,5"
        until(lambda r=refused: page.locator("#message").is_visible() == r, f"{typed} s is judged")
        assert duration.input_value() == "0.5"
        # the motion is that of the box, not the preset's
        assert "over 0.50 s" in (page.locator("#chart").get_attribute("aria-label") or "")
    assert page.locator("#message").inner_text() == (
        "Duration: 0.05 to 60 s is possible; nothing was changed"
    )
    duration.fill("")
    duration.press("Enter")
    own = f"over {PRESET['quintic'].build(APPENDIX_4.geometry).duration:.2f} s"
    chart = page.locator("#chart")
    until(lambda: own in (chart.get_attribute("aria-label") or ""), "the preset's own duration")


CLIPBOARD_AS_IN_SAFARI = """() => {
  let inPress = false;
  addEventListener("click", () => { inPress = true; }, true);
  addEventListener("click", () => { inPress = false; });
  const taken = (take) => async (given) => {
    if (!inPress) throw new DOMException("not in a press", "NotAllowedError");
    window.taken = await take(given);
  };
  const value = {
    writeText: taken((text) => text),
    write: taken(async ([item]) => (await item.getType("text/plain")).text()),
  };
  Object.defineProperty(navigator, "clipboard", { value, configurable: true });
}"""
"""A clipboard that takes a text, or the promise of one, only while a press is handled."""


@pytest.mark.browser
@pytest.mark.slow
def test_links_are_copied_where_the_browser_asks_for_a_press(opened: Opened) -> None:
    opened.open(share_code(START))
    page = opened.page
    page.evaluate(CLIPBOARD_AS_IN_SAFARI)
    for button, word in (("Copy link", "The link"), ("Copy code", "The share code")):
        page.get_by_role("button", name=button).click()
        page.get_by_text(f"{word} is on the clipboard.").wait_for()
        assert open_share_code(page.evaluate("taken").rpartition("#")[2]) == START
    page.evaluate("() => { navigator.clipboard.write = () => Promise.reject(new Error()); }")
    page.get_by_role("button", name="Copy link").click()
    page.get_by_text(f"{opened.address}#PMZ1-").wait_for()  # to be copied by hand


@pytest.mark.browser
@pytest.mark.slow
def test_a_typed_number_is_taken_whole_or_refused_and_arrow_keys_step_it(opened: Opened) -> None:
    opened.open(share_code(START))
    page = opened.page
    box, message = page.get_by_label("x  [mm]", exact=True), page.locator("#message")
    for typed, found, says in (
        ("33,5", 33.5, ""),
        ("1,000", 33.5, "1,000 may be a thousand or a fraction: write 1.000 or 1000"),
        ("\u22124e1", -40.0, ""),
        ("abc", -40.0, "“abc” is not a number: write 33.5 or 33,5"),
        ("abc", -40.0, "“abc” is not a number: write 33.5 or 33,5"),
        (".5 ", 0.5, ""),
    ):
        box.focus()
        page.keyboard.press("Control+a")
        page.keyboard.type(typed)
        page.keyboard.press("Enter")
        until(lambda w=f"{found:g}": box.input_value() == w, f"{typed} is shown as {found}")
        opened.wait(lambda document, x=1e-3 * found: abs(document.pose[0] - x) < 1e-12)
        assert message.inner_text() == (says and f"{says}; nothing was changed")
    for key, shown in (("ArrowUp", "1.5"), ("ArrowDown", "0.5")):
        box.press(key)
        until(lambda w=shown: box.input_value() == w, f"{key} is a step")


@pytest.mark.browser
@pytest.mark.slow
def test_undo_is_the_texts_while_one_is_typed_and_the_pages_after(opened: Opened) -> None:
    opened.open(share_code(OTHER))
    page = opened.page
    name, mass = page.get_by_label("Design name"), page.get_by_label("m₇ B3, B7 [kg]", exact=True)
    mass.fill("1.25")
    mass.press("Enter")
    opened.wait(lambda found: found.design.joints.j7 == 1.25)
    name.focus()
    name.press("End")
    name.press_sequentially(" more")
    name.press("Control+z")
    assert name.input_value() != "Light, 3 kg more"
    assert mass.input_value() == "1.25"
    name.fill("Other")
    name.press("Enter")
    opened.wait(lambda found: found.design.name == "Other")
    name.press("Control+z")
    opened.wait(lambda found: found.design.name == "Light, 3 kg")
    name.press("Control+z")
    opened.wait(lambda found: found.design == OTHER.design)


@pytest.mark.browser
@pytest.mark.slow
def test_a_pose_that_no_link_can_hold_is_refused(opened: Opened) -> None:
    opened.open(share_code(OTHER))
    page = opened.page
    page.get_by_label("x  [mm]", exact=True).fill("1e10")
    page.get_by_label("x  [mm]", exact=True).press("Enter")
    assert "x of its pose: up to 1000000 m" in page.locator("#message").inner_text()
    page.get_by_label("y  [mm]", exact=True).fill("7")
    page.get_by_label("y  [mm]", exact=True).press("Enter")
    opened.wait(lambda found: found.pose == (0.05, 0.007, 0.4, -0.55))


@pytest.mark.browser
@pytest.mark.slow
def test_a_number_that_is_rounded_to_zero_has_no_sign(opened: Opened) -> None:
    opened.open(share_code(replace(START, pose=(-1e-6, -0.02, 0.4, -0.55))))
    label = opened.page.locator("#robot").get_attribute("aria-label") or ""
    assert "at x 0.0 mm, y −20.0 mm" in label


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.parametrize(
    ("link", "says"),
    [
        (share_code(OTHER)[:-30], "it is damaged or incomplete"),
        ("PMZ0-eJw", "it is from another version of paminsa_viz (packing 0)"),
        ("PMZ1-" + "A" * 50_000, "it is too long"),
        ("PMZ1-%3Cscript%3E", "it is damaged or incomplete"),
        (pack(dump(START).replace('"lower"', '"constructor"')), "it cannot be read"),
    ],
)
def test_link_that_cannot_be_opened_says_why(opened: Opened, link: str, says: str) -> None:
    before = opened.wait(lambda found: found)
    opened.page.evaluate("link => { location.hash = link; }", link)
    message = opened.page.locator("#message")
    until(lambda: says in message.inner_text(), "it is said")
    assert "\n" not in message.inner_text()
    opened.wait(lambda found: found == before)


@pytest.mark.browser
@pytest.mark.slow
def test_page_that_is_loaded_by_such_a_link_shows_what_it_was_written_with(opened: Opened) -> None:
    opened.open("PMZ0-eJw")
    message = opened.page.locator("#message")
    until(lambda: "it is from another version" in message.inner_text(), "it is said")
    opened.wait(lambda found: found == START)


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.parametrize("other", [OTHER, START])
def test_documents_pass_through_the_page_unchanged(opened: Opened, other: Document) -> None:
    run = """async (code) => {
      const { openShareCode, shareCode } = window.paminsaPage;
      return shareCode(await openShareCode(code));
    }"""
    found = open_share_code(opened.page.evaluate(run, share_code(other)))
    assert found == other
    assert found.design.name == other.design.name
