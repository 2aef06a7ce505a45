"""What no real rod could do is said of every case, and of the study in one sentence."""

import re
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from solver import Case, Cylinder, Ends, Rod, Start, equilibria, observe, solve
from solver.observe.cautions import largest_strain
from tests.workbench import small
from workbench.run import dataset_assembly
from workbench.run.block import columns
from workbench.stored.stored_study import StoredStudy
from workbench.words import caution_words, pipe_profile, pipe_words

STEEL = {"E": 2.1e8, "nu": 0.3, "L": 20.0}  # kN and m


def test_a_pipe_pushed_down_its_hole_lifts_off_only_next_to_its_ends() -> None:
    pipe = Case(Rod(a=0.0635, **{**STEEL, "L": 60.0}), Cylinder(0.108, "inside"), Ends(0.0, 0.0, FZ=-200.0))
    sol = solve(pipe, stations=401)
    text = str(caution_words.of_cases(sol, units={"length": "m", "force": "kN"}))
    off = np.minimum(sol.s, 60 - sol.s)[sol.push < 0]  # at stations 0.15 m apart
    share, near = (float(number) for number in re.findall(r"[\d.]+", text))
    assert text.startswith("pulled at the ends (no push on ")
    assert share == pytest.approx(100 * np.mean(sol.push < 0), abs=0.7)  # in whole percent
    assert near == pytest.approx(off.max(), abs=0.2)
    assert caution_words.said(text) == (
        f"The rod would lift off next to its ends alone: no push on {share:g} % of the length, all within {near:g} m "
        "of the ends."
    )
    assert sol.caution == text.replace(f"{near:g} m of", "14 % of the length from")


def test_the_strain_is_that_of_the_outermost_fibre_along_the_whole_rod() -> None:
    """Read at dense stations, of tubes and rods in tension and compression, inside and outside."""
    rng = np.random.default_rng(1)
    for k in range(30):
        bore = rng.choice([0.0, 0.1])
        rod = Rod(E=rng.uniform(1, 1e3), nu=0.3, a=0.2, L=rng.uniform(1, 10), inner_radius=bore)
        forces = rng.normal(size=3) * rod.bending_stiffness
        start = Start(*rng.uniform(-1, 1, 2), F3=forces[0], M3=forces[1], F2=forces[2])
        sol = solve(Case(rod, Cylinder(*((0.8, "outside"), (1.2, "inside"))[k % 2]), start), stations=20_001)
        along = (0.2 * sol.kappa + np.abs(sol.F3) / (rod.E * np.pi * (0.2**2 - bore**2))).max()
        twisted = 0.2 * abs(sol.M3) / rod.torsional_stiffness / 2
        found = largest_strain(sol, observe(sol, ["kappa_max"])["kappa_max"])
        assert found == pytest.approx(max(along, twisted), rel=1e-6)  # 20,000 stations beside the peak


def test_the_strain_of_a_rod_with_weight_is_its_largest_stress_over_the_modulus() -> None:
    rod = Rod(E=2.06e8, nu=0.3, a=0.0635, inner_radius=0.0543, L=300.0, weight=0.241)
    sol = solve(Case(rod, Cylinder(0.10795, "inside", "120deg"), Ends(0.0, 0.0, FZ=-300.0)))
    rows = pipe_profile.profile(sol, {"length": "m", "force": "kN"})
    assert rows[-1].name == "both stresses together"
    assert largest_strain(sol, None) == pytest.approx(rows[-1].largest / 2.06e5, rel=1e-9)


MILLIMETRES = {"length": "mm", "force": "N"}
WOUND = Rod(E=2e5, nu=0.3, a=6.0, L=3000.0)  # a steel cable of 12 mm on a drum of 400 mm
HEAVY = replace(WOUND, weight=0.0087)
NITINOL = Rod(E=4e4, nu=0.33, a=0.25, L=20.0)  # a wire of 0.5 mm on a mandrel of 1.9 mm


