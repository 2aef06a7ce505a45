"""The command equilibria: what it lists, stores, draws and writes, and its diagram over an axis."""

import json
import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, InputError, Rod, equilibria, solve
from solver.equilibria import nearest
from solver.follow import to_fold
from solver.observe.observables import observe
from studies import load
from studies.language.loader import loads
from tests.cases import ends_in_units_of_rho
from tests.slow import slow
from tests.workbench import small
from workbench.branches import branch_dataset, tracing
from workbench.branches.ends_study import DEFAULT, ends_problem, write_cases
from workbench.branches.equilibria_dataset import as_dataset
from workbench.commands.case_options import parse_axis
from workbench.run import in_memory, writing
from workbench.stored import reading
from workbench.stored.case_solving import solve_one
from workbench.stored.stored_study import StoredStudy

MANY = -0.3655, 0.7464, -0.7506

UNITS = {"length": "cm", "force": "N"}


def default() -> Case:
    return ends_problem(load(DEFAULT))


@pytest.fixture(scope="module")
def swept():
    """All equilibria of the default case while its far end turns by forty degrees, in steps of five."""
    study = load(DEFAULT)
    values = np.deg2rad(np.arange(0, 46, 5.0))
    return branch_dataset.sweep(study, default(), "betaL", values, lambda *_: None)


def test_the_default_is_table_1_held_at_its_own_far_end() -> None:
    start = load(DEFAULT).case()
    case = default()
    assert case.given.betaL == pytest.approx(solve(start, tol=1e-12).beta[-1], abs=1e-12)
    assert tuple(case.loads) == tuple(start.loads)


def test_a_list_that_is_a_part_only_says_so_and_ends_with_status_1(call, monkeypatch) -> None:
    monkeypatch.setattr("solver.equilibria", partial(equilibria, most_swings=1))
    status, text, _ = call("equilibria")
    assert status == 1
    assert "only equilibria of at most 1 whole periods of beta" in " ".join(text.split())
    status, text, _ = call("equilibria", "--json")
    assert status == 1
    assert json.loads(text)["complete"] is False
    assert "at most 1" in json.loads(text)["remark"]


def test_a_rod_in_millimetres_has_the_equilibria_of_the_same_rod_in_centimetres(call, tmp_path) -> None:
    case = default()
    rod, given = case.rod, case.given
    size = {"E": rod.E / 100, "nu": rod.nu, "a": 10 * rod.a, "L": 10 * rod.L, "R": 10 * case.cylinder.R}
    ends = {"beta0": given.beta0, "betaL": given.betaL, "FZ": given.FZ, "MZ": 10 * given.MZ, "M3": 10 * given.M3}
    words = [word for name, value in (size | ends).items() for word in (f"--{name}", repr(float(value)))]
    words += ["--stiffness", rod.stiffness, "--length-unit", "mm"]
    told = json.loads(call("equilibria", *words, "--json")[1])
    assert told["units"] == {"length": "mm", "force": "N"}
    ours = json.loads(call("equilibria", "--json")[1])["equilibria"]
    assert len(told["equilibria"]) == len(ours) > 10
    for mm, cm in zip(told["equilibria"], ours, strict=True):
        assert (mm["bends"], mm["index"]) == (cm["bends"], cm["index"])
        assert mm["dbeta0"] == pytest.approx(cm["dbeta0"] / 10, rel=1e-6, abs=1e-9)
        assert mm["energy"] == pytest.approx(10 * cm["energy"], rel=1e-8)
    status, table, _ = call("equilibria", *words, "--out", tmp_path / "mm.h5", "--export", tmp_path / "cases")
    assert status == 0
    assert "dbeta0 (rad/mm)" in table
    assert "rod: the options\nLengths in mm, forces in N, angles in rad" in table
    assert reading.read(tmp_path / "mm.h5", study=False).attrs["length_unit"] == "mm"
    first = sorted((tmp_path / "cases").glob("*.toml"))[0]
    assert load(str(first)).unit_system == {"length": "mm", "force": "N"}


