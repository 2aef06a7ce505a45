"""Expressions and laws with numbers from the study file to the stored file, the commands and the panels."""

import json
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from solver import InputError
from studies import Study, load
from studies.laws import law_words
from studies.laws.line_verdicts import HOLDS
from tests.workbench import small, stored_figures
from workbench.figures import study_figure
from workbench.figures.sheet import sheet
from workbench.run import in_memory
from workbench.stored import stored_verdicts
from workbench.stored.stored_study import StoredStudy

SAID = """
[expressions]
share = "kappa_mean/kappa_max"
tight = "kappa_max*rho > 2"
area = "pi*R**2"
wide = "R > 0.9*cm"
room = "1/(R - 0.75*cm)"
"""
HEADS = {
    "equals": "observable = 'kappa_max'\nkind = 'equals'\nformula = 'kappa_mean/share'\nrelative = 1e-9",
    "bounded": "observable = 'share'\nkind = 'bounded'\nleast = 0\nmost = 'kappa_max/kappa_max'",
    "scales": "observable = 'area'\nkind = 'scales'\nexponent = 2.0\nwithin = 1e-6",
    "boundary": "observable = 'wide'\nkind = 'boundary'\npasses = 0.5\nx = '0.9*cm'\nwithin = 0.2",
    "monotone": "observable = 'tight'\ndirection = 'not-rising'",
}
LAWS = "".join(f"[[laws]]\nclaim = '{kind}'\naxis = 'R'\nsource = 's'\n{said}\n" for kind, said in HEADS.items())
AXES = "[axes.R]\nvalues = [0.5, 0.75, 1.0, 1.25]\n[axes.E]\nvalues = [1e4, 2e4]\n"


def study(laws: str = LAWS) -> Study:
    return small.study(f"{SAID}{AXES}{laws}", 'outputs = []\nobservables = ["bends"]\n')


@pytest.fixture(scope="module")
def ds() -> xr.Dataset:
    return in_memory.run(study())


@pytest.fixture(scope="module")
def pipe() -> xr.Dataset:
    return small.study_dataset("pipe_lubinski")


def test_an_expression_is_stored_with_its_unit_its_text_and_its_error(ds: xr.Dataset) -> None:
    np.testing.assert_allclose(ds["share"], ds["kappa_mean"] / ds["kappa_max"])
    assert ds["room"].attrs == {
        "units": "1/cm", "long_name": "room", "symbol": "room", "expression": "1/(R - 0.75*cm)",
    }  # fmt: skip
    assert ds["share_error"].attrs["units"] == "1"
    assert "tight_error" not in ds
    assert set(np.unique(ds["tight"])) <= {0.0, 1.0}


def test_a_case_where_an_expression_divides_by_zero_says_so_and_its_neighbours_are_untouched(ds: xr.Dataset) -> None:
    bad = ds["R"].values == 0.75
    assert np.isnan(ds["room"].values[bad]).all()
    assert np.isfinite(ds["room"].values[~bad]).all()
    told = ds["outcome"].values
    assert set(told[bad].ravel()) == {"solved; room is not defined: it divides by 'R - 0.75 * cm', which is 0"}
    assert set(told[~bad].ravel()) == {"solved"}
    assert ds["solved"].all()
    assert np.isfinite(ds["share"]).all()


def test_each_kind_of_law_is_judged_from_what_is_stored(ds: xr.Dataset) -> None:
    rows = {row["claim"]: row for row in stored_verdicts.verdicts(ds)}
    assert {claim: row["verdict"] for claim, row in rows.items()} == dict.fromkeys(HEADS, HOLDS)
    assert law_words.law_in_words(rows["equals"]) == "kappa_max equals kappa_mean/share within 1e-07 % along R"
    assert law_words.measure(rows["scales"]) == "exponent 2"
    assert law_words.measure(rows["boundary"]) == "passes between 0.75 and 1"


def test_a_formula_may_use_a_field_of_the_base_and_a_stiffness(tmp_path: Path) -> None:
    formula = "bending_stiffness*kappa_max + 0*F3*L*dgamma*cm + 0*torsional_stiffness*kappa_max"
    rule = f"kind = 'equals'\nobservable = 'bending_moment_max'\nformula = '{formula}'"
    ds = in_memory.run(study(f"[[laws]]\nclaim = 'a'\naxis = 'R'\nsource = 's'\n{rule}\nrelative = 1e-9\n"))
    assert (ds["F3"].item(), ds["F3"].attrs["units"]) == (10.0, "N")
    (row,) = stored_verdicts.verdicts(ds)
    assert row["verdict"] == HOLDS
    with pytest.raises(InputError, match="the dataset stores no number 'F3' of each case; available: "):
        stored_verdicts.verdicts(ds.drop_vars("F3"))


def test_panels_of_laws_with_numbers_show_what_is_stored(ds: xr.Dataset) -> None:
    (row,) = [row for row in stored_verdicts.verdicts(ds) if row["kind"] == "equals"]

    def figure_with_band(relative: float) -> Figure:
        changed = {**row, "rule": {**row["rule"], "relative": relative}}
        laws = [law | {"relative": relative} for law in json.loads(ds.attrs["laws"]) if law["kind"] == "equals"]
        stored = StoredStudy(ds.assign_attrs(laws=json.dumps(laws)))
        return study_figure.figure(stored, [changed], sheet(panel="equals"))

    outside = in_memory.run(study(small.law("kappa_max", "R", claim="a", kind="bounded", most=2.0)))
    pictures = {kind: partial(study_figure.figure, StoredStudy(ds), sheet=sheet(panel=kind)) for kind in HEADS}
    pictures |= {f"a band of {relative}": partial(figure_with_band, relative) for relative in (1e-4, 0.3)}
    pictures["cases outside"] = lambda: study_figure.figure(StoredStudy(outside), sheet=sheet(panel="a"))
    stored_figures.check("pictures_laws", pictures)