@pytest.mark.parametrize(
    ("rod", "drum", "tension", "lay", "said"),
    [
        (WOUND, Cylinder(200.0), 2000.0, "75deg", "strained (2.7 %; linear to 0.25 %)"),
        (replace(WOUND, a=0.4), Cylinder(200.0), 2.0, "75deg", ""),  # 0.19 %
        (NITINOL, Cylinder(0.94), 1.0, "80deg", "strained (20 %; linear to 0.25 %)"),
        (replace(NITINOL, E=50.0), Cylinder(0.94), 0.01, "80deg", "strained (20 %; linear to 10 %)"),  # rubber
        (replace(NITINOL, E=50.0), Cylinder(5.0), 0.01, "80deg", ""),  # 4.6 %
    ],
)
def test_a_wound_cable_is_cautioned_where_its_strain_is_beyond_what_its_material_surely_bears(
    rod, drum, tension, lay, said
) -> None:
    sol = solve(Case(rod, drum, Ends.helix(rod, drum, tension, lay)), seed=0.0)
    bent = rod.a * np.sin(np.radians(float(lay.removesuffix("deg")))) ** 2 / (drum.R + rod.a)
    assert largest_strain(sol, sol.kappa.max()) == pytest.approx(bent, rel=0.05)  # with its tension
    assert str(caution_words.of_cases(sol, units=MILLIMETRES)) == said
    assert not caution_words.is_barred(said)
    if said:
        share, linear = re.findall(r"[\d.]+(?= %)", said)
        beyond = f"materials of its modulus may be non-linear beyond {linear} %"
        sentence = f"The rod is strained by {share} %, but {beyond}."
        assert caution_words.said(said) == sentence


def test_rods_of_every_kind_have_one_caution_on_strain() -> None:
    """A start problem, dead loads, held ends, weight; the command `solve` of a rod with weight says it too."""
    drum, table = Cylinder(200.0), Cylinder(200.0, inclination="90deg")
    wound = Ends.helix(WOUND, drum, 2000.0, "75deg")
    held = Ends(beta0=0.9, betaL=1.2, height=300.0)
    start = Start(wound.beta0, 0.0, F3=2000.0, M3=wound.M3)
    cases = (WOUND, drum, start), (WOUND, drum, wound), (replace(WOUND, L=600.0), drum, held), (HEAVY, table, start)
    for sol in (solve(Case(*case)) for case in cases):
        strain = 2.6 if sol.held else 2.7
        assert sol.solved
        assert f"strained ({strain} %; linear to 0.25 %)" in str(caution_words.of_cases(sol, units=MILLIMETRES))
        assert f"strained ({strain} %; metals are linear to 0.25 %)" in sol.caution  # the modulus has no unit
        assert f"strained by {strain} %, but metals may be non-linear beyond 0.25 %." in caution_words.said(sol.caution)
        if sol.case.varies:
            told = pipe_words.all_sentences(sol, MILLIMETRES)
            assert sum("strained by 2.7 %" in sentence for sentence in told) == 1
    plain = Rod(EI=WOUND.bending_stiffness, GJ=WOUND.torsional_stiffness, a=6.0, L=3000.0)  # a rope's wires slide
    assert solve(Case(plain, drum, wound)).caution == ""


@pytest.mark.parametrize("tol", [1e-2, 1e-3, 1e-5, 1e-8])
def test_a_loose_tolerance_excuses_no_stretch_without_push(tol: float) -> None:
    """A cable around a drum lies free in the middle too, at 681 to 741 mm and elsewhere."""
    rod = Rod(EI=2e5, GJ=1.5e5, a=5.0, L=2500.0)
    sol = solve(Case(rod, Cylinder(100.0), Start(np.radians(70), 0.0, F2=0.0, F3=50.0, M3=0.0)), tol=tol, stations=801)
    assert (sol.push[np.abs(sol.s - 710) < 20] < 0).all()
    assert "pulled in part" in str(caution_words.of_cases(sol))


@pytest.mark.parametrize("beta0, betaL", [(0.0, 0.0), (0.3, -0.2)])
def test_a_pipe_that_runs_against_both_its_ends_turns_back(beta0, betaL) -> None:
    """Pushed hard, a long pipe has its lowest energy turned round."""
    case = Case(Rod(EI=1.0, GJ=0.8, a=0.01, L=40.0), Cylinder(1.01, "inside"), Ends(beta0, betaL, FZ=-0.5))
    verdicts = set()
    for sol in (one.solution for one in equilibria(case) if one.index == 0):
        far = (np.abs(sol.beta - beta0) > np.pi / 2) & (np.abs(sol.beta - betaL) > np.pi / 2)
        behind = beta0 == betaL and sol.z[-1] * np.cos(beta0) < 0
        caution = str(caution_words.of_cases(sol))
        assert ("turned back" in caution_words.keys(caution)) == bool(far.any() or behind)
        verdicts.add(bool(far.any() or behind))
        if caution_words.keys(caution) == ["turned back"]:
            assert caution_words.said(caution) == "The rod turns back against the direction of both its ends."
            assert not caution_words.is_barred(caution)
    assert True in verdicts