def test_each_exported_case_solves_to_the_equilibrium_it_was_written_from(call, tmp_path) -> None:
    """Mirror images of one energy and shapes of one start slope among them: 40 rho long, most hug a saddle."""
    case = ends_in_units_of_rho(*MANY, 40.0, np.pi / 6, np.pi / 6)
    study = load(DEFAULT)
    found = equilibria(case)
    slopes = [one.dbeta0 for one in found]
    assert len(set(slopes)) < len(slopes)
    write_cases(study, case, found, tmp_path)
    files = sorted(tmp_path.glob("*.toml"))
    assert len(files) == len(found) == 63
    for k in (1, 2, 40):
        ds = in_memory.run(load(files[k]))
        np.testing.assert_allclose(ds["beta"], found[k].solution.beta, atol=1e-12)
    told = json.loads(call("solve", files[3], "--json")[1])
    assert told["observables"]["energy"] == pytest.approx(found[3].energy, rel=1e-9)
    assert told["observables"]["bends"] == found[3].bends


def test_the_dataset_holds_what_is_listed_and_the_shapes(tmp_path) -> None:
    study, case = load(DEFAULT), default()
    found = equilibria(case)
    path = writing.write(as_dataset(study, case, found), tmp_path / "all.h5")
    ds = reading.read(path, study=False)
    assert ds["beta"].dims == ("equilibrium", "u")
    np.testing.assert_array_equal(ds["index"], [one.index for one in found])
    assert ds["energy"].attrs["units"] == "N cm"
    assert ds["dbeta0"].attrs["units"] == "rad/cm"
    assert float(ds["betaL"]) == case.given.betaL
    meets = [observe(one.solution, ["overlaps"])["overlaps"] == 1 for one in found]
    assert any(meets)
    assert ["overlaps" in text for text in ds["caution"].values] == meets


def test_branches_join_what_changes_little_and_keep_their_index(swept) -> None:
    numbers, index, slope = (swept[key].values for key in ("branch", "index", "dbeta0"))
    for branch in range(numbers.max() + 1):
        k, i = np.nonzero(numbers == branch)
        assert (np.diff(k) == 1).all()  # one a value, none left out
        assert np.unique(index[k, i]).size == 1
        assert np.abs(np.diff(slope[k, i])).max(initial=0) < 0.3
    members = (swept["outcome"] != "").values
    assert (numbers[members] >= 0).all()


def test_a_fold_is_where_the_branch_of_table_1_is_known_to_end(swept) -> None:
    known = to_fold(load(DEFAULT).case(), np.deg2rad(60))
    off = np.abs(swept["fold"].values - known.fold)
    # drawn on to zero from values that come nearer by a factor of five each time; measured 1e-9
    assert off.min() < 1e-6
    assert swept["fold_dbeta0"].values[off.argmin()] == pytest.approx(known.fold_dbeta0, abs=2e-2)
    first, second = swept["fold_branches"].values[off.argmin()]
    rows = StoredStudy(swept).data("branches")
    assert branch_dataset.folds(StoredStudy(swept))[off.argmin()]["numbers"] == sorted((first + 1, second + 1))
    assert abs(rows[first]["index"] - rows[second]["index"]) == 1
    fold = np.degrees(swept["fold"].values[off.argmin()])
    assert rows[first]["to"] == rows[second]["to"] == pytest.approx(fold)  # and not the last value, 35


def test_branches_that_stop_for_one_reason_are_counted_in_one_line(call, monkeypatch) -> None:
    def refuse(start, **_):
        raise InputError(f"no step from L = {float(start.case.rod.L):g}")

    monkeypatch.setattr(tracing, "follow", refuse)
    status, text, _ = call("equilibria", "--axis", "betaL=0.1:0.3:3")
    said = [line for line in text.splitlines() if "stop" in line]
    assert status == 1
    assert len(said) == 1
    assert re.match(r"branches stop \d\d times, at betaL = 5.72958 to 17.1887 deg: no step from L = 20$", said[0])


def test_a_branch_that_has_no_more_points_says_where_and_what_goes_on(call) -> None:
    asked = ["equilibria", "--axis", "height=10:19:3"]
    status, text, said = call(*asked, "--points", "9")
    assert status == 0
    assert re.search(r"at height = -?[\d.]+ .*: the limit of 9 points\n--points COUNT follows branches over more", text)
    assert re.match(r"0 of (\d+): at most \1 branches, of the equilibria under dead loads\n", said)
    assert call("equilibria", "--points", "9")[0] == call(*asked, "--points", "0")[0] == 2


def test_the_papers_claim_is_not_contradicted_on_its_own_branch_and_fails_on_others(swept) -> None:
    """Panel (4): turns do not fall (nor rise, as the sentence says) and kappa_mean rises with beta(L)."""
    rows = [row for row in StoredStudy(swept).data("branches") if row["values"] > 2]
    known = to_fold(load(DEFAULT).case(), np.deg2rad(60))
    at = np.interp(0.0, known.values, known.dbeta0)
    own = int(swept["branch"].values[0, np.nanargmin(np.abs(swept["dbeta0"].values[0] - at))])
    assert rows[own]["bends not-falling"] == "true in part: not contradicted"
    assert rows[own]["kappa_mean rises"] == "true"
    assert any(row["kappa_mean rises"] == "false" for row in rows)


