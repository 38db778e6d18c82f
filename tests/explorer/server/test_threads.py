"""What many threads send at once goes through the server's event loop, and all of it arrives."""

from __future__ import annotations

import asyncio
import threading
from collections import Counter

import pytest

from tests.support.guarded import GuardedServer
from tests.support.raw_page import eventually

THREADS, TIMES = 8, 200


@pytest.mark.slow
def test_no_event_of_the_loop_is_set_by_another_thread(
    guarded: GuardedServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    page, inputs = guarded.page()
    set_event, setters = asyncio.Event.set, Counter[str]()

    def noted(event: asyncio.Event) -> None:
        setters[threading.current_thread().name] += 1
        set_event(event)

    errors: list[Exception] = []

    def send(number: int) -> None:
        try:
            for i in range(TIMES):
                if i % 3:
                    inputs.count.value = number + THREADS * i
                else:
                    with page.client.atomic():
                        inputs.slider.value = i / TIMES
                        inputs.count.value = number + THREADS * i
                page.client.flush()
        except Exception as error:  # in a thread nobody would see it
            errors.append(error)

    monkeypatch.setattr(asyncio.Event, "set", noted)
    threads = [threading.Thread(target=send, args=(n,), name=f"sender {n}") for n in range(THREADS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    inputs.count.value = -1
    seen: list[dict] = []

    def arrived() -> bool:
        seen.extend(page.received())
        mine = [m for m in seen if m.get("uuid") == inputs.count._impl.uuid]
        return bool(mine) and mine[-1].get("updates", {}).get("value") == -1

    eventually(arrived)
    assert errors == []
    assert setters
    assert not [name for name in setters if name.startswith("sender")]