def test_an_unsolved_case_gives_no_caution() -> None:
    study = small.study("[axes.E]\nvalues = [1e4, 2e4]")
    sol = solve(study.case(), stations=21)
    outcome, solved = np.array(["solved", "failed: on purpose"], dtype=object), np.array([True, False])
    sol = replace(sol, trajectory=replace(sol.trajectory, outcome=outcome, solved=solved))
    ds = dataset_assembly.make(study, study.variation.dimensions, columns(study, sol))
    assert [", ".join(caution_words.keys(text)) for text in ds["caution"].values] == ["overlaps, strained, pulled", ""]


def test_a_but_stands_in_a_sentence_of_its_own_of_one_rod_as_of_several() -> None:
    parts = "turned back", "strained (30 %; linear to 0.25 %)", "pulled at the ends (no push on 3 % of the length)"
    said = (
        "The rod turns back against the direction of both its ends. The rod is strained by 30 %, but materials of its "
        "modulus may be non-linear beyond 0.25 %. The rod would lift off next to its ends alone: no push on 3 % of the "
        "length."
    )
    assert caution_words.said(", ".join(parts)) == said


def test_no_real_rod_could_keep_an_unstable_shape_where_the_picture_counts_those_it_could() -> None:
    texts = [caution_words.MEETS, "", "", ""]
    assert caution_words.restable(texts, [True] * 4) == "real rods could keep three of the four shapes"
    stable = [True, True, False, False]
    assert caution_words.restable(texts, [True] * 4, stable) == "real rods could keep one of the four shapes"
    assert caution_words.restable(texts, [True, True, True, False], stable) == (
        "real rods could keep one of the three solved shapes"
    )
    assert (
        caution_words.restable(texts, [True] * 4, [True, False, False, False]) == "no real rod could keep these shapes"
    )
    assert caution_words.restable([""] * 4, [True] * 4, stable) == ""  # the index of each says it


@pytest.mark.parametrize(
    ("texts", "said"),
    [
        (["E"], "a real rod could keep this shape except next to its ends"),
        (["S, E"], "a real rod could keep this shape except next to its ends and if its material stays linear"),
        (["S", "S"], "real rods could keep these shapes if their material stays linear"),
        (["E, S", "S"], "real rods could keep these shapes except next to their ends or if their material stays "
            "linear"),
        (["S", "", "overlaps"], "real rods could keep one of the three shapes, and one more if their material stays "
            "linear"),
        (["E", "", "S", ""], "real rods could keep two of the four shapes, and two more except next to their ends or "
            "if their material stays linear"),
        (["S, overlaps", ""], "real rods could keep one of the two shapes"),
    ],
)  # fmt: skip
def test_of_the_shapes_that_real_rods_could_keep_the_strained_ones_are_told(texts: list[str], said: str) -> None:
    full = {"S": "strained (1 %; linear to 0.25 %)", "E": "pulled at the ends (no push on 3 % of the length)"}
    cautions = [", ".join(full.get(part, part) for part in text.split(", ")) for text in texts]
    assert caution_words.restable(cautions, [True] * len(texts)) == said


@pytest.mark.parametrize(
    ("barred", "said"),
    [([3], "three of the four shapes (E ≤ 3 N/cm²)"), ([0], "three of the four shapes (E ≥ 2 N/cm²)"),
     ([0, 3], "two of the four shapes (2 N/cm² ≤ E ≤ 3 N/cm²)"), ([0, 2, 3], "one of the four shapes (E = 2 N/cm²)"),
     ([1], "three of the four shapes")],
)  # fmt: skip
def test_the_values_at_which_real_rods_could_keep_their_shapes_are_told_where_they_are_one_range(
    barred: list[int], said: str
) -> None:
    axis = "E", [4.0, 3.0, 2.0, 1.0], {"units": "N/cm^2"}  # as the study gives them: falling
    texts = ["overlaps" if k in barred else "" for k in (3, 2, 1, 0)]
    ds = xr.Dataset({"outcome": ("E", ["solved"] * 4), "caution": ("E", texts)}, {"E": axis})
    assert StoredStudy(ds).restable == f"real rods could keep {said}"


def test_of_a_list_of_equilibria_no_range_is_told() -> None:
    """Their numbers are no axis."""
    columns = {"outcome": ["solved"] * 2, "caution": ["overlaps", ""], "index": [0, 0]}
    ds = xr.Dataset({name: ("equilibrium", values) for name, values in columns.items()}, {"equilibrium": [0, 1]})
    assert StoredStudy(ds).restable == "real rods could keep one of the two shapes"
