"""What works on this machine is found by trying it, optional parts too."""

import json
from importlib.metadata import PackageNotFoundError

import pytest

from workbench.commands import doctor


@pytest.fixture(autouse=True)
def _no_picture(monkeypatch) -> None:
    monkeypatch.setattr(doctor, "_opengl", lambda: doctor._finding("OpenGL", True, "tried elsewhere"))


def found(capsys) -> dict[str, dict]:
    assert doctor.examine(json=True) == 0
    return {row["what"]: row for row in json.loads(capsys.readouterr().out)["checks"]}


@pytest.fixture
def rows(monkeypatch):
    """EXTRAS in which nothing is imported."""

    def put(*names: str, trial=lambda: None) -> None:
        monkeypatch.setattr(doctor, "EXTRAS", tuple((name, name, ("numpy",), trial, "a use") for name in names))

    return put


def test_every_optional_part_has_a_row() -> None:
    assert {extra for _, extra, *_ in doctor.EXTRAS} == {"cad", "explore", "animate", "fast", "taylor", "cluster"}


def test_a_film_and_the_cad_kernel_are_tried_for_real(monkeypatch, capsys) -> None:
    monkeypatch.setattr(doctor, "EXTRAS", tuple(row for row in doctor.EXTRAS if row[1] in ("animate", "cad")))
    told = found(capsys)
    assert told["films (animate)"]["works"], told
    assert told["Open Cascade (cad)"]["installed"]


def test_what_is_not_installed_says_how_to_install_it(rows, monkeypatch, capsys) -> None:
    def missing(name):
        raise PackageNotFoundError(name)

    rows("part")
    monkeypatch.setattr(doctor, "version", missing)
    monkeypatch.setattr(doctor, "_drawing_versions", dict)
    row = found(capsys)["part (part)"]
    assert (row["works"], row["installed"]) == (False, False)
    assert "pip install 'rod-workbench[part]' (numpy is missing)" in row["said"]


def test_what_is_installed_but_fails_is_told_with_its_reason(rows, capsys) -> None:
    def fails() -> None:
        raise ImportError("libGL.so.1: no such file\nand more")

    rows("part", trial=fails)
    row = found(capsys)["part (part)"]
    assert (row["works"], row["installed"], row["said"]) == (False, True, "libGL.so.1: no such file")


def test_a_machine_without_chromium_is_told_the_packages(rows, monkeypatch, capsys) -> None:
    rows()
    monkeypatch.setattr(doctor.shutil, "which", lambda name: None)
    row = found(capsys)["Chromium"]
    assert not row["installed"]
    assert "apt-get install chromium chromium-driver" in row["said"]
