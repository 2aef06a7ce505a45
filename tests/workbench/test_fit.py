"""The command fit: what it prints, writes and refuses."""

import json
from pathlib import Path

import numpy as np
import pytest

from solver import Case, Cylinder, Rod, Start, fit, observe, solve
from studies import load
from tests.workbench import small
from tests.workbench.command import exit_status
from tests.workbench.pictures import pixels, share_of_hue, share_of_ink
from workbench.figures import fit_figure, style
from workbench.fitting import fit_dataset

ENDS = small.text({**small.ROD, "beta0": 0.5, "betaL": 0.8, "FZ": -8.5, "MZ": 1.3, "M3": 6.1})


def run(capsys, *words: object) -> tuple[int, str, str]:
    return exit_status("fit", *words), *capsys.readouterr()


def table1(M3=18.0, E=1.07e4) -> Case:
    return Case(
        Rod(E=E, nu=0.25, a=0.25, L=20.0, stiffness="paper"), Cylinder(0.75), Start("30deg", 0.5, F3=10.0, M3=M3)
    )


@pytest.fixture
def points(tmp_path) -> Path:
    """Points of Table 1's rod, with a noise of 0.01."""
    rng, s = np.random.default_rng(0), np.linspace(0.5, 20, 30)
    sol = solve(table1(), stations=s)
    alpha, z = sol.alpha + 0.01 * rng.standard_normal(30), sol.z + 0.01 * rng.standard_normal(30)
    file = tmp_path / "points.csv"
    file.write_text("s,alpha,z\n" + "".join(f"{a},{b},{c}\n" for a, b, c in zip(s, alpha, z, strict=True)))
    return file


def test_a_target_is_reached_and_the_fitted_case_solves_to_it(tmp_path, capsys) -> None:
    out = tmp_path / "fitted.toml"
    status, said, _ = run(
        capsys, "fig7_1_modulus", "--at", "E=10905", "--target", "height=9", "--vary", "F1", "--bounds", "F1=1:9",
        "--out", out,
    )  # fmt: skip
    assert status == 0
    assert "at E = 10905.1" in said
    assert "no intervals: no sigma is given, and there are no more data than fitted values" in said
    assert "caution: 1 other value reaches the target: the values are not unique" in said
    rows = said[said.index("other minima") :].splitlines()
    assert rows[1].split("  ")[-1].strip() == "reaches the target"
    assert [row.split()[-1] for row in rows if "3.08124" in row] == ["yes"]
    assert [row.split()[-1] for row in rows if "9 (bound)" in row] == ["no"]
    shape = "caution: The rod passes through itself and would lift off where the cylinder has to pull"
    assert shape in said
    exit_status("solve", out)
    assert [line for line in said.splitlines() if "The rod" in line] == [
        line for line in capsys.readouterr().out.splitlines() if "The rod" in line
    ]
    study = load(str(out))
    modulus = study.case().rod.E
    assert modulus == pytest.approx(10905.077)
    assert observe(solve(study.case()), ["height"])["height"] == pytest.approx(9)


@pytest.mark.slow
def test_points_give_intervals_shares_and_a_picture(points, tmp_path, capsys) -> None:
    picture, table = tmp_path / "fit.png", tmp_path / "fit.csv"
    given = ["--table1", "--M3", 17, "--points", points, "--vary", "E,M3", "--starts", 0]
    status, said, _ = run(capsys, *given, "--plot", picture, "--out", table)
    assert status == 0
    for part in ("95 % interval", "alpha, 10 points to s = 6.67 cm", "z, 10 points to s = 20 cm", "share in E",
                 "correlation of E and M3",
                 "by the variance of the residuals and Student's t with 58 degrees of freedom"):  # fmt: skip
        assert part in said
    assert 0.02 < share_of_ink(pixels(picture)) < 0.6
    for colour in style.PAIR:  # the rod and M3, the share of each point in E
        assert share_of_hue(pixels(picture), colour) > 0.001
    header, first, _ = table.read_text().splitlines()
    assert header == "field,value,low,high,unit,covariance_E,covariance_M3"
    name, value, low, high, unit, *_ = first.split(",")
    assert (name, unit) == ("E", "N/cm^2")
    assert float(low) < 1.07e4 < float(high)
    status, said, _ = run(capsys, *given, "--json")
    found = json.loads(said)
    assert found["values"]["E"] == pytest.approx(float(value), rel=1e-12)
    assert sum(share["E"] for share in found["shares"].values()) == pytest.approx(1)
    assert len(found["data"]) == 60


