"""What works on this machine is found by trying it, optional parts too."""

import json
import shutil
from collections.abc import Callable
from typing import Any

import pytest
from typer.testing import CliRunner

from workbench import cli
from workbench.commands.doctor import EXTRAS, Extra, examine


def found(*extras: Extra) -> dict[str, dict[str, Any]]:
    """The rows of the doctor by what they are about, without the scene that it draws."""
    return {row["what"]: row for row in examine(extras, opengl=False)}


def part(trial: Callable[[], None] = lambda: None, package: str = "numpy") -> Extra:
    return Extra("part", "part", (package,), trial, "a use")


def test_every_optional_part_has_a_row() -> None:
    assert {part.extra for part in EXTRAS} == {
        "cad",
        "explore",
        "animate",
        "taylor",
        "cluster",
        "parquet",
        "global",
        "contact",
    }


@pytest.mark.slow
def test_a_film_and_the_cad_kernel_are_tried_for_real() -> None:
    told = found(*(part for part in EXTRAS if part.extra in ("animate", "cad")))
    assert told["films (animate)"]["works"], told
    assert told["Open Cascade (cad)"]["installed"]


def test_what_is_not_installed_says_how_to_install_it() -> None:
    row = found(part(package="no-such-package"))["part (part)"]
    assert (row["works"], row["installed"]) == (False, False)
    assert "pip install 'rod-workbench[part]' (no-such-package is missing)" in row["said"]


def test_what_is_installed_but_fails_is_told_with_its_reason() -> None:
    def fails() -> None:
        raise ImportError("libGL.so.1: no such file\nand more")

    row = found(part(fails))["part (part)"]
    assert (row["works"], row["installed"], row["said"]) == (False, True, "libGL.so.1: no such file")


def test_a_machine_without_chromium_is_told_the_packages(monkeypatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    row = found()["Chromium"]
    assert not row["installed"]
    assert "apt-get install chromium chromium-driver" in row["said"]


def test_the_command_tells_every_part_and_the_versions() -> None:
    run = CliRunner().invoke(cli.app, ["doctor", "--json"])
    told = json.loads(run.stdout)
    assert [row["what"] for row in told["checks"]] == [
        "compiled core", "HDF5", "OpenGL", "fonts", *(f"{part.what} ({part.extra})" for part in EXTRAS), "Chromium",
    ]  # fmt: skip
    assert {"numpy", "vtk", "typer"} <= set(told["versions"])
