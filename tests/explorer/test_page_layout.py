"""What fonts can change: sizes of texts, and what of them is cut off or off the page."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from paminsa_viz.explorer.browser.style import NARROWEST, style_html
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.accuracy import monte_carlo, worst
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.features.calibration import actions as calibration
from paminsa_viz.explorer.features.compare.tab import COMPARISON
from paminsa_viz.explorer.features.drives import tab as drives
from paminsa_viz.explorer.features.identification import actions as identification
from paminsa_viz.explorer.features.loads.solving import ALONG_MOTION, find_loads
from paminsa_viz.explorer.features.motion import simulation
from paminsa_viz.explorer.features.requirements import actions as requirements
from paminsa_viz.explorer.features.springs import actions as springs
from paminsa_viz.explorer.features.stiffness import tab as stiffness
from paminsa_viz.explorer.features.synthesis import actions as synthesis
from paminsa_viz.explorer.features.tolerances import actions as tolerances
from paminsa_viz.explorer.features.view.tab import grouped_layers
from paminsa_viz.explorer.kit.design_numbers import GROUPS
from paminsa_viz.explorer.kit.design_numbers import label as label_of
from paminsa_viz.explorer.kit.entries import Answer, Entry, Html, Tabs
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.explorer.state.motion import Kind, Timing
from paminsa_viz.explorer.state.outcome import Outcome, solve
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.stiffness import ElasticJob
from paminsa_viz.explorer.state.synthesis import SearchResult
from paminsa_viz.explorer.strip import strip_html
from paminsa_viz.explorer.tabs import WORKSPACES, answers, sections
from paminsa_viz.files.design_writer import NAME_CHARACTERS
from paminsa_viz.model.design import PARAMETER
from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.synthesis.answer.prices import RequirementPrice
from paminsa_viz.synthesis.search.case import Regime
from paminsa_viz.synthesis.search.result import BoundOutcome, RelaxedBound, SynthesisResult
from tests.support.chromium import Tab, until
from tests.support.tasks import delivered, finished

if TYPE_CHECKING:
    from tests.support.page import Browser

pytestmark = pytest.mark.browser

STRIP = """tabs => tabs.map(tab => {
  const text = tab.querySelector("span");
  const {font, fontWeight, letterSpacing} = getComputedStyle(text);
  const {padding, borderLeftWidth} = getComputedStyle(tab);
  const cut = text.scrollWidth > text.clientWidth;
  const look = [font, letterSpacing, padding, borderLeftWidth].join();
  return {name: tab.title, top: tab.offsetTop, cut, fontWeight, look};
})"""


def test_workspaces_and_their_sections_take_a_row_each_and_none_is_cut(tab: Tab) -> None:
    def one_row(first: str, names: list[str], weight: str) -> None:
        row = f'[role="tablist"]:has(> [title="{first}"]) > [role="tab"]'
        found = tab.page.locator(row).evaluate_all(STRIP)
        assert [one["name"] for one in found] == names
        assert len({one["top"] for one in found}) == 1
        assert not any(one["cut"] for one in found)
        assert {one["fontWeight"] for one in found} == {weight}
        assert len({one["look"] for one in found}) == 1, "the name of the current one may be wider"

    for workspace in WORKSPACES:
        names = [section.name for section in workspace.sections]
        tab.open_tab(names[0])
        one_row("Robot", [one.name for one in WORKSPACES], "600")
        one_row(names[0], names, "400")


GAP = """height => {
  const strip = document.querySelector('[data-paminsa-mark~="strip"]');
  const row = document.querySelector('[data-paminsa-mark~="workspaces"]');
  Object.assign(strip.style, { height, boxSizing: "border-box" });
  const view = strip.closest(".mantine-ScrollArea-viewport");
  view.scrollTo(0, view.scrollHeight); // beyond the folder File, which may be open
  if (view.scrollTop < 100) return null; // what scrolls is still to come
  return row.getBoundingClientRect().top - strip.getBoundingClientRect().bottom;
}"""
"""How far the workspaces are below the strip while the rest scrolls [px]."""


def test_no_text_scrolls_between_the_strip_and_the_workspaces(tab: Tab) -> None:
    tab.page.set_viewport_size({"width": 1280, "height": 420})
    tab.open_tab("Pose")
    for height in ("84.75px", "84.25px", ""):  # in some fonts and zooms it is no whole number

        def gap(height: str = height) -> Any:
            return tab.page.evaluate(GAP, height)

        until(
            lambda: (found := gap()) is not None and -1.0 < found <= 0.0,
            f"nothing is seen below a strip of {height or 'its own'} height",
        )


AROUND = """() => {
  const folder = [...document.querySelectorAll('[aria-expanded="false"]')]
    .find(head => head.textContent === "Ranges" && head.offsetParent)?.parentElement;
  if (!folder) return null;
  const box = row => row.querySelector("input:not([type=hidden])").getBoundingClientRect();
  const line = folder.getBoundingClientRect().top;
  const [before, after] = [folder.previousElementSibling, folder.nextElementSibling].map(box);
  return [line - before.bottom, after.top - line];
}"""


ROOM = """() => {
  const parts = [...document.querySelectorAll(".pv-summary > *")];
  const view = parts[0].closest(".mantine-ScrollArea-root");
  const bar = view.querySelector('[data-orientation="vertical"][data-state="visible"]');
  return bar && bar.getBoundingClientRect().left
    - Math.max(...parts.map((part) => part.getBoundingClientRect().right));
}"""


def test_the_strip_keeps_clear_of_the_scrollbar(tab: Tab) -> None:
    tab.open_tab("Masses")
    assert until(lambda: tab.page.evaluate(ROOM), "the section scrolls") >= 1


def test_a_notice_holds_a_long_list_without_blanks(tab: Tab) -> None:
    columns = ",".join(f"theta{number}_rad" for number in range(9))
    tab.session.notify("Not possible", f"write {columns}", bad=True)
    notice = tab.page.locator(".mantine-Notification-description", has_text=columns)
    notice.wait_for()
    assert notice.evaluate("one => one.scrollWidth <= one.clientWidth + 1")


def test_a_shut_folder_has_as_much_room_below_it_as_above(tab: Tab) -> None:
    tab.open_tab("Synthesis")
    above, below = until(lambda: tab.page.evaluate(AROUND), "the folder")
    assert 10 < above < 25
    assert abs(below - above) < 6


def test_the_page_is_printed_on_one_sheet_as_on_the_screen(tab: Tab) -> None:
    content = tab.page.pdf(prefer_css_page_size=True)
    (sheet,) = re.findall(rb"/MediaBox *\[([^\]]*)\]", content)
    points = [0.75 * tab.page.viewport_size[side] for side in ("width", "height")]
    np.testing.assert_allclose([float(one) for one in sheet.split()], [0.0, 0.0, *points], atol=1.0)


def test_numbers_can_be_typed_digit_by_digit(tab: Tab) -> None:
    if tab.page.get_by_test_id("gallery").is_visible():  # another test has opened the folder
        tab.page.get_by_text("File", exact=True).first.click()
    limit = tab.element("Largest condition number")

    def is_seen() -> bool:
        place = limit.bounding_box()
        return bool(place) and place["y"] + place["height"] <= 720

    until(is_seen, "the last input of Pose is seen")
    tab.open_tab("Masses")
    for label, text, path in (
        ("m_B3 bar 4–3–7 [kg]", "12.5", "links.b3"),  # beyond the slider
        ("m_pl platform [kg]", "0.75", "platform.mass"),  # through an impossible 0
        ("m₅ B4, platform [kg]", "0.0625", "joints.j5"),  # finer than the slider
    ):
        field, thumb, number = tab.number_box(label), tab.slider(label), float(text)
        field.click()
        field.press("Control+a")
        field.press_sequentially(text, delay=120)
        field.press("Tab")
        until(lambda p=path, n=number: tab.state.document.design.value(p) == n, path)
        until(
            lambda t=thumb, n=number: float(t.get_attribute("aria-valuemax")) >= n,
            "the slider grows",
        )
        tab.page.wait_for_timeout(200)
        assert field.input_value() == text
        assert tab.state.document.design.value(path) == number


MEASURE = """uuids => uuids.map(uuid => {
  const label = document.querySelector(`label[for="${uuid}"]`);
  const seen = label.parentElement.querySelector(".pv-symbol") ?? label;
  const row = document.getElementById(uuid).parentElement;
  const field = row.querySelector("input:not([type=hidden])");
  const [text, box] = [seen.getBoundingClientRect(), field.getBoundingClientRect()];
  return {height: text.height, right: text.right, left: box.left, end: box.right,
          room: field.clientWidth - field.scrollWidth};
})"""

COLUMN = """() => [...document.querySelectorAll('[data-paminsa-mark~="row"]')]
  .map((row) => [row, row.querySelector("input:not([type=hidden])")])
  .filter(([, field]) => field?.checkVisibility())
  .map(([row, field]) => {
    const switched = field.type === "checkbox";
    const {paddingLeft, textAlign} = getComputedStyle(field);
    return {name: row.querySelector("label").textContent,
            left: (switched ? field.parentElement : field).getBoundingClientRect().left,
            text: switched ? "" : `${paddingLeft} ${textAlign}`};
  })"""
"""Where the boxes of inputs begin, and where their texts do [px]."""


def test_boxes_and_their_texts_begin_below_each_other(tab: Tab) -> None:
    tab.open_tab("Simulate")
    names = ("Control", "Bandwidth", "Friction is known")

    def column() -> list[Any]:
        found = tab.page.evaluate(COLUMN)
        return [one for name in names for one in found if one["name"].startswith(name)]

    found = until(lambda: len(column()) == len(names) and column(), "the inputs")
    lefts = [one["left"] for one in found]
    assert max(lefts) - min(lefts) < 1, found
    tab.open_tab("Single map")
    pair = next(one for one in tab.page.evaluate(COLUMN) if one["name"] == "Ends")
    assert {one["text"] for one in (*found, pair) if one["text"]} == {pair["text"]}


ROOMS = """one => [...one.closest(".mantine-Flex-root").querySelectorAll("[inputmode]")]
  .map(field => field.clientWidth - field.scrollWidth)"""


def test_nothing_is_cut_off(tab: Tab) -> None:
    width = tab.page.viewport_size["width"]
    tab.dispatch(lambda s: actions.vary(s, {"links.b1": 0.032967}))  # of a small robot
    for name in dict.fromkeys(group.tab for group in GROUPS):
        tab.open_tab(name)
        groups = [group for group in GROUPS if group.tab == name]
        for group in groups:
            if not group.open:
                tab.unfold(group.title)
            labels = [label_of(parameter) for parameter in group.parameters]
            uuids = [tab.handle(label)._impl.uuid for label in labels]

            def unfolded(uuids: list[str] = uuids) -> Any:
                found = tab.page.evaluate(MEASURE, uuids)
                return found if all(row["height"] > 12 for row in found) else None

            rows = until(unfolded, group.title)
            ends = [row["end"] for row in rows]
            assert max(ends) - min(ends) < 3, f"the boxes of {group.title} are not in line: {ends}"
            for text, row in zip(labels, rows, strict=True):
                assert row["height"] < 24, f"{text} takes two lines"
                assert row["right"] < row["left"], f"{text} runs into its number"
                assert row["room"] >= 0, f"the number of {text} is cut off"
                assert row["end"] <= width, f"the number of {text} is off the page"
    tab.open_tab("Single map")
    tab.dispatch(lambda s: s.updated("map_view", quantity="utilization"))  # of many digits
    ends = tab.page.get_by_label("Ends").locator("visible=true").first
    until(lambda: "." in ends.input_value(), "the range of the quantity")
    rooms = ends.evaluate(ROOMS)
    assert len(rooms) == 2
    assert min(rooms) >= 0, "an end of the color range is cut off"


CHECKBOXES = """() => [...document.querySelectorAll('[data-paminsa-mark~="checkbox-row"]')]
  .filter((row) => row.checkVisibility())
  .map((row) => [row.querySelector("label"), row.querySelector("input")])
  .map(([label, input]) => [label.textContent, label.getBoundingClientRect(),
                            input.getBoundingClientRect()])
  .map(([name, text, box]) => ({name, top: text.top, left: text.left, end: text.right,
                                box: box.left, right: box.right}))"""
"""Where labels and boxes of the switches are that are seen, in the order of the page [px]."""


@pytest.mark.parametrize("width", [1280, 1600])  # below the maps, and beside the third of them
def test_switches_of_torque_maps_do_not_cover_each_other(tab: Tab, width: int) -> None:
    tab.page.set_viewport_size({"width": width, "height": 900})
    tab.open_tab("Torque maps")
    found = until(
        lambda: len(found := tab.page.evaluate(CHECKBOXES)) == 3 and found, "the three switches"
    )
    assert all(one["end"] <= one["box"] for one in found), found
    for left, right in itertools.pairwise(found):
        assert right["top"] > left["top"] + 10 or left["right"] <= right["left"], found


def test_switches_of_layers_are_below_each_other_in_two_columns(tab: Tab) -> None:
    tab.page.get_by_role("tab", name="View").click()
    for name in list(grouped_layers())[1:]:
        tab.unfold(name)
    layers = {layer.label for layer in LAYERS.values()}

    def boxes() -> Any:
        found = tab.page.evaluate(CHECKBOXES)
        return [one for one in found if one["name"] in layers]

    found = until(lambda: len(boxes()) == len(layers) and boxes(), "the switches of all layers")
    assert len({round(one["box"]) for one in found}) == 2, found
    assert all(one["end"] <= one["box"] for one in found), found


def searched(state: State) -> State:
    """Return the state with an answer of the synthesis, as a search would have made it."""
    state = synthesis.SEARCH.start(state.updated("synthesis.settings", allow_overlap=True))
    job = state.synthesis.running
    assert job is not None
    bounds = state.document.requirements.bounds
    found = SynthesisResult(
        case=job.case, design=job.reference.vary({"geometry.base_radius": 0.4123}),
        workspace=replace(job.case.workspace, center=(0.0, 0.0, -0.5512)), regime=Regime.SMALLER,
        feasible=True, objective=0.4321,
        outcomes=tuple(BoundOutcome(bound, -12.345, -1.234, active=True) for bound in bounds),
        states=(), refused={Regime.LARGER: "R_pl is at most 0.3 m, R_b at least 0.3 m"},
        relaxed=tuple(RelaxedBound(bound, -12.345, 1.234) for bound in bounds),
        canceled=False, poses=1234,
    )  # fmt: skip
    state = delivered(synthesis.SEARCH, state, Outcome(job, SearchResult(found)))
    state = synthesis.PRICES.start(state)
    prices = state.synthesis.prices.running
    assert prices is not None
    priced = tuple(
        RequirementPrice(requirement_label(one), "N m", 10.0, 0.2, 0.42, 0.39, 0.075)
        for one in bounds
    )
    return delivered(synthesis.PRICES, state, Outcome(prices, priced))


def answered() -> State:
    """Return a state with an answer of each kind, of a robot under load and its reference."""
    state = motions.choose_preset(initial_state(), "arch")
    load = {"load.force_x": -123.4, "load.force_z": -987.6, "load.moment_z": 12.3}
    state = actions.vary(actions.move(state, x=0.08, y=-0.05, theta=-0.8), load)
    state = requirements.suggest(balancing.balance_now(state))
    state = state.updated("monte_carlo.settings", robots=20)
    state = state.updated("requirements.largest.settings", seconds=1.0)
    state = state.updated("calibration.settings", poses=24)
    for task in (
        monte_carlo.DRAW, springs.FIT, tolerances.DRAW, worst.WORST, drives.SEARCH,
        requirements.LARGEST, calibration.PROPOSE, balancing.FRONT,
    ):  # fmt: skip
        state = finished(task, task.start(state))
    state = finished(calibration.CALIBRATE, calibration.use_example(state))
    state = finished(identification.IDENTIFY, identification.use_examples(state))
    state = searched(state)
    job = ElasticJob(state.document.design, state.last_reachable.pose, "load")
    state = stiffness.ANALYSIS.deliver(state, solve(stiffness.analyze_elasticity, job))
    state = finished(simulation.SIMULATION, simulation.simulate(state))
    state = state.updated("loads.settings", along=True)
    analysis = compute(state).analysis
    assert analysis is not None
    return ALONG_MOTION.deliver(state, solve(find_loads, analysis))


WIDER = """() => [...document.querySelectorAll("section")].flatMap(section => {
  const end = section.getBoundingClientRect().right + 0.5;
  const range = document.createRange();
  const right = one => {
    range.selectNodeContents(one); // its texts, which may be wider than it
    return Math.max(one.getBoundingClientRect().right, range.getBoundingClientRect().right);
  };
  return [...section.querySelectorAll("*")]
    .filter(one => right(one) > end)
    .filter(one => !one.closest(".pv-scrolled"))
    .slice(-1)
    .map(one => `${section.id}: ${one.outerHTML}`);
})"""
"""What of each section is wider than it, by the innermost of it; without what can be scrolled."""


def pages(entries: Sequence[Entry], state: State) -> Iterator[Html]:
    """Yield the HTML of entries and of what is in them, as far as it is seen."""
    for entry in entries:
        inner = entry.tabs.values() if isinstance(entry, Tabs) else [getattr(entry, "entries", ())]
        if isinstance(entry, Answer) and not entry.exists(state):
            continue
        if entry.visible is not None and not entry.visible(state):
            continue
        if isinstance(entry, Html):
            yield entry
        for each in inner:
            yield from pages(each, state)


@pytest.mark.slow
def test_no_text_or_table_is_wider_than_the_narrowest_dock(browser: Browser) -> None:
    """Of the page's own texts and styles; what surrounds them in viser is padding on both sides."""
    state = answered()
    crossed = motions.change(
        motions.limit(motions.choose_kind(state, Kind.MOVE), "torque", 10.0),
        start=(0.03, 0.02, 0.8, -0.5), goal=(0.03, 0.02, 1.75, -0.5), timing=Timing.SHORTEST,
        cross=True,
    )  # fmt: skip
    design, reference = (
        replace(one, name=letter * NAME_CHARACTERS)
        for one, letter in ((state.document.design, "W"), (state.document.reference, "M"))
    )
    named = actions.change_document(state, design=design, reference=reference)
    numbers = {path: design.value(path) for path in PARAMETER}
    other = actions.pin_appendix(actions.vary(state, {
        path: value * (1.0123456 if path.startswith("geometry") else 0.1123456)
        for path, value in numbers.items()
        if path.startswith(("geometry", "links", "inertias")) and np.isfinite(value)
    }))  # fmt: skip
    missing = {answer.key for _, answer in answers() if not answer.exists(state)}
    assert missing == {"balance.tornado_answer", "identify.excited_answer"}  # a line and a chart
    tables = {path: section.entries() for path, section in sections().items()}
    tables |= {"comparison": [COMPARISON], "strip": [Html("strip", content=strip_html)]}
    texts = {}
    shown_states = {"all": state, "crossed": crossed, "named": named, "other": other}
    for name, shown in shown_states.items():
        frame = compute(shown)
        for path, entries in tables.items():
            texts[f"{path}, {name}"] = "".join(one.shown(frame) for one in pages(entries, shown))
    assert len([text for text in texts.values() if "<table" in text]) >= 20
    content = "".join(
        f'<section id="{key}" style="width: {NARROWEST}px" data-paminsa-mark="{key.split(",")[0]}">'
        f"{text}</section>"
        for key, text in texts.items()
    )
    page = browser.new_context().new_page()
    page.set_content(
        f"<!doctype html><body style='font-family: sans-serif'>{style_html()}{content}"
    )
    assert page.evaluate(WIDER) == []
    page.evaluate("document.querySelector('section td').style.minWidth = '500px'")
    assert len(page.evaluate(WIDER)) == 1
    page.close()


