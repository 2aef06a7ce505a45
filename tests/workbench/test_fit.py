"""The command fit: what it prints, writes and refuses."""

import json
from pathlib import Path

import numpy as np
import pytest

from solver import Case, Cylinder, Rod, Start, fit, observe, solve
from studies import load
from tests.workbench import small
from tests.workbench.command import exit_status
from workbench import fitting
from workbench.figures import fit_figure

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


def test_an_ends_problem_keeps_the_equilibrium_in_the_fitted_study(tmp_path, capsys) -> None:
    file, out = tmp_path / "ends.toml", tmp_path / "fitted.toml"
    file.write_text(ENDS)
    wanted = 0.02 + float(observe(solve(load(str(file)).case()), ["wraps"])["wraps"])
    status, _, _ = run(capsys, file, "--target", f"wraps={wanted}", "--vary", "FZ", "--starts", 0, "--out", out)
    assert status == 0
    assert exit_status("solve", out, "--json") == 0
    assert json.loads(capsys.readouterr().out)["observables"]["wraps"] == pytest.approx(wanted, abs=1e-7)


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
    figure = fit_figure.figure(fitting.dataset_of(found, {"length": "cm", "force": "N"}, points))
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
    title = fitting.dataset_of(found, {"length": "cm", "force": "N"}, None).attrs["title"]
    assert title == "Fit: E undetermined, F₃ undetermined, M₃ undetermined"
