"""The small raster: lines have the right weight and place, words the right size."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from paminsa_viz.plots.canvas import Canvas, Stroke, text_width


def ink(canvas: Canvas) -> np.ndarray:
    """Return how dark every pixel is, 0 to 1."""
    return 1 - canvas.pixels[:, :, 0] / 255.0


@pytest.mark.parametrize("angle", np.linspace(0, np.pi, 13))
@pytest.mark.parametrize("width", [1.0, 2.0])
def test_a_line_has_the_weight_of_its_length_and_width(angle: float, width: float) -> None:
    canvas = Canvas(120, 120)
    way = 40 * np.array([np.cos(angle), np.sin(angle)])
    line = np.array([60 - way, 60 + way])
    canvas.strokes([Stroke([line], width=width)], "#000000")
    assert ink(canvas).sum() == pytest.approx(80 * width, rel=0.06)
    rows, columns = np.nonzero(ink(canvas) > 0.2)
    off = (columns + 0.5 - 60) * np.sin(angle) - (rows + 0.5 - 60) * np.cos(angle)
    assert np.abs(off).max() < width / 2 + 1


def test_strokes_leave_nothing_behind_for_the_next() -> None:
    line = [np.array([[10.0, 10.0], [50.0, 30.0]])]
    first, second = Canvas(80, 60), Canvas(80, 60)
    first.strokes([Stroke(line)], "#000000")
    other = Canvas(300, 200)
    other.strokes([Stroke([np.array([[5.0, 5.0], [290.0, 180.0]])], width=3)], "#ff0000")
    second.strokes([Stroke(line)], "#000000")
    assert np.array_equal(first.pixels, second.pixels)


def test_threads_do_not_disturb_each_other() -> None:
    rng = np.random.default_rng(1)
    drawings = [[rng.uniform(-20, 220, (30, 2)) for _ in range(4)] for _ in range(24)]

    def draw(lines: list[np.ndarray]) -> np.ndarray:
        canvas = Canvas(200, 200)
        canvas.strokes([Stroke(lines, width=1.5)], "#103050")
        return canvas.pixels

    alone = [draw(lines) for lines in drawings]
    with ThreadPoolExecutor(8) as pool:
        together = list(pool.map(draw, drawings))
    assert all(np.array_equal(a, b) for a, b in zip(alone, together, strict=True))


def test_dashes_leave_gaps() -> None:
    canvas = Canvas(220, 20)
    canvas.strokes([Stroke([np.array([[10.0, 10.0], [210.0, 10.0]])], dash=(6, 4))], "#000000")
    assert ink(canvas).sum() == pytest.approx(120, rel=0.08)
    column = ink(canvas).sum(axis=0)[10:210]
    assert (column < 0.05).sum() > 30


def test_what_lies_off_the_canvas_is_left_out() -> None:
    canvas = Canvas(30, 30)
    far = [np.array([[-500.0, 900.0], [800.0, -700.0]]), np.array([[1.0, 1.0], [1.0, 1.0]])]
    canvas.strokes([Stroke(far), Stroke([]), Stroke([np.zeros((1, 2))])], "#000000")
    canvas.disc(-3, 15, 6, "#000000")
    canvas.disc(500, 500, 6, "#000000")
    canvas.text(28, 2, "words", 12, "#000000")
    assert canvas.pixels.shape == (30, 30, 3)


def test_a_disc_has_its_area() -> None:
    canvas = Canvas(40, 40)
    canvas.disc(20.3, 19.6, 8.0, "#000000")
    assert ink(canvas).sum() == pytest.approx(np.pi * 64, rel=0.02)


def test_words_take_their_room_and_stay_in_it() -> None:
    for upright in (False, True):
        canvas = Canvas(200, 200)
        canvas.text(100, 100, "y [mm] −200 τ₁", 14, "#000000", upright=upright)
        rows, columns = np.nonzero(ink(canvas) > 0.1)
        along, across = (rows, columns) if upright else (columns, rows)
        assert abs(np.ptp(along) - text_width("y [mm] −200 τ₁", 14)) <= 3
        assert np.ptp(across) < 18
        assert abs(along.mean() - 100) < 8
