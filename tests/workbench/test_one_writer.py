"""`reproduce` and `run` store a study by one path: the very same file, and what one has stored the other answers."""

import sys
from pathlib import Path
from typing import Any

import pytest

from studies import READINGS
from tests.workbench import runs
from workbench.paper import report_runs
from workbench.paper.reproduce import reproduce
from workbench.scene import opengl

STUDIES = ["fig6", "fig7_2_radius", "fig7_4_end_angle"]  # a single case, an axis, and one that is followed


@pytest.fixture
def fast(monkeypatch: pytest.MonkeyPatch) -> Any:
    """`reproduce` of three studies, without scenes, and the readings of one panel."""
    found = report_runs.run_readings(report_runs.panels()[1:2], readings=tuple(READINGS)[:2])
    monkeypatch.setattr(opengl, "COMMAND", (sys.executable, "-c", "import os; os.abort()"))
    monkeypatch.setattr("studies.names", lambda: STUDIES)
    monkeypatch.setattr(report_runs, "run_readings", lambda panels, step: found)
    opengl.probe.cache_clear()
    yield
    opengl.probe.cache_clear()


@pytest.mark.slow
def test_reproduce_and_run_store_the_very_same_file_and_know_each_others(fast: Any, call: Any, tmp_path: Path) -> None:
    alone, folder = tmp_path / "alone", tmp_path / "out"
    alone.mkdir()
    folder.mkdir()
    call("run", "fig6", "--out", folder / "fig6.h5")
    stored = (folder / "fig6.h5").stat().st_mtime_ns
    reproduce(folder)
    assert (folder / "fig6.h5").stat().st_mtime_ns == stored  # complete already, and not solved again
    for name in STUDIES:
        call("run", name, "--out", alone / f"{name}.h5")
        assert runs.contents(alone / f"{name}.h5") == runs.contents(folder / f"{name}.h5"), name
        assert "already complete" in call("run", name, "--out", folder / f"{name}.h5")[1]
