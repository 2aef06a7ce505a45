"""Sections of rods in studies, files, commands and on the page of named sections."""

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
import workbench.accessor  # noqa: F401  (registers ds.rod)
from solver import Case, Rod, Start, solve
from studies.language.loader import dumps, loads
from tests.workbench import doc_pages, small
from workbench.run import in_memory, writing
from workbench.stored import reading, stored_verdicts
from workbench.stored.stored_study import StoredStudy

START = {"a": 0.0635, "L": 8.0, "R": 0.108, "beta": 0.3, "dbeta": 0.1, "dgamma": 0.2, "F3": 20.0}
KEYS = {"observables": ["height", "twist_energy"], "outputs": ["beta", "alpha", "z"], "stations": 41}
TUBE = small.text({"E": 2.06e8, "nu": 0.3, **START}, small.axis("inner_radius", [0.0, 0.04, 0.0543]), "m kN", **KEYS)
RATIO = {"kind": "equals", "formula": "bending_stiffness/torsional_stiffness", "relative": 1e-12}
DIRECT = small.text(
    {**START, "GJ": 900.0},
    small.axis("EI", (1000.0, 1500.0, 3)) + '[expressions]\nratio = "EI/GJ"\n' + small.law("ratio", "EI", **RATIO),
    "m kN",
    **KEYS,
)


@pytest.mark.parametrize("text", (TUBE, DIRECT), ids=("tube", "given"))
def test_a_study_of_a_section_goes_through_toml_and_back(text: str) -> None:
    study = loads(text)
    again = loads(dumps(study))
    assert again.model_dump(exclude={"name"}) == study.model_dump(exclude={"name"})
    np.testing.assert_array_equal(again.case().rod.bending_stiffness, study.case().rod.bending_stiffness)


@cache
def solved(text: str) -> xr.Dataset:
    return in_memory.run(loads(text))


@pytest.fixture(name="stored", params=(TUBE, DIRECT), ids=("tube", "given"))
def _stored(request: Any, tmp_path: Path) -> Iterator[xr.Dataset]:
    writing.write(solved(request.param), tmp_path / "s.h5")
    with reading.open_study(tmp_path / "s.h5") as ds:
        yield ds


def test_what_reads_a_file_uses_the_stiffness_of_its_section(stored: xr.Dataset) -> None:
    axis = str(stored["outcome"].dims[0])
    case = loads(TUBE if axis == "inner_radius" else DIRECT).case()
    A = case.rod.bending_stiffness
    for k in range(3):
        assert np.broadcast_to(A, case.shape)[k] == StoredStudy(stored).select({axis: k}).centreline.A
    np.testing.assert_array_equal(stored.rod.M2, A[:, None] * np.sin(stored["beta"]) ** 2 / stored["rho"])
    if axis == "EI":
        (verdict,) = stored_verdicts.verdicts(stored)
        assert verdict["verdict"] == "true"


def test_the_page_of_sections_runs_and_prints_what_it_says(capsys: pytest.CaptureFixture[str]) -> None:
    page = doc_pages.read(Path(__file__).parents[2] / "docs" / "reference" / "quantities.md", "Sections of rods")
    code = "\n".join(re.findall(r"```python\n(.*?)```", page, re.DOTALL))
    names: dict[str, Any] = {}
    exec(compile(code, "quantities.md", "exec"), names)
    assert capsys.readouterr().out.splitlines() == re.findall(r"print\(.*\)  # (.*)", code)
    rods = {name: value for name, value in names.items() if isinstance(value, Rod)}
    assert set(rods) == {"drill_pipe", "free", "stuck", "dna"}
    # the second moment of seven wires by Steiner's theorem, and of the solid bar about them
    d = 5.0
    places = [0.0, *(d * np.sin(np.arange(6) * np.pi / 3))]
    stuck = sum(np.pi * d**4 / 64 + np.pi * d**2 / 4 * y**2 for y in places) * 2e5
    assert pytest.approx(stuck, rel=1e-12) == rods["stuck"].EI
    solid = Rod(2.06e8, 0.3, 0.0635, 1.0).bending_stiffness
    bore = 100 * (1 - rods["drill_pipe"].bending_stiffness / solid)
    assert f"A = {solid:.1f}: the bore takes {bore:.0f} %" in " ".join(page.split())
    for rod in rods.values():
        assert solve(Case(rod, solver.Cylinder(2 * rod.a), Start(0.1, 0.0, M3=0.0)), stations=3).solved
