"""Uploaded files are read off the event loop and in bounded time."""

from __future__ import annotations

import threading

from paminsa_viz.explorer.features.motion import description as motion_description
from tests.support.desk import Desk
from tests.support.raw_page import RawPage, upload_messages

PANEL = motion_description.DESCRIPTION
TABLE = b"t_s,x_m,y_m,theta_rad,z_m\n0,0,0,0,-0.5\n1,0.01,0,0,-0.5\n"


def upload(desk: Desk, content: bytes) -> None:
    button = desk.handle("motion.file.upload")._impl.uuid
    for message in upload_messages(button, content, "motion.csv"):
        desk.page.send(message)


def test_a_table_that_takes_too_long_is_refused(desk: Desk, monkeypatch) -> None:
    monkeypatch.setattr(motion_description, "UPLOAD_TIMEOUT", 0.0)
    upload(desk, TABLE)
    desk.noticed("motion.csv: takes longer than 0 s to read; thin it out")


def test_other_pages_are_served_while_a_file_is_read(desk: Desk, server, monkeypatch) -> None:
    reading, done = threading.Event(), threading.Event()
    read = motion_description.parse_trajectory

    def slowly(*words, **options):
        reading.set()
        assert done.wait(10)
        return read(*words, **options)

    monkeypatch.setattr(motion_description, "parse_trajectory", slowly)
    upload(desk, TABLE)
    assert reading.wait(10)
    RawPage(server).socket.close()  # connects, and gets what a page starts with
    assert not desk.notices
    done.set()
    desk.noticed("motion, 2 rows")