def test_angles_are_printed_in_degrees_and_read_in_any_form(capsys) -> None:
    given = ["--table1", "--vary", "beta", "--target", "height=8", "--bounds", "beta=10deg:25deg"]
    status, said, _ = run(capsys, *given)
    assert status == 0
    assert "deg" in next(line for line in said.splitlines() if line.startswith("beta0"))
    found = json.loads(run(capsys, *given, "--json")[1])
    assert np.radians(10) < found["values"]["beta0"] < np.radians(25)
    assert f"{np.degrees(found['values']['beta0']):.6g}" in said


def test_an_ends_problem_keeps_the_equilibrium_in_the_fitted_study(tmp_path, capsys) -> None:
    file, out = tmp_path / "ends.toml", tmp_path / "fitted.toml"
    file.write_text(ENDS)
    wanted = 0.02 + float(observe(solve(load(str(file)).case()), ["wraps"])["wraps"])
    status, _, _ = run(capsys, file, "--target", f"wraps={wanted}", "--vary", "FZ", "--starts", 0, "--out", out)
    assert status == 0
    assert exit_status("solve", out, "--json") == 0
    assert json.loads(capsys.readouterr().out)["observables"]["wraps"] == pytest.approx(wanted, abs=1e-7)


@pytest.mark.slow
def test_what_the_data_cannot_tell_is_status_1_and_a_sentence(points, tmp_path, capsys) -> None:
    given = ["--table1", "--M3", 17, "--points", points, "--vary", "E,F3,M3", "--starts", 0]
    status, said, _ = run(capsys, *given, "--plot", tmp_path / "fit.pdf")
    assert status == 1
    assert "undetermined: the data cannot tell E and F3 and M3 apart" in said
    assert "when these change together, E, F3 and M3 by +1 % each" in said
    row = next(line.split() for line in said.splitlines() if line.startswith("E "))
    assert row[2:4] == ["undetermined", "N/cm^2"]
    assert " inf" not in said


def test_sigma_of_a_file_and_of_the_command_line_are_the_same(points, tmp_path, capsys) -> None:
    other = tmp_path / "with_sigma.csv"
    lines = points.read_text().splitlines()
    other.write_text("\n".join([f"{lines[0]},sigma_alpha,sigma_z", *(f"{line},0.01,0.02" for line in lines[1:])]))
    given = ["--table1", "--M3", 17, "--vary", "E,M3", "--starts", 0, "--json", "--points"]
    one = json.loads(run(capsys, *given, other)[1])
    two = json.loads(run(capsys, *given, points, "--sigma", "alpha=0.01", "--sigma", "z=0.02")[1])
    assert one["intervals"] == two["intervals"]
    assert one["rule"] == "95 % intervals by the given sigma and the normal distribution"


def drawn(case: Case, vary):
    """The figure of a fit to points of the case with errors, and its fit."""
    s, rng = np.linspace(0.5, 20, 30), np.random.default_rng(0)
    sol = solve(case, stations=s)
    points = {"s": s, "alpha": sol.alpha + 0.01 * rng.standard_normal(s.size), "z": sol.z}
    found = fit(case, vary, points=points, starts=0)
    figure = fit_figure.figure(fit_dataset.dataset_of(found, {"length": "cm", "force": "N"}, points))
    figure.draw_without_rendering()
    return figure, found


def wide(beta=1.3) -> Case:
    """A helix whose rho alpha spans more than its z."""
    rod, cylinder = table1().rod, Cylinder(0.75)
    return Case(rod, cylinder, Start(beta, 0.0, M3=float(rod.bending_stiffness) * np.sin(beta) * np.cos(beta)))


@pytest.mark.parametrize(("case", "least"), ((wide(), 0.1), (table1(), 0.8)))
def test_z_is_to_the_right_of_the_curve_also_where_it_is_the_shorter_extent(case, least) -> None:
    figure, _ = drawn(case, ["M3"])
    panel = figure.axes[0]
    assert panel.get_xlabel().startswith("z ")
    assert "around" in panel.get_ylabel()
    assert panel.yaxis_inverted()
    box, legend = panel.get_window_extent(), panel.get_legend().get_window_extent()
    assert box.y1 <= legend.y0 + 1
    assert box.width > least * figure.bbox.width
    assert box.height > 0.1 * figure.bbox.height


def test_fields_that_are_undetermined_have_no_shares_in_the_picture() -> None:
    figure, found = drawn(table1(), ["E", "F3", "M3", "R"])
    assert [text.get_text() for text in figure.axes[2].get_legend().get_texts()] == ["R"]
    figure, found = drawn(table1(), ["E", "F3", "M3"])
    assert figure.axes[2].get_legend() is None
    assert figure.get_figheight() < 7.4
    title = fit_dataset.dataset_of(found, {"length": "cm", "force": "N"}, None).attrs["title"]
    assert title == "Fit: E undetermined, F₃ undetermined, M₃ undetermined"


