"""The shipped studies themselves, those of Fig. 6 and Fig. 7 among them: the laws they state, and where they hold."""

from collections.abc import Callable
from functools import partial
from io import BytesIO

import numpy as np
import pytest
import xarray as xr
from matplotlib import image

from solver import Ends, solve
from solver.follow import to_fold
from studies import TABLE_1, load, names
from tests.slow import slow
from tests.workbench import small, stored_figures
from workbench.figures import canvas, crossing_rings, figure_kinds
from workbench.run import in_memory
from workbench.stored import stored_verdicts
from workbench.stored.stored_study import StoredStudy

VERDICTS = {  # of the laws of each figure under the default reading
    "fig6": [],
    "fig7_1_modulus": [("true", [])],
    "fig7_2_radius": [("true in part", ["depends on the observable"])],
    "fig7_3_start_angle": [("true", []), ("true in part", ["depends on the observable"])],
    "fig7_4_end_angle": [("true in part", ["not contradicted"]), ("true", [])],
    "fig7_5_forces": [
        ("true in part", ["on part of the grid", "depends on the observable"]),
        ("true in part", ["on part of the grid"]),
    ],
    "regimes": [("true in part", ["on part of the grid"]), ("true in part", ["on part of the grid"])],
    "regimes_refined": [],
    "samples_pipe": [],
    "pipe_lubinski": [("true", [])] * 6,
    "pipe_horizontal": [("true", [])] * 4,
    "pipe_vertical": [("true", [])] * 4,
    "pole_greenhill": [("true", [])] * 2,
    "capstan": [("true", [])],
    "belt": [("true", [])] * 3,
    "let_go": [("true", [])] * 3,
    "pipe_centred": [("true", [])] * 5,
}
PAPER = [name for name in names() if name.startswith("fig")]


LEAVING = "belt", "let_go", "pipe_centred"
# Three rods of pipe_centred decide no law.
DATASETS = [(name, small.study_dataset) for name in names() if name != "pipe_centred"]


@pytest.mark.parametrize(("name", "dataset"), [*DATASETS, slow("pipe_centred", small.whole_study_dataset)])
def test_the_pictures_of_a_shipped_study_can_be_read_and_show_what_is_stored(
    name: str, dataset: Callable[[str], xr.Dataset]
) -> None:
    ds = dataset(name)
    pictures = {
        kind: partial(figure_kinds.figure, StoredStudy(ds), kind) for kind in stored_figures.kinds_of(StoredStudy(ds))
    }
    stored_figures.check(f"figure_{name}", pictures)


@pytest.mark.parametrize(("name", "dataset"), [*DATASETS, *(slow(name, small.whole_study_dataset) for name in LEAVING)])
def test_no_law_of_a_shipped_study_fails_under_the_default_reading_and_those_that_hold_with_a_reserve_say_so(
    name: str, dataset: Callable[[str], xr.Dataset]
) -> None:
    ds = dataset(name)
    assert StoredStudy(ds).unsolved == 0
    rows = stored_verdicts.verdicts(ds)
    assert [(row["verdict"], row["qualifications"]) for row in rows] == VERDICTS[name]
    assert all(row["reason"] for row in rows if row["verdict"] == "true in part")
    assert (stored_verdicts.status(0, stored_verdicts.verdicts(ds)) == 0) == all(
        verdict == "true" for verdict, _ in VERDICTS[name]
    )
    assert not stored_verdicts.is_refuted(0, rows)


def test_the_reasons_of_figure_7_are_those_of_its_numbers() -> None:
    radius, angle = small.study_dataset("fig7_2_radius"), small.study_dataset("fig7_4_end_angle")
    assert (np.diff(radius["amplitude"]) > 0).all()
    assert "amplitude rises instead at 8 of 8 steps" in stored_verdicts.verdicts(radius)[0]["reason"]
    assert angle["bends"].values.tolist() == [6] * 9
    assert "bends stays at 6, where the sentence says that it rises" in stored_verdicts.verdicts(angle)[0]["reason"]


def test_each_law_of_the_paper_says_whether_its_rule_was_fixed_in_advance() -> None:
    laws = [law for name in PAPER for law in load(name).laws]
    assert {law.claim for law in laws if law.fixed == "after"} == {"(5)"}
    assert {law.claim for law in laws if law.fixed == "in advance"} == {"(1)", "(2)", "(3)", "(4)"}
    assert all(law.fixed_note for law in laws)


