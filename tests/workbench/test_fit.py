"""The command fit: what it prints, writes and refuses."""

import json
from pathlib import Path

import numpy as np
import pytest

from solver import Case, Cylinder, Rod, Start, fit, observe, solve
from studies import load
from tests.workbench import small, stored_figures
from tests.workbench.pictures import pixels, share_of_hue, share_of_ink
from workbench import fitting
from workbench.figures import colours, fit_figure
from workbench.figures.sheet import SCREEN, sheet
from workbench.stored.stored_study import StoredStudy

ENDS = small.text({**small.ROD, "beta0": 0.5, "betaL": 0.8, "FZ": -8.5, "MZ": 1.3, "M3": 6.1})


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


def test_an_ends_problem_keeps_the_equilibrium_in_the_fitted_study(tmp_path, call) -> None:
    file, out = tmp_path / "ends.toml", tmp_path / "fitted.toml"
    file.write_text(ENDS)
    wanted = 0.02 + float(observe(solve(load(str(file)).case()), ["turns_around"])["turns_around"])
    status, _, _ = call("fit", file, "--target", f"turns_around={wanted}", "--vary", "FZ", "--starts", 0, "--out", out)
    assert status == 0
    assert json.loads(call("solve", out, "--json")[1])["observables"]["turns_around"] == pytest.approx(wanted, abs=1e-7)


def test_sigma_of_a_file_and_of_the_command_line_are_the_same(points, tmp_path, call) -> None:
    other = tmp_path / "with_sigma.csv"
    lines = points.read_text().splitlines()
    other.write_text("\n".join([f"{lines[0]},sigma_alpha,sigma_z", *(f"{line},0.01,0.02" for line in lines[1:])]))
    given = ["--table1", "--M3", 17, "--vary", "E,M3", "--starts", 0, "--json", "--points"]
    one = json.loads(call("fit", *given, other)[1])
    two = json.loads(call("fit", *given, points, "--sigma", "alpha=0.01", "--sigma", "z=0.02")[1])
    assert one["intervals"] == two["intervals"]
    assert sum(share["E"] for share in one["shares"].values()) == pytest.approx(1)  # each point is in one third
    assert one["rule"] == "95 % intervals by the given sigma and the normal distribution"


def drawn(case: Case, vary, page=SCREEN):
    """The figure of a fit to points of the case with errors."""
    s, rng = np.linspace(0.5, 20, 30), np.random.default_rng(0)
    sol = solve(case, stations=s)
    points = {"s": s, "alpha": sol.alpha + 0.01 * rng.standard_normal(s.size), "z": sol.z}
    found = fit(case, vary, points=points, starts=0)
    figure = fit_figure.figure(StoredStudy(fitting.as_dataset(found, {"length": "cm", "force": "N"}, points)), page)
    return figure


def wide(beta=1.3) -> Case:
    """A helix whose rho alpha spans more than its z."""
    rod, cylinder = table1().rod, Cylinder(0.75)
    return Case(rod, cylinder, Start(beta, 0.0, M3=float(rod.bending_stiffness) * np.sin(beta) * np.cos(beta)))


def test_the_picture_of_a_fit_shows_what_is_stored() -> None:
    """Fields that are undetermined have no shares; z is to the right also where it is the shorter extent."""
    every, column = ["E", "F3", "M3", "R"], sheet("paper", 89, titled=False)
    pictures = {
        "wide": lambda: drawn(wide(), ["M3"]),
        "wide, in a column": lambda: drawn(wide(), ["M3"], column),
        "one determined field": lambda: drawn(table1(), every),
        "one determined field, in a column": lambda: drawn(table1(), every, column),
        "no determined field": lambda: drawn(table1(), ["E", "F3", "M3"]),
        "one field": lambda: drawn(table1(), ["M3"]),
    }
    stored_figures.check("pictures_fits", pictures)


@pytest.mark.slow
def test_points_give_intervals_shares_and_a_picture(points, tmp_path, call) -> None:
    picture, table = tmp_path / "fit.png", tmp_path / "fit.csv"
    given = ["--table1", "--M3", 17, "--points", points, "--vary", "E,M3", "--starts", 0]
    status, said, _ = call("fit", *given, "--plot", picture, "--out", table)
    assert status == 0
    for part in ("95 % interval", "alpha, 10 points to s = 6.67 cm", "z, 10 points to s = 20 cm", "share in E",
                 "correlation of E and M3",
                 "by the variance of the residuals and Student's t with 58 degrees of freedom"):  # fmt: skip
        assert part in said
    assert 0.02 < share_of_ink(pixels(picture)) < 0.6
    for colour in colours.PAIR:  # the rod and M3, the share of each point in E
        assert share_of_hue(pixels(picture), colour) > 0.001
    header, first, _ = table.read_text().splitlines()
    assert header == "field,value,low,high,unit,covariance_E,covariance_M3"
    name, value, low, high, unit, *_ = first.split(",")
    assert (name, unit) == ("E", "N/cm^2")
    assert float(low) < 1.07e4 < float(high)
    status, said, _ = call("fit", *given, "--json")
    found = json.loads(said)
    assert found["values"]["E"] == pytest.approx(float(value), rel=1e-12)
    assert sum(share["E"] for share in found["shares"].values()) == pytest.approx(1)
    assert len(found["data"]) == 60


@pytest.mark.slow
def test_what_the_data_cannot_tell_is_status_1_and_a_sentence(points, tmp_path, call) -> None:
    given = ["--table1", "--M3", 17, "--points", points, "--vary", "E,F3,M3", "--starts", 0]
    status, said, _ = call("fit", *given, "--plot", tmp_path / "fit.pdf")
    assert status == 1
    assert "undetermined: the data cannot tell E and F3 and M3 apart" in said
    assert "when these change together, E, F3 and M3 by +1 % each" in said
    row = next(line.split() for line in said.splitlines() if line.startswith("E "))
    assert row[2:4] == ["undetermined", "N/cm^2"]
    assert " inf" not in said


def test_a_field_that_changes_the_loads_of_a_wound_rod_is_not_fitted(call) -> None:
    wire = "--length-unit mm --E 2e5 --nu 0.3 --a 1 --L 1500 --R 60 --tension 500 --lay 80deg"
    status, _, error = call("fit", *wire.split(), "--vary", "L,E", "--target", "push_max=5")
    assert status == 2
    assert "tension and lay are the loads of the rod as it is, and E would change them" in error