STUDY = ("fig7_1_modulus", "--vary", "F1")
INVALID = {
    "unbounded": (
        ("fig7_1_modulus", "--vary", "E", "--starts", 0, "--target", "height=100"),
        "the search found no E (start: 1.091e+04) that reaches height = 100; the nearest reached is height = ",
    ),
    "unreached": (
        (*STUDY, "--bounds", "F1=1:9", "--target", "height=100"),
        "the search found no F1 from 1 to 9 that reaches height = 100; the nearest reached is height = ",
    ),
    "observable": ((*STUDY, "--target", "heigth=9"), "no observable 'heigth', did you mean 'height'; choose"),
    "count": ((*STUDY, "--target", "turns=5"), "the target turns is a whole number"),
    "number": ((*STUDY, "--target", "height=high"), "--target height must be a finite number, got 'high'"),
    "form": ((*STUDY, "--target", "height"), "--target takes NAME=VALUE, got 'height'"),
    "twice": ((*STUDY, "--target", "height=9", "--target", "height=8"), "--target height=8: height is given twice"),
    "field": (("fig7_1_modulus", "--vary", "Q", "--target", "height=9"), "no field 'Q' in this case; choose from E, "),
    "nothing": (("fig7_1_modulus", "--target", "height=9"), "fit needs --vary NAMES"),
    "no data": (STUDY, "fit needs data: give targets"),
    "negative": (
        ("fig7_1_modulus", "--vary", "E", "--bounds", "E=-5:9", "--target", "height=9"),
        "the bounds of E must be positive, got -5 to 9",
    ),
    "stray": ((*STUDY, "--bounds", "E=1:9", "--target", "height=9"), "--bounds E is of no field of --vary"),
    "range": ((*STUDY, "--bounds", "F1=1", "--target", "height=9"), "--bounds takes NAME=LOW:HIGH, got F1='1'"),
    "place": ((*STUDY, "--at", "E=1", "--target", "height=9"), "--at E=1: E = 1 is not on the axis"),
    "no study": (("--at", "E=1", "--vary", "F1", "--target", "height=9"), "no study is given"),
    "followed": (("fig7_4_end_angle", "--vary", "F1", "--target", "height=9"), "fit takes a study of single cases"),
    "rule": ((*STUDY, "--choose", "lowest", "--target", "height=9"), "--choose selects among the equilibria"),
    "suffix": ((*STUDY, "--target", "height=9", "--out", "a.h5"), "choose a name that ends in .toml, .csv"),
    "missing": ((*STUDY, "--points", "none.csv"), "cannot read the table none.csv"),
}


@pytest.mark.parametrize("name", INVALID)
def test_invalid_input_is_one_sentence_and_status_2(name, tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    words, sentence = INVALID[name]
    status, said, told = run(capsys, *words, *(() if name == "suffix" else ("--out", "out.toml")))
    assert status == 2
    assert said == ""
    assert sentence in told
    assert told.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


POINTS = {
    "": "points.csv is empty: give a line of names, and below it a line for each point",
    "s,alpha,z\n": "points.csv has no rows: give a line for each point below the line of names",
    "s;alpha;z\n1;0.1;1\n": "points.csv: columns are separated by commas, not semicolons, got 's;alpha;z'",
    "s,alpha,z\n1,0.1,1\n2,x,1\n": "points.csv, line 3 (row 2): alpha must be a finite number, got 'x'",
    "s,alpha,z\n1,0.1,1\n2,0.2,\n": "points.csv, line 3 (row 2): z is empty; give each row a number",
    "s,alpha,z\n1,0.1\n": "points.csv, line 2 (row 1): expected 3 cells, as the line of names has, got 2",
    "s,alfa,z\n1,0.1,1\n": "the column 'alfa' is no column of measured points, did you mean 'alpha'; choose from s, ",
    "alpha,sigma_z\n1,0.1\n": "points.csv has the column sigma_z and no column z",
    "z\n1\n": "points need alpha and z, or s and one of alpha, z, beta, got z",
    "s,z\n1,0\n30,1\n": "a point has s = 30, beyond the end of the rod at L = 20",
}


@pytest.mark.parametrize("text", POINTS)
def test_a_table_of_points_that_is_none_is_refused(text, tmp_path, capsys) -> None:
    file = tmp_path / "points.csv"
    file.write_text(text)
    status, _, told = run(capsys, *STUDY, "--points", file)
    assert status == 2
    assert POINTS[text] in told


def test_an_existing_file_is_kept(tmp_path, capsys) -> None:
    out = tmp_path / "fitted.toml"
    out.write_text("mine")
    status, _, told = run(capsys, *STUDY, "--target", "height=9", "--out", out)
    assert status == 2
    assert "exists; give --force to replace it" in told
    assert out.read_text() == "mine"