@pytest.mark.parametrize("exponent, leaves", [(2.0, False), (3.0, True)])
def test_points_leave_the_band_of_an_exponent_where_the_law_is_false(ds: xr.Dataset, exponent, leaves) -> None:
    (law,) = [law for law in json.loads(ds.attrs["laws"]) if law["kind"] == "scales"]
    stored = StoredStudy(ds.assign_attrs(laws=json.dumps([law | {"exponent": exponent, "within": 0.05}])))
    (ax,) = [ax for ax in study_figure.figure(stored, sheet=sheet(panel="scales")).axes if ax.collections]
    band = min(ax.collections, key=lambda part: part.get_zorder()).get_paths()[0].vertices
    points = [(x, y) for line in ax.lines if line.get_label() != "fit" for x, y in line.get_xydata()]
    assert {x for x, _ in points} == {*ds["R"].values}
    ends = {x: (band[band[:, 0] == x, 1].min(), band[band[:, 0] == x, 1].max()) for x, _ in points}
    assert leaves == any(not ends[x][0] * (1 - 1e-6) <= y <= ends[x][1] * (1 + 1e-6) for x, y in points)
    assert ("allowed" in [text.get_text() for text in ax.get_legend().get_texts()]) == leaves


def test_a_law_on_an_expression_leaves_out_the_solved_cases_in_which_it_is_not_defined() -> None:
    ds = in_memory.run(study(small.law("room", "R", claim="a", kind="bounded", most=100)))
    (row,) = stored_verdicts.verdicts(ds)
    assert (row["verdict"], row["reason"]) == (HOLDS, "not defined in 1 of 4 cases")


def test_the_buckled_pipe_is_lubinskis_and_mitchells_up_to_the_angle_of_its_helix(pipe: xr.Dataset) -> None:
    """The exact helix inside without torque has Lubinski's pitch times cos^(3/2), and Mitchell's push over cos^2."""
    rows = {row["claim"]: row for row in stored_verdicts.verdicts(pipe)}
    assert {row["verdict"] for row in rows.values()} == {HOLDS}
    assert {row["kind"] for row in rows.values()} == {"monotone", "equals", "bounded", "scales", "boundary"}
    phi = -pipe["FZ"] * pipe["rho"] ** 2 / (2.06e8 * np.pi / 4 * (0.0635**4 - 0.0543**4))
    beta = np.array([np.arccos(max(np.roots([-2, 0, 2, -float(p)]).real)) for p in phi])  # 2 (1 - c^2) c = phi
    # the pull of the ends has decayed in the middle third, by more than two turns from them
    np.testing.assert_allclose(pipe["pitch"] / pipe["lubinski_pitch"], np.cos(beta) ** 1.5, rtol=1e-8)
    np.testing.assert_allclose(pipe["push_middle"] / pipe["mitchell_push"], np.cos(beta) ** -2, rtol=1e-6)
    assert rows["power"]["numbers"]["exponent"] == pytest.approx(2, abs=1e-3)
    assert (pipe["attached"] < 1).all()  # at the two ends, within an eighth of a turn
    assert (pipe["end_share"] < 1 / 8).all()


VARIED = {
    "samples": ("[sample]\nsize = 4\n[sample.R]\nfrom = 0.5\nto = 1.5\n[axes.E]\nvalues = [1e4, 2e4]\n", (4, 2)),
    "zip": ("[zip]\nR = [0.5, 0.75, 1.0]\nF1 = [4.0, 5.0, 6.0]\n[axes.E]\nvalues = [1e4, 2e4]\n", (3, 2)),
    "table": ("[table]\nfile = 'cases.csv'\n[axes.E]\nvalues = [1e4, 2e4]\n", (2, 2)),
}


@pytest.mark.parametrize("varied", VARIED)
def test_expressions_of_samples_pairs_and_tables_are_stored_judged_and_drawn(varied: str, tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("R,F1\n0.5,4\n1.0,5\n", encoding="utf-8")
    said, shape = VARIED[varied]
    law = "[[laws]]\nclaim = 'a'\naxis = 'E'\nsource = 's'\nkind = 'equals'\nobservable = 'area'\nformula = 'pi*R**2'\n"
    path = tmp_path / "study.toml"
    head = small.HEAD.replace("[units]", "outputs = []\nobservables = ['bends']\n[units]")
    path.write_text(f"{head}{SAID}{said}{law}relative = 1e-12\n", "utf-8")
    ds = in_memory.run(load(path))
    assert ds["area"].shape == shape
    np.testing.assert_allclose(ds["area"], np.pi * ds["R"].broadcast_like(ds["area"]) ** 2)
    assert [row["verdict"] for row in stored_verdicts.verdicts(ds)] == [HOLDS]
    labels = [ax.get_ylabel() for ax in study_figure.figure(StoredStudy(ds)).axes]
    assert any(label.startswith("area") for label in labels)
