"""The table [refine]: what is refused, the lattice of its values, and which cells are halved."""

import numpy as np
import pytest

from studies.language.loader import dumps, loads
from studies.language.refine_table import refinement
from studies.language.refinement import BUDGET, TOLERANCE, Lattice, Refine, RefinedLines, Refinement, refinement_of

HEAD = 'title = "r"\nreading = "force-first/tension/paper"\n'
UNITS = '[units]\nlength = "cm"\nforce = "N"\n'
E = '[axes.E]\nfrom = 5e3\nto = 4e4\ncount = 5\nspacing = "geometric"\n'
R = "[axes.R]\nfrom = 0.5\nto = 1.5\ncount = 4\n"
TABLE = '[refine]\nwatch = ["bends"]\ntolerance = 0.01\n'


def study(axes: str = E + R, table: str = TABLE, head: str = ""):
    return loads(HEAD + head + UNITS + axes + table)


def test_a_refined_study_begins_as_its_coarse_grid_and_watches_what_it_stores() -> None:
    work = study(E + R, TABLE.replace('["bends"]', '["loops", "outcome"]'))
    assert (work.variation.size, work.variation.sampled, work.variation.fields) == (20, ("E", "R"), ("E", "R"))
    assert "loops" in work.wanted
    assert work.coarse().variation.dimensions.shape == (5, 4)
    grid = work.coarse().variation.dimensions
    np.testing.assert_array_equal(work.variation.dimensions.fields["E"].reshape(5, 4)[:, 0], grid.fields["E"])
    assert loads(dumps(work)).model_dump() == work.model_dump()


# the lattice


def test_the_most_points_that_a_refusal_names_are_taken() -> None:
    assert Refine(watch=["bends"], points=1_000_000_000).share == pytest.approx(1e-9)


def test_halvings_make_equal_ratios_or_equal_differences_as_the_axis_does() -> None:
    found = refinement(study(table=TABLE.replace("tolerance = 0.01", "points = 13"))).lattice
    assert (found.depth, found.sizes) == (2, (17, 13))
    places = np.indices(found.sizes).reshape(2, -1).T
    values = found.values(places)
    np.testing.assert_allclose(values["E"].reshape(17, 13)[:, 0], np.geomspace(5e3, 4e4, 17), rtol=1e-14)
    np.testing.assert_allclose(values["R"][:13], np.linspace(0.5, 1.5, 13), rtol=1e-14)
    np.testing.assert_array_equal(found.places(values), places)
    np.testing.assert_array_equal(found.levels(places)[:5], [0, 2, 1, 2, 0])
    assert found.share(2) == pytest.approx(1 / 12)


@pytest.mark.parametrize(
    ("coarse", "geometric"),
    [([3.0, 7.0, 8.0, 30.0], False), ([-40.0, -10.0, -5.0], True), ([1e-9, 1e9], True), ([0.1, 0.3], False)],
)
@pytest.mark.parametrize("depth", (0, 5, 24))
def test_a_value_has_its_place_and_a_place_between_two_has_none(coarse, geometric, depth) -> None:
    found = Lattice({"x": np.array(coarse)}, frozenset({"x"} if geometric else ()), depth)
    rng = np.random.default_rng(1)
    places = np.unique(np.append(rng.integers(0, found.sizes[0], 400), [0, found.sizes[0] - 1]))[:, None]
    values = found.values(places)
    np.testing.assert_array_equal(found.places(values), places)
    assert (np.diff(values["x"]) > 0).all()
    between = {"x": found.along("x", places[:-1, 0] + 0.3)}
    assert (found.places(between) == -1).all()
    assert (found.places({"x": np.array([coarse[0] - abs(coarse[0]), coarse[-1] + abs(coarse[-1])])}) == -1).all()


def test_the_same_value_has_the_same_bits_at_every_depth() -> None:
    few, many = (Lattice({"x": np.array([5e3, 7e3, 4e4])}, frozenset({"x"}), depth) for depth in (3, 9))
    places = np.arange(few.sizes[0])
    np.testing.assert_array_equal(few.along("x", places), many.along("x", places << 6))


