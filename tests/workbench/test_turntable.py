"""Scenes as offline HTML files, and what a notebook shows."""

import base64
import json
import re
from dataclasses import replace
from html import unescape
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib import image

import workbench.accessor  # noqa: F401  # registers ds.rod
from solver import Case, Cylinder, Ends, Rod, Solution, Start, equilibria, solve
from studies.language.loader import loads
from tests.workbench import browser, node, small
from tests.workbench.command import exit_status
from tests.workbench.waiting import until
from workbench import notebook
from workbench.run import in_memory
from workbench.stored.stored_study import StoredStudy
from workbench.web.turntable import turntable_page
from workbench.web.turntable.turntable_page import turntable_of_dataset


@pytest.fixture(scope="module")
def ds() -> xr.Dataset:
    return small.study_dataset("fig7_1_modulus")


def data_of(text: str) -> dict[str, Any]:
    """The data of the one turntable of a file."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    assert found
    return json.loads(found[1])["figures"]["rod"]


def test_the_file_asks_for_nothing_and_is_small(ds: xr.Dataset) -> None:
    text = turntable_page.html(StoredStudy(ds))
    assert not re.search(r'https?://(?!www\.w3\.org/2000/svg)|@import|url\(|src="', text)
    assert "default-src 'none'" in unescape(text)
    assert len(text) < 0.3e6


@pytest.mark.slow
def test_axe_finds_nothing_that_bars_people_from_a_scene(ds: xr.Dataset, tmp_path: Path) -> None:
    file, script = tmp_path / "x.html", browser.axe(tmp_path)
    file.write_text(turntable_page.html(StoredStudy(ds)), encoding="utf-8")
    with browser.chromium(tmp_path / "chromium", "1366,1000") as driver:
        driver.get(file.as_uri())
        for scheme in ("light", "dark"):
            browser.emulate(driver, prefers_color_scheme=scheme)
            assert browser.barriers(driver, script) == []


@pytest.mark.slow
@pytest.mark.parametrize("wide", [780, 1100])
def test_a_scene_fits_its_frame_in_a_notebook(ds: xr.Dataset, wide: int, tmp_path: Path) -> None:
    file = ds.rod.scene().save(tmp_path / "scene.html")
    with browser.chromium(tmp_path / "chromium", "1366,1000") as driver:
        frame = {"width": wide, "height": notebook.HEIGHT, "deviceScaleFactor": 1, "mobile": False}
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", frame)
        driver.get(file.as_uri())
        high, view = driver.execute_script(
            "return [document.documentElement.scrollHeight, document.querySelector('.view').clientHeight]"
        )
    assert high <= notebook.HEIGHT  # no bar to scroll
    assert view > 0.38 * notebook.HEIGHT


@pytest.mark.slow
def test_on_paper_a_scene_shows_its_rod(ds: xr.Dataset, tmp_path: Path) -> None:
    """A browser prints no WebGL: a copy of the rod takes its place, and goes away afterwards."""
    file = tmp_path / "x.html"
    file.write_text(turntable_page.html(StoredStudy(ds)), encoding="utf-8")
    with browser.chromium(tmp_path / "chromium", "1366,1000") as driver:
        driver.get(file.as_uri())
        until(lambda: driver.execute_script("return !!document.querySelector('figure').view"))
        assert browser.prints_a_picture(driver)
        until(lambda: driver.execute_script("return document.querySelector('.printed') === null"))


@node.needs_node
def test_the_page_draws_the_stored_rods(ds: xr.Dataset) -> None:
    data = data_of(turntable_page.html(StoredStudy(ds))) | {"k": 7}
    script = """given.arrays = rod_sources.numbersOf(given.arrays);
