"""A sweep over ends problems: the order of its cases, the same bits whoever solves it, and what it says of branches."""

import numpy as np
import pytest
import xarray as xr

import workbench.accessor  # noqa: F401  (ds.rod)
from solver import Case, Ends, solve
from studies import Study
from studies.language.loader import loads
from studies.laws.line_verdicts import FAILS, UNDECIDED
from tests.slow import slow, slow_but
from tests.workbench import small
from workbench.commands import study_scene
from workbench.run import in_memory
from workbench.scene import scene_kinds
from workbench.stored import case_solving, stored_verdicts, sweep

PIPE = {"E": 2.06e8, "inner_radius": 0.0543, "nu": 0.3, "a": 0.0635, "R": 0.108}
HELD = {**PIPE, "side": "inside", "beta0": 0.0, "betaL": 0.0}
FORCES = small.axis("FZ", (-60.0, -40.0, 21))


def pipe(axes: str, L: float = 20.0) -> str:
    """A pipe pushed down its hole."""
    names = ["amplitude", "height", "index"]
    return small.text(HELD | {"L": L}, axes, "m kN", observables=names, outputs=["beta"], stations=51)


def study(axes: str = FORCES, L: float = 20.0) -> Study:
    return loads(pipe(axes, L), "text", "pipe")


# the order


@pytest.mark.parametrize("shape", ((1,), (2,), (30,), (3, 5), (4, 1), (1, 6), (2, 3, 4)))
def test_every_case_continues_from_a_neighbour_and_all_from_the_middle(shape) -> None:
    grid = sweep.SweepGrid(shape)
    first = grid.place(grid.first)
    assert grid.parent(first) is None
    for place in range(int(np.prod(shape))):
        steps, at = 0, place
        while (parent := grid.parent(at)) is not None:
            difference = np.abs(np.subtract(grid.cell(at), grid.cell(parent[0])))
            assert difference.sum() == 1
            assert difference[parent[1]] == 1
            at, steps = parent[0], steps + 1
        assert at == first
        assert steps == np.abs(np.subtract(grid.cell(place), grid.first)).sum()  # the shortest way