# which cells are halved


def refined(f, shape=(7, 5), depth=4, budget=10**6, steps=(0.0,)) -> Refinement:
    """A made-up number over the unit square, refined."""
    axes = {name: np.linspace(0, 1, size) for name, size in zip("xy", shape, strict=False)}
    found = Refinement(Lattice(axes, frozenset(), depth), np.array(steps), budget)
    while found.next_count:
        values = found.lattice.values(found.places[-found.next_count :])
        numbers = f(*values.values())
        found.take(np.reshape(numbers, (found.next_count, -1)).astype(float))
    return found


def on_grid(found: Refinement, f) -> np.ndarray:
    places = np.indices(found.lattice.sizes).reshape(len(found.lattice.sizes), -1).T
    return np.asarray(f(*found.lattice.values(places).values()), dtype=float).reshape(found.lattice.sizes)


def waves(x, y):
    return np.floor(3 * (x + 0.3 * np.sin(5 * y)))


def finger(x, y):
    """A thin region that begins in one cell and passes through others without reaching one of their corners."""
    return ((np.abs(y - 0.37) < 0.015 + 0.2 * (x < 0.2)) & (x < 0.9)).astype(float)


@pytest.mark.parametrize("f", (waves, finger))
def test_a_boundary_is_followed_into_cells_whose_corners_agree(f) -> None:
    found = refined(f)
    grid = on_grid(found, f)
    corners = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[:-1, 1:], grid[1:, 1:]])
    finest = np.zeros(corners.shape[1:], dtype=bool)
    finest[tuple(found.cells[-1].T)] = True
    assert finest[np.ptp(corners, axis=0) > 0].all()
    assert found.ended == TOLERANCE
    assert found.open_cells() == [0] * 5
    assert len(found.places) < 0.5 * grid.size
    assert len({tuple(place) for place in found.places.tolist()}) == len(found.places)


def test_neighbours_that_differ_are_one_finest_step_apart_and_all_pairs_of_the_grid_are_among_them() -> None:
    found = refined(waves)
    pairs, along = found.edges()
    differ = (np.diff(found.numbers[pairs, 0], axis=1) != 0)[:, 0]
    assert (np.abs(np.diff(found.places[pairs[differ]], axis=1)).sum(axis=(1, 2)) == 1).all()
    grid = on_grid(found, waves)
    for axis in (0, 1):
        assert int((differ & (along == axis)).sum()) == int((np.diff(grid, axis=axis) != 0).sum())


def test_a_budget_ends_the_refinement_with_the_first_cases_of_the_whole_one() -> None:
    whole = refined(waves)
    for budget in (35, 36, 100, 301):
        part = refined(waves, budget=budget)
        assert part.ended == BUDGET
        assert 0 <= budget - len(part.places) < 5
        np.testing.assert_array_equal(part.places, whole.places[: len(part.places)])
        assert sum(part.open_cells()) > 0


def test_a_finer_tolerance_begins_with_the_cases_of_the_coarser_one() -> None:
    few, many = refined(waves, depth=3), refined(waves, depth=5)
    np.testing.assert_array_equal(many.places[: len(few.places)], few.places * 4)


def test_along_one_axis_a_jump_costs_two_cases_for_each_halving() -> None:
    """One halves the interval that holds it, one tests the middle of the half that does not."""
    found = refined(lambda x: x > 0.4321, shape=(6,), depth=20)
    assert len(found.places) == 6 + 4 + 20 + 19  # four intervals hold no jump; a half of the last level has no middle
    pairs, _ = found.edges()
    (jump,) = np.flatnonzero(np.diff(found.numbers[pairs, 0], axis=1)[:, 0])
    low, high = found.lattice.along("x", found.places[pairs[jump], 0])
    assert low <= 0.4321 < high
    assert high - low == pytest.approx(0.2 / 2**20)