const { s, alpha, z, push } = rod_sources.storedShape(core, given, given.k); answer({ s, alpha, z, push });"""
    found = node.run(script, data, ("rod_sources",))
    line = StoredStudy(ds).select({"E": 7}).centreline
    s = np.array(found["s"])
    alpha, _, z = line.at(s)
    np.testing.assert_allclose(found["alpha"], alpha, atol=2e-3)  # half a hundredth of the rod's radius
    np.testing.assert_allclose(found["z"], z, atol=2e-3)
    np.testing.assert_allclose(found["push"], line.push(s), atol=2e-3 * data["extremes"][1])
    assert data["extremes"][1] >= np.max(found["push"]) * 0.99


def test_a_slider_has_the_values_of_the_axis_as_the_command_line_takes_them(ds: xr.Dataset) -> None:
    (axis,) = data_of(turntable_page.html(StoredStudy(ds)))["axes"]
    assert axis["symbol"] == "E"
    assert axis["texts"][axis["start"]] == "10910 N/cm²"
    for text, value in zip(axis["texts"], ds["E"].values, strict=True):
        found = ds.rod.sel(E=text.removesuffix(" N/cm²"))
        assert float(found["E"]) == value
    assert data_of(turntable_page.html(StoredStudy(ds), {"E": "10905"}))["axes"] == []


def test_each_case_carries_its_caution_or_why_it_has_no_shape(ds: xr.Dataset) -> None:
    broken = small.with_outcomes(ds, ["solved", "failed: for the test", *["solved"] * 7])
    cases = turntable_of_dataset(StoredStudy(broken)).data["cases"]
    assert cases[1] == {"numbers": None, "note": "Not solved: failed: for the test."}
    assert "passes through itself" in " ".join(case["note"] for case in cases)


def test_too_many_cases_for_a_file_are_thinned_and_the_file_says_so(ds: xr.Dataset) -> None:
    found = turntable_of_dataset(StoredStudy(ds), most_bytes=5 * 4 * 4 * ds.sizes["u"])
    assert [len(axis["texts"]) for axis in found.data["axes"]] == [5]
    assert found.data["axes"][0]["texts"][0] == "5000 N/cm²"
    assert found.data["axes"][0]["texts"][-1] == "40000 N/cm²"
    assert found.left_out == ["5 of the 9 values of E, evenly chosen, are in this file."]


def test_the_command_writes_one_file_without_opengl(tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    assert exit_status("scene", "fig7_1_modulus", "-o", "x.html") == 0
    assert "opens in a browser without a network" in capsys.readouterr().out
    before = Path("x.html").read_text(encoding="utf-8")
    assert len(data_of(before)["cases"]) == 9
    assert exit_status("scene", "fig6", "-o", "x.html") == 2
    assert Path("x.html").read_text(encoding="utf-8") == before
    assert exit_status("scene", "fig6", "-o", "y.html", "--kind", "twist") == 2
    assert "without --kind twist, for pictures alone" in capsys.readouterr().err
    assert exit_status("scene", "fig6", "-o", "y.html", "--bare", "--size", "900x900") == 2
    assert "without --bare, --size, for pictures alone" in capsys.readouterr().err
    assert not Path("y.html").exists()


ROD = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0, stiffness="paper")
START = Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)


@pytest.fixture(scope="module")
def one() -> Solution:
    return solve(Case(ROD, Cylinder(R=0.75), START))


def test_a_solution_is_shown_inline_as_a_picture_and_as_a_rod_that_turns(one: Solution, tmp_path: Path) -> None:
    picture = image.imread(BytesIO(one.plot(length="cm", force="N")._repr_png_()))
    assert picture[..., :3].std() > 0.05  # something is drawn
    shown = one.scene(length="cm", force="N")
    assert shown._repr_html_().startswith('<iframe sandbox="allow-scripts"')
    assert data_of(shown.html)["units"] == {"length": "cm", "force": "N"}
    assert shown.save(tmp_path / "rod.html").read_text(encoding="utf-8") == shown.html


def test_the_table_of_a_solution_has_its_outcome_numbers_and_caution(one: Solution) -> None:
    text = one._repr_html_()
    assert text is not None
    for part in (">solved</td>", ">6</td>", "7.075 [length]", "passes through itself"):
        assert part in text
    two = solve(Case(ROD, Cylinder(R=np.array([0.75, 1.0])), START))
    assert "Solution of 2 cases" in str(two._repr_html_())
    assert "2 of 2" in str(two._repr_html_())


def test_a_case_and_its_equilibria_are_tables_in_a_notebook() -> None:
    case = Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(R=[0.5, 0.75]), Ends(beta0=0.5, betaL=0.8, FZ=-8.66))
    text = str(case._repr_html_())
    for part in ("Ends problem of shape (2,)", ">2 values from 0.5 to 0.75</td>", "−8.66"):
        assert part in text
    assert "inner_radius" not in text  # it was not given
    found = equilibria(replace(case, cylinder=Cylinder(R=0.75)))
    lines = repr(found).splitlines()
    assert lines[0] == "3 equilibria, complete"
    assert lines[1] == "1: stable, energy 44.1262, 1 bend, beta'(0) = " + f"{found[0].dbeta0:.6g}"
    rows = str(found._repr_html_()).split("<tr>")[2:]
    assert any("<td>−" in row for row in rows)
    assert not any("<td>-" in row for row in rows)
    assert [("<td>stable</td>" in row, "<td>index 1</td>" in row) for row in rows] == 2 * [(True, False)] + [
        (False, True)
    ]


def test_the_axes_of_a_solution_are_those_of_its_fields(one: Solution) -> None:
    E, F3 = np.array([5e3, 1e4, 2e4])[:, None], np.array([5.0, 10.0])
    rod = Rod(E=E, nu=0.25, a=0.25, L=20.0, stiffness="paper")
    ds = notebook.as_dataset(solve(Case(rod, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=F3))))
    assert dict(ds.sizes) == {"E": 3, "F3": 2, "u": 201}
    np.testing.assert_array_equal(ds["E"], E[:, 0])
    both = Case(Rod(E=E[:, 0], nu=0.25, a=0.25, L=20.0), Cylinder(R=np.array([0.7, 0.8, 0.9])), START)
    assert dict(notebook.as_dataset(solve(both)).sizes) == {"case1": 3, "u": 201}
    ends = solve(Case(ROD, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8, FZ=-8.66, MZ=1.3, M3=6.1)))
    np.testing.assert_allclose(notebook.as_dataset(ends)["z"], ends.z)
    line = StoredStudy(notebook.as_dataset(one)).centreline
    np.testing.assert_array_equal(line.push(one.s).argmax(), one.push.argmax())


INSIDE = small.text(
    {**small.ROD, "side": "inside", "beta": 0.5, "dbeta": 0.1, "dgamma": 0.5},
    small.axis("F3", [-20.0, -10.0]),
    outputs=["beta", "dbeta", "alpha", "z"],
)


def test_a_rod_inside_is_told_so() -> None:
    found = turntable_of_dataset(StoredStudy(in_memory.run(loads(INSIDE, default_name="inside")))).data
    assert found["shared"] == {"sign": -1}
    raw = np.frombuffer(base64.b64decode(found["arrays"]), dtype="<f4").reshape(2, 4, -1)
    assert np.isfinite(raw).all()