def test_branches_that_are_followed_twice_are_listed_once_with_their_folds(monkeypatch) -> None:
    given, number = [], tracing.number_pieces
    monkeypatch.setattr(tracing, "number_pieces", lambda *values: given.append(values) or number(*values))
    seen = tracing.trace_branches(default(), "betaL", [-0.2, 0.2, 0.6, 1.0], 21, lambda *_: None)
    assert len(seen.special) > 1
    ((found, owner, curves, remarks),) = given
    again = number(found, owner, [*curves, *curves], remarks)
    assert (again.pieces, again.branch) == (seen.pieces, seen.branch)
    assert [meets for *_, meets in again.special] == [meets for *_, meets in seen.special]


WIRE = Case(Rod(E=2.1e5, nu=0.3, a=0.25, L=120.0), Cylinder(2.0, side="inside"), Ends(0.0, 0.0, FZ=-150.0))


@pytest.mark.parametrize(
    ("case", "name", "values"),
    [(None, "betaL", [-0.2, 0.2, 0.6, 1.0]), slow(WIRE, "FZ", [-160.0, -155.0, -150.0, -145.0])],
)
def test_each_equilibrium_of_the_list_lies_on_one_branch_and_a_branch_passes_no_other(case, name, values) -> None:
    seen = tracing.trace_branches(case or default(), name, values, 21, lambda *_: None)
    for value, numbers in zip(values, seen.branch, strict=True):
        passing = [
            piece.number
            for piece in seen.pieces
            for at in seen.curves[piece.curve].values[piece.first : piece.last + 1]
            if at == value
        ]
        assert sorted(passing) == sorted(numbers)
    for curve in seen.curves:
        special = {point.position for point in curve.special}
        assert all({at, at + 1} & special for at in np.flatnonzero(np.diff(curve.index)).tolist())


def test_angles_on_an_axis_may_be_given_in_degrees() -> None:
    for text in ("betaL=60deg:-30deg:4", "betaL=-pi/6:pi/3:4"):
        name, values = parse_axis(text, UNITS)
        assert name == "betaL"
        np.testing.assert_allclose(values, np.deg2rad([-30, 0, 30, 60]), atol=1e-15)  # rounding


@pytest.mark.parametrize("unit", (1e-3, 1.0, 1e3))
def test_the_nearest_is_the_same_in_every_unit_of_force(unit: float) -> None:
    one = equilibria(ends_in_units_of_rho(*MANY, 40.0, np.pi / 6, np.pi / 6))[0]
    near = replace(one, dbeta0=0.0, energy=0.0)
    assert nearest([replace(one, dbeta0=1.0, energy=unit), near], 0.1, 0.6 * unit) is near  # 0.1 + 0.6 of the spreads


BASE = {"E": 1e4, "nu": 0.25, "a": 0.25, "L": 10.0, "R": 0.75, "beta0": 0.5, "betaL": 0.8, "FZ": -8.0}
CASE = small.text(BASE, "[equilibrium]\n")


def test_a_study_may_name_its_equilibrium_by_a_rule_or_an_index() -> None:
    for words, rule in (('choose = "lowest"', "lowest"), ("index = 1", 1), ('choose = "nearest"', "nearest")):
        study = loads(CASE + words)
        sol = solve_one(study.case(), study.equilibrium, 1e-8, "auto", 201)
        assert sol.solved
        np.testing.assert_array_equal(sol.beta, solve(study.case(), choose=rule).beta)
        assert sol.selection.choose == rule


@pytest.mark.parametrize("name", ["height", "azimuth", "rotation", "M10", "M1L"])
def test_what_an_end_holds_may_be_an_axis(name: str) -> None:
    assert parse_axis(f"{name}=-1:1:3", UNITS)[0] == name


def test_the_nearest_is_told_by_slope_and_energy_together() -> None:
    found = equilibria(ends_in_units_of_rho(*MANY, 40.0, np.pi / 6, np.pi / 6))
    for one in found:
        assert nearest(found, one.dbeta0, one.energy) is one
    with pytest.raises(InputError, match="no equilibrium"):
        nearest([], 0.0, 0.0)