def test_along_one_axis_what_holds_the_middle_of_a_level_interval_is_found() -> None:
    found = refined(lambda x: (x > 0.27) & (x < 0.35), shape=(6,), depth=12)  # 0.3 is the middle of 0.2 and 0.4
    numbers = found.numbers[np.argsort(found.places[:, 0]), 0]
    assert np.count_nonzero(np.diff(numbers)) == 2
    assert found.widest() == pytest.approx(0.1)
    assert not any(found.open_cells())


def with_law(along: int, budget: int = 10**6) -> Refinement:
    """Lines are judged by the largest of a made-up number on them."""
    axes = {"x": np.linspace(0, 1, 6), "y": np.linspace(0, 1, 4)}
    lines = RefinedLines(along, 0, lambda values: np.where(values.max(axis=1) > 0.8, "false", "true"))
    found = Refinement(Lattice(axes, frozenset(), 5), np.array([np.inf]), budget, (lines,))
    while found.next_count:
        x, y = found.lattice.values(found.places[-found.next_count :]).values()
        found.take((x * np.cos(y) if along == 0 else np.sin(x) * (1 + y) / 1.5)[:, None])
    return found


@pytest.mark.parametrize(("along", "border"), [(0, np.arccos(0.8)), (1, np.arcsin(0.6))])
def test_where_a_law_changes_its_verdict_whole_lines_are_added(along: int, border: float) -> None:
    found = with_law(along)
    size = (6, 4)[along]
    assert (len(found.places), found.ended, found.rounds) == (24 + 5 * size, TOLERANCE, 5)
    ((low, high),) = np.transpose(found.lines[0].gaps())
    assert high - low == 1
    name = "yx"[along]
    assert found.lattice.along(name, np.array([low]))[0] < border <= found.lattice.along(name, np.array([high]))[0]


def test_a_budget_adds_whole_lines_alone() -> None:
    found = with_law(0, budget=24 + 6 * 3 + 5)
    assert (len(found.places), found.ended, found.open_lines()) == (24 + 6 * 3, BUDGET, 1)
    np.testing.assert_array_equal(found.places, with_law(0).places[: len(found.places)])


def test_nothing_is_added_where_nothing_changes_or_the_coarse_grid_has_the_tolerance() -> None:
    for f, depth in ((lambda x, y: 0 * x, 4), (waves, 0)):
        found = refined(f, depth=depth)
        assert (len(found.places), found.rounds, found.ended) == (35, 0, TOLERANCE)


def test_a_number_that_is_missing_agrees_with_all_but_an_outcome_does_not() -> None:
    def missing(x, y):
        return np.where(x > 0.52, np.nan, 1.0)

    assert refined(missing).rounds == 0
    both = refined(lambda x, y: np.stack([missing(x, y), x > 0.52], 1), steps=(0.0, 0.0))
    assert both.rounds == 4


def test_a_step_is_the_change_that_counts() -> None:
    found = refined(lambda x, y: np.hypot(x, y), steps=(0.1,), depth=6)
    pairs, _ = found.edges()
    assert np.abs(np.diff(found.numbers[pairs, 0], axis=1)).max() <= 0.1
    assert found.ended == TOLERANCE


def test_the_cells_follow_from_the_stored_cases() -> None:
    whole = refined(waves, budget=301)
    order = np.random.default_rng(2).permutation(len(whole.places))
    again = refinement_of(whole.lattice, whole.places[order], whole.numbers[order], whole.steps, 4)
    for ours, theirs in zip(again.cells, whole.cells, strict=True):
        assert {tuple(cell) for cell in ours.tolist()} == {tuple(cell) for cell in theirs.tolist()}


def test_the_refinement_of_a_study_has_its_steps_and_its_budget() -> None:
    found = refinement(
        study(table=TABLE.replace('["bends"]', '["bends", "turns_around"]') + "steps = {turns_around = 0.2}\n")
    )
    assert (found.steps.tolist(), found.budget, found.lattice.depth) == ([0.0, 0.2], 10_000, 6)
