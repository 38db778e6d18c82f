"""A notebook's stop button leaves no library imported by half."""

from __future__ import annotations

import signal
import sys
from pathlib import Path

import pytest

from paminsa_viz.interrupts import import_whole

STOPPED = """
import _thread, sys, time
sys.stopped = getattr(sys, "stopped", 0) + 1
_thread.interrupt_main()
for _ in range(20):
    time.sleep(0.001)
whole = True
"""


@pytest.fixture
def _stop_button(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "stopped", 0, raising=False)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a test's worker has none
    yield
    signal.signal(signal.SIGINT, before)
    sys.modules.pop("stopped_library", None)


@pytest.mark.usefixtures("_stop_button")
def test_an_interrupted_import_is_completed(tmp_path: Path) -> None:
    (tmp_path / "stopped_library.py").write_text(STOPPED)
    with pytest.raises(KeyboardInterrupt):
        import_whole("stopped_library")
    assert import_whole("stopped_library").whole
    assert sys.stopped == 1  # type: ignore[attr-defined]


@pytest.mark.usefixtures("_stop_button")
def test_an_error_of_an_import_is_that_of_the_module(tmp_path: Path) -> None:
    (tmp_path / "stopped_library.py").write_text("import nothing_of_this_name")
    with pytest.raises(ModuleNotFoundError) as caught:
        import_whole("stopped_library")
    assert caught.value.name == "nothing_of_this_name"