@pytest.mark.parametrize("shape", ((30,), (3, 5), (7, 40), (2, 300)))
def test_a_block_begins_on_each_line_at_its_case_nearest_to_the_first(shape) -> None:
    grid, size = sweep.SweepGrid(shape), sweep.block_size(shape, 1000)
    for start in range(0, int(np.prod(shape)), size):
        places = np.arange(start, min(start + size, int(np.prod(shape))))
        lines = [places[places // shape[-1] == line] for line in np.unique(places // shape[-1])]
        far = [np.abs(line % shape[-1] - grid.first[-1]) for line in lines]
        nearest = [int(line[away.argmin()]) for line, away in zip(lines, far, strict=True)]
        assert grid.entries(start, int(places[-1]) + 1) == nearest


# what is stored


@pytest.fixture(scope="module")
def line() -> xr.Dataset:
    return in_memory.run(study())


def test_a_sweep_numbers_its_branch_and_says_how_its_middle_case_was_taken(line) -> None:
    assert (line["branch"] == 0).all()
    assert line["branch"].dtype.kind == "i"
    assert (line["outcome"] == "solved").all()
    assert line.attrs["equilibria"].startswith("the case in the middle of the grid, FZ = -50: ")
    assert line.attrs["equilibria"].endswith("the stable shape that swings least")


def taken_over(values: list[float], more: str = "") -> dict[float, tuple[float, float]]:
    """beta'(0) and the height of each case of a study over FZ."""
    ds = in_memory.run(study(f"[axes.FZ]\nvalues = {values}\n{more}"))
    return {float(FZ): (float(ds["beta"].sel(FZ=FZ)[1]), float(ds["height"].sel(FZ=FZ))) for FZ in ds["FZ"].values}


@pytest.mark.parametrize("more", slow_but(("", '[equilibrium]\nchoose = "lowest"\n', "[equilibrium]\nindex = 1\n"), ""))
def test_the_equilibrium_at_a_load_does_not_depend_on_the_other_loads(more) -> None:
    few = taken_over([-60.0, -45.0], more)
    for values in ([-400.0, -60.0, -50.0, -45.0, -5.0], [-60.0, -59.0, -58.0, -45.0], [-45.0, 3.0, 200.0]):
        for FZ, numbers in taken_over(values, more).items():
            if FZ in few:
                assert numbers == few[FZ]
    if not more:
        for FZ, (rise, height) in few.items():
            usual = solve(study().case_of({"FZ": FZ}), stations=51)
            assert rise == usual.beta[1] > 0  # of two mirror images the one whose beta rises first
            assert height == pytest.approx(float(usual.z[-1]), rel=1e-9)


RANGES = {"E": (2e3, 2e4), "L": (2.0, 9.0), "FZ": (-6.0, 2.0), "MZ": (-2.0, 2.0), "M3": (-2.0, 2.0),
          "betaL": (-1.0, 1.5), "height": (-0.4, 0.9)}  # fmt: skip


def random_study(seed: int) -> tuple[str, str, list[float]]:
    """The text of a study without its values, the name of its axis, and eight values; every sixth holds the height."""
    draw = np.random.default_rng(seed)
    held, symmetric = seed % 6 == 5, seed % 3 == 0
    axis = "height" if held else str(draw.choice(list(RANGES)[:6]))
    numbers = {name: float(draw.uniform(*RANGES[name])) for name in ("E", "L", "FZ", "MZ", "M3", "betaL")}
    numbers |= {"beta0": 0.0 if symmetric else float(draw.uniform(-0.8, 0.8))}
    numbers |= {"MZ": 0.0, "M3": 0.0, "betaL": 0.0} if symmetric else {}
    values = draw.uniform(*RANGES[axis], 8) * (numbers["L"] if held else 1)
    left_out = {axis, "FZ"} if held else {axis}
    side = "inside" if draw.random() < 0.5 else "outside"
    base = {"nu": 0.25, "a": 0.1, "R": 1.1} | {name: of for name, of in numbers.items() if name not in left_out}
    given = {"observables": ["height", "index"], "outputs": ["beta"], "stations": 11}
    rule = draw.choice(["", "", '[equilibrium]\nchoose = "lowest"', "[equilibrium]\nindex = 1"]) if not held else ""
    return small.text(base | {"side": side}, str(rule) + "\n", **given), axis, values.tolist()


def cases_of(text: str, axis: str, values: list[float]) -> dict[float, tuple[str, bytes]]:
    """Solved or not, and beta, of each case of a study with these values of its axis."""
    ds = in_memory.run(loads(text + small.axis(axis, values), "text", "random"))
    row = ds["beta"].transpose(axis, "u").values
    return {float(value): (str(said).split(";")[0], row[i].tobytes())
            for i, (value, said) in enumerate(zip(ds[axis].values, ds["outcome"].values, strict=True))}  # fmt: skip


@pytest.mark.parametrize("seeds", [(0, 5), slow(range(200))])
def test_a_case_is_the_same_whatever_the_range_the_order_and_the_number_of_values(seeds) -> None:
    for seed in seeds:
        text, axis, values = random_study(seed)
        whole = cases_of(text, axis, values)
        part = cases_of(text, axis, sorted(values[:5], reverse=True)) | cases_of(text, axis, values[5:6])
        assert part == {value: whole[value] for value in part}, seed
        one = loads(text + small.axis(axis, values), "text", "random")
        choose = case_solving.rule_of(one.equilibrium)
        for value in values[:2]:
            usual = solve(one.case_of({axis: value}), stations=11, tol=one.tol, choose=choose)
            said, beta = whole[value]
            assert (said == "solved") == bool(usual.solved), seed
            if usual.solved:
                np.testing.assert_allclose(np.frombuffer(beta), usual.beta, atol=1e-12)
                if seed % 3 == 0 and axis in ("E", "L", "FZ"):  # of two mirror images the one whose beta rises first
                    assert usual.dbeta[0] >= 0


def test_the_first_case_is_the_one_that_equilibrium_chooses() -> None:
    index = in_memory.run(study(FORCES + "[equilibrium]\nindex = 2\n"))
    assert index["index"].sel(FZ=-50.0) == 2
    assert (index["branch"] == 0).all()
    assert "of those of index 2 the shape that swings least" in index.attrs["equilibria"]
    low = in_memory.run(study(FORCES.replace("21", "3") + '[equilibrium]\nchoose = "lowest"\n'))
    assert "the shape of lowest energy" in low.attrs["equilibria"]
    named = float(solve(study().case_of({"FZ": -50.0}), choose=1, stations=3).dbeta[0])
    energy = 1e3
    text = FORCES.replace("21", "3") + f"[equilibrium]\ndbeta0 = {named!r}\nenergy = {energy!r}\n"
    assert "the one next to beta'(0)" in in_memory.run(study(text)).attrs["equilibria"]


# read again


def test_a_picture_of_a_study_shows_the_branch_that_the_study_is_on(tmp_path) -> None:
    path = tmp_path / "pipe.toml"
    path.write_text(pipe(FORCES.replace("21", "5") + "[equilibrium]\nindex = 2\n"))
    whole, rough = study_scene.two_stations(path)
    solve = study_scene.solver_of(rough, scene_kinds.kind_of("plain"), {"FZ": -60.0}, [])
    assert solve is not None
    np.testing.assert_array_equal(solve(51)["beta"].values[0], in_memory.run(whole)["beta"].values[0])


# branches


def beyond_the_fold():
    """Table 1 held at its own far end, which is turned past the fold of its own branch at 35.34 degrees."""
    from solver.follow import to_fold
    from solver.observe.observables import observe
    from tests.cases import table_1

    start = table_1("force-first", "tension", "paper")
    branch = to_fold(start, np.deg2rad(60.0))
    FZ, MZ, M3 = (float(load) for load in start.loads)
    middle = Case(start.rod, start.cylinder, Ends(start.given.beta, np.deg2rad(35.0), FZ, MZ, M3))
    slope = float(np.interp(np.deg2rad(35.0), branch.values, branch.dbeta0))
    own = solve(middle, seed=slope)
    energy = float(observe(own, ["energy"])["energy"])
    base = {**small.ROD, "stiffness": "paper", "beta0": "30deg", "FZ": FZ, "MZ": MZ, "M3": M3}
    which = "[equilibrium]\n" + small.lines({"dbeta0": float(own.dbeta[0]), "energy": energy})
    tables = small.axis("betaL", (28.0, 42.0, 15), unit="deg") + which + small.law("kappa_mean", "betaL", "rises")
    text = small.text(base, tables, observables=["kappa_mean", "index", "bends"], outputs=["beta"])
    return loads(text, "text", "past"), branch


def test_a_branch_that_loses_its_stability_says_so() -> None:
    """The straight pipe of 20 m buckles at A (pi/L)^2 = 30.2 kN; its branch goes on, unstable."""
    one = study(small.axis("FZ", (-5.0, -40.0, 11), follow=True))
    ds = in_memory.run(one)
    critical = float(one.case().rod.bending_stiffness) * (np.pi / 20.0) ** 2
    assert (ds["branch"] == 0).all()
    lost = -ds["FZ"].values > critical
    assert lost.sum() == 3
    np.testing.assert_array_equal(ds["index"] > 0, lost)
    words = np.where(lost, "solved; unstable here, stable where its branch begins", "solved")
    assert ds["outcome"].values.tolist() == words.tolist()


def test_a_buckled_branch_ends_where_the_pipe_straightens() -> None:
    one = study(small.axis("FZ", (-60.0, -10.0, 11)))
    ds = in_memory.run(one)
    critical = float(one.case().rod.bending_stiffness) * (np.pi / 20.0) ** 2
    straight = -ds["FZ"].values < critical
    np.testing.assert_array_equal(ds["branch"], straight)
    np.testing.assert_array_equal(ds["amplitude"] == 0, straight)
    assert str(ds["outcome"].values[straight][0]) == "solved; another branch than at FZ = -35"


def test_past_a_fold_the_cases_are_of_another_branch_and_say_so() -> None:
    one, branch = beyond_the_fold()
    ds = in_memory.run(one)
    beyond = np.rad2deg(branch.fold)
    assert 35 < beyond < 36
    np.testing.assert_array_equal(ds["branch"], np.where(np.rad2deg(ds["betaL"]) < beyond, 0, 1))
    words = [str(text) for text in ds["outcome"].values]
    assert words[8] == "solved; another branch than at betaL = 35 deg"
    assert set(words[:8]) | set(words[9:]) == {"solved"}
    before = ds["index"].values[:8]
    assert (before == before[0]).all()
    (law,) = stored_verdicts.verdicts(ds)
    assert law["verdict"] in (UNDECIDED, FAILS)
    assert "crosses to another branch of equilibria" in law["reason"]


def test_beyond_a_jump_cases_that_continue_from_one_another_are_on_one_branch() -> None:
    """At beta0 = 0 one of two mirror images is chosen, so on one side a step along beta0 comes upon another branch. It
    came upon one for each E, and a law along E was undecided there."""
    wire = {"nu": 0.3, "a": 0.25, "L": 120.0, "R": 1.0, "side": "inside", "betaL": 0.0, "FZ": -50.0}
    axes = small.axis("E", (1e5, 2.1e5, 3)) + small.axis("beta0", ("-10deg", "10deg", 3))
    ds = in_memory.run(loads(small.text(wire, axes, "mm N", observables=["amplitude"], stations=51), "text", "wire"))
    jumps = stored_verdicts.crossings(ds, "beta0")
    assert not stored_verdicts.crossings(ds, "E").any()
    assert (jumps.sum(axis=1) == 1).all()
    assert (jumps == jumps[0]).all()
    np.testing.assert_allclose(ds["amplitude"][:, 0], ds["amplitude"][:, 2], rtol=1e-9)


@pytest.mark.slow
def test_a_wire_pushed_into_a_tube_is_not_turned_back_because_the_axis_goes_far() -> None:
    base = {"E": 6e4, "nu": 0.3, "a": 0.25, "L": 120.0, "R": 2.0, "side": "inside", "beta0": 0.0, "betaL": 0.0}
    for last in (-10.0, -200.0):
        forces = small.axis("FZ", [0.0, -5.0, 0.6 * last, 0.75 * last, last])
        ds = in_memory.run(loads(small.text(base, forces, "mm N", observables=["height", "push_max"]), "text", "wire"))
        assert float(ds["height"].sel(FZ=-5.0)) == pytest.approx(117.7948, abs=1e-4)
        assert float(ds["push_max"].sel(FZ=-5.0)) == pytest.approx(0.182, abs=5e-4)