def test_fig_6_is_table_1_as_printed() -> None:
    assert load("fig6").base.given == TABLE_1


def test_ranges_and_observables_are_those_fixed_beforehand() -> None:
    fixed = {
        "fig7_1_modulus": ("E", 5e3, 4e4, {"bends"}),
        "fig7_2_radius": ("R", 0.5, 1.5, {"kappa_max"}),
        "fig7_3_start_angle": ("beta", np.deg2rad(15), np.deg2rad(60), {"bends", "kappa_mean"}),
        "fig7_5_forces": ("F1", 2.5, 10.0, {"contact_size_mean"}),
    }
    for name, (axis, first, last, judged) in fixed.items():
        study = load(name)
        values = study.variation.dimensions.fields[axis]
        assert (values.size, values[0], values[-1]) == (9, pytest.approx(first), pytest.approx(last))
        assert {law.observable for law in study.laws} == judged
    steps = np.diff(np.log(load("fig7_1_modulus").variation.dimensions.fields["E"]))
    np.testing.assert_allclose(steps, steps[0], rtol=1e-12)  # rounding of the logarithms
    assert load("fig7_5_forces").variation.dimensions.fields["F3"][[0, -1]].tolist() == [5.0, 20.0]


def test_the_end_angle_is_followed_from_the_base_rod_to_its_fold() -> None:
    study = load("fig7_4_end_angle")
    ds = in_memory.run(study)
    base = solve(study.case())
    assert ds["betaL"][0] == pytest.approx(base.beta[-1], abs=1e-8)  # the tolerance of the base rod
    np.testing.assert_allclose(ds["beta"][0], base.beta, atol=1e-6)  # 1e-8 times the growth along the rod
    np.testing.assert_allclose(ds["beta"][:, -1], ds["betaL"], atol=1e-8)  # each ends where its axis says
    np.testing.assert_allclose(ds["beta"][:, 0], TABLE_1["beta"], atol=1e-8)
    for load_name in ("FZ", "MZ", "M3"):
        assert np.ptp(ds[load_name].values) == 0
    assert ds["fold"] == pytest.approx(ds["betaL"][-1].item())
    assert "ceases to exist at beta(L) = 0.6168" in ds.attrs["fold_note"]


def test_beyond_the_fold_the_followed_equilibrium_is_gone() -> None:
    study = load("fig7_4_end_angle")
    branch = to_fold(study.case(), study.axes[study.variation.followed].limit, 9)
    ends = branch.ends.given
    beyond = Ends(ends.beta0, branch.fold + 1e-3, ends.FZ, ends.MZ, ends.M3)
    case = type(branch.ends)(branch.ends.rod, branch.ends.cylinder, beyond)
    found = solve(case, seed=branch.fold_dbeta0)
    assert not found.solved or abs(found.dbeta[0] - branch.fold_dbeta0) > 0.1  # none near: another, or none at all


def test_where_a_law_decides_is_where_a_picture_is_taken() -> None:
    forces = small.study_dataset("fig7_5_forces")
    for row in stored_verdicts.verdicts(forces):
        for name, value in row["at"].items():
            assert float(forces[name][StoredStudy(forces).place()[name]]) == pytest.approx(value)


def test_a_ring_has_pale_edges_and_covers_nothing_inside_or_beyond() -> None:
    def draw(fig) -> None:
        ax = fig.add_axes((0, 0, 1, 1))
        ax.set_facecolor("black")
        crossing_rings.draw(ax, [(0.5, 0.5)], [12.0], "ring")

    fig = canvas.figure((1.0, 1.0), draw, layout=None)
    page = BytesIO()
    canvas.save(fig, page, 200)
    page.seek(0)
    white = image.imread(page)[..., :3].min(axis=-1) > 0.5
    points = np.hypot(*np.indices(white.shape) - 99.5) * 72 / 200
    half = crossing_rings.EDGED / 2 + 0.4
    assert white[points < 6].any()  # the ring is seen on what is dark
    assert white[points > 6].any()
    assert not white[np.abs(points - 6) > half].any()