CONTRAST = """() => {
  const style = (selector, pseudo) => getComputedStyle(document.querySelector(selector), pseudo);
  return {
    dot: style("i").backgroundColor, pressed: style("button").backgroundColor,
    label: style("label").color, name: style("label", "::before").color,
    text: style("body").color, ground: style("body").backgroundColor,
  };
}"""


def test_a_pose_on_several_lines_of_a_table_begins_where_its_column_does(browser: Browser) -> None:
    page = browser.new_context().new_page()
    page.set_content(
        f"<!doctype html><body>{style_html()}<table class='pv-table' style='width: 160px'><tr>"
        "<td><b>θ [″]</b></td>"
        "<td class='pv-word'><button class='pv-link'>x 108.3 mm, y 62.5 mm</button></td></table>"
    )
    button, name = page.locator("button"), page.locator("b")
    assert button.evaluate("button => getComputedStyle(button).textAlign") == "left"
    top, high = button.bounding_box()["y"], name.bounding_box()["height"]
    assert button.bounding_box()["height"] > 1.5 * high  # several lines
    assert abs(name.bounding_box()["y"] - top) < 0.3 * high
    page.close()


def test_colors_that_say_something_and_names_of_inputs_hold_in_high_contrast(
    browser: Browser,
) -> None:
    page = browser.new_context(forced_colors="active").new_page()
    page.set_content(
        f"<!doctype html><body>{style_html()}<i class='pv-dot pv-m1'></i><div class='pv-reference'>"
        "<button aria-pressed='true'>none</button></div>"
        "<label data-paminsa-name='x'>x [mm]</label>"
    )
    seen = page.evaluate(CONTRAST)
    assert seen["label"] == "rgba(0, 0, 0, 0)", "it would lie over the name"
    assert seen["name"] == seen["text"]
    assert seen["ground"] not in (seen["dot"], seen["pressed"])
    assert "rgba(0, 0, 0, 0)" not in (seen["dot"], seen["pressed"])
    page.close()
