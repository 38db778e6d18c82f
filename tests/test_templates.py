"""Templates: what is compiled is kept, and what it keeps is no other template's."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import pytest
from jinja2 import TemplateNotFound, UndefinedError

from paminsa_viz import templates


def test_compiled_templates_are_kept_between_environments(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.j2").write_text("{{ x }}<b>")
    compiled: list[str] = []
    compile_ = templates.Environment.compile

    def counted(self: Any, source: Any, *rest: Any, **options: Any) -> Any:
        compiled.append(source)
        return compile_(self, source, *rest, **options)

    monkeypatch.setattr(templates.Environment, "compile", counted)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    for _ in range(2):
        assert (
            templates.html_environment([tmp_path]).get_template("a.j2").render(x="<") == "&lt;<b>"
        )
    assert len(compiled) == 1
    (tmp_path / "a.j2").write_text("{{ x }}!")
    assert templates.html_environment([tmp_path]).get_template("a.j2").render(x=1) == "1!"
    assert len(compiled) == 2


def test_without_a_folder_for_them_templates_are_compiled_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def nowhere(*_: Any) -> None:
        raise RuntimeError("no temporary folder")

    monkeypatch.setattr(templates, "FileSystemBytecodeCache", nowhere)
    (tmp_path / "a.j2").write_text("{{ x }}")
    assert templates.html_environment([tmp_path]).get_template("a.j2").render(x=3) == "3"


def test_a_name_that_is_missing_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "a.j2").write_text("{{ y }}")
    with pytest.raises(UndefinedError, match="'y' is undefined"):
        templates.html_environment([tmp_path]).get_template("a.j2").render(x=3)


def test_templates_may_be_in_a_zip_file(tmp_path: Path) -> None:
    """As those of a package that a cluster gets in one."""
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("pack/one/a.j2", "{% include 'two/b.j2' %}!")
        archive.writestr("pack/two/b.j2", "{{ x }}")
    pack = zipfile.Path(tmp_path / "a.zip", "pack/")
    environment = templates.html_environment([pack / "one", pack])
    assert environment.get_template("a.j2").render(x=3) == "3!"
    with pytest.raises(TemplateNotFound, match="c"):
        environment.get_template("c.j2")
