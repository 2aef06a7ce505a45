"""The figures of stored datasets: they show the data, the law and its verdict, and solve nothing."""

import sys
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from solver.errors import InputError
from studies import load, names
from workbench import check, picking, plots, profile, runner, style

from .pictures import pixels, share_of_ink
from .small import grid, study


@pytest.fixture(scope="module")
def forces() -> xr.Dataset:
    return runner.run(load("fig7_5_forces"))


@pytest.fixture(scope="module")
def angles() -> xr.Dataset:
    return runner.run(load("fig7_3_start_angle"))


def axes():
    return Figure().subplots()


def said(ax) -> str:
    return " ".join([ax.get_title(loc="left"), *(text.get_text() for text in ax.texts)]).replace("\n", " ")


@pytest.mark.parametrize("name", names())
def test_every_shipped_study_has_a_figure_that_is_not_empty(name: str, tmp_path) -> None:
    path = tmp_path / f"{name}.png"
    plots.figure(runner.run(load(name)), path)
    picture = pixels(path)
    assert picture.shape[1] >= 1800
    assert 0.02 < share_of_ink(picture) < 0.6
    edge = np.concatenate([picture[:4].ravel(), picture[:, :4].ravel(), picture[:, -4:].ravel()])
    assert (edge > 0.98).all()  # no label is cut off


@pytest.mark.parametrize("suffix", [".pdf", ".svg"])
def test_a_figure_is_also_a_drawing(suffix: str, tmp_path) -> None:
    path = tmp_path / f"figure{suffix}"
    plots.figure(runner.run(grid()), path)
    assert path.read_bytes()[:5] in (b"%PDF-", b"<?xml")


def test_another_ending_is_refused(tmp_path) -> None:
    with pytest.raises(InputError, match=r"figure\.txt.*\.png, \.pdf, \.svg"):
        plots.figure(runner.run(grid()), tmp_path / "figure.txt")


def test_a_panel_shows_the_stored_numbers(angles) -> None:
    ax = plots.panel(angles, axes(), 0)
    drawn = np.vstack([points.get_offsets() for points in ax.collections if len(points.get_offsets()) == 9])
    np.testing.assert_allclose(drawn[:, 0], np.rad2deg(angles["beta"]))
    np.testing.assert_array_equal(drawn[:, 1], angles["turns"])


def test_a_panel_tells_the_verdict_and_marks_each_step_the_wrong_way(angles) -> None:
    holds, trend = plots.panel(angles, axes(), 0), plots.panel(angles, axes(), 1)
    assert "holds" in said(holds)
    assert "holds as a trend" in said(trend)
    assert holds.get_legend() is None
    (label,) = [text.get_text() for text in trend.get_legend().get_texts()]
    assert label == "a step the wrong way"
    row = check.verdicts(angles)[1]
    marked = [line.get_ydata().tolist() for line in trend.lines if line.get_linewidth() == 3]
    assert marked == [step["values"] for step in row["exceptions"]]


def test_a_panel_tells_what_became_of_the_other_observables_of_the_sentence(angles) -> None:
    for i, row in enumerate(check.verdicts(angles)):
        told = said(plots.panel(angles, axes(), i))
        for also in row["also"]:
            assert f"{style.short(angles[also['observable']])} {also['verdict']}" in told


def test_on_a_grid_the_deciding_line_stands_out_from_the_others(forces) -> None:
    ax = plots.panel(forces, axes(), 0)
    faint = [line for line in ax.lines if line.get_color() == style.FAINT]
    (strong,) = [line for line in ax.lines if line.get_color() == style.SOFT and len(line.get_xdata()) == 9]
    assert len(faint) == 9
    np.testing.assert_array_equal(strong.get_ydata(), forces["contact_mean"].sel(F3=10.0, method="nearest"))
    assert "F₃ = 10 N" in ax.get_xlabel()


def test_there_is_no_panel_for_a_law_that_is_not_there(angles) -> None:
    with pytest.raises(InputError, match="no law number 2: the study has 2"):
        plots.panel(angles, axes(), 2)
    with pytest.raises(InputError, match="'bends'"):
        plots.trend(angles, axes(), "bends", "beta")


def test_unrolled_curves_keep_their_shape_and_do_not_touch(angles) -> None:
    ax = plots.developed(angles, axes(), "beta")
    assert ax.get_aspect() == 1
    curves = [line for line in ax.lines if len(line.get_xdata()) == angles.sizes["u"]]
    assert len(curves) == 9
    for i, line in enumerate(curves):
        across, up = line.get_xdata(), line.get_ydata()
        np.testing.assert_allclose(up, angles["z"][i])
        np.testing.assert_allclose(across - across[0], angles["rho"] * (angles["alpha"][i] - angles["alpha"][i, 0]))
    for left, right in pairwise(curves):
        assert left.get_xdata().max() < right.get_xdata().min()
    assert [label.get_text() for label in ax.get_xticklabels()][::8] == ["15°", "60°"]
    assert ax.get_xlabel().endswith("β₀ [°]")


def test_an_unsolved_case_is_said_to_be_so() -> None:
    ds = runner.run(study("[axes.E]\nvalues = [1e4, 2e4, 4e4]\n", 'observables = ["kappa_mean"]'))
    for name in ("kappa_mean", "alpha", "z"):
        ds[name][1] = np.nan
    assert "unsolved" in said(plots.developed(ds, axes(), "E"))
    ax = plots.trend(ds, axes(), "kappa_mean", "E")
    assert "unsolved" in ax.get_legend_handles_labels()[1]


def test_lift_off_is_shaded_where_the_cylinder_would_have_to_pull() -> None:
    ds = runner.run(load("fig6"))
    assert (profile.pushes(ds) == ds["contact"].values).all()
    assert (profile.pushes(ds.assign_attrs(side="inside")) == -ds["contact"].values).all()
    labels = profile.contact(ds, axes()).get_legend_handles_labels()[1]
    assert any("lift off" in label for label in labels)


def test_where_a_law_decides_is_where_a_picture_is_taken(forces) -> None:
    for row in check.verdicts(forces):
        for name, value in row["at"].items():
            assert float(forces[name][picking.case(forces)[name]]) == pytest.approx(value)


def test_drawing_leaves_no_state_behind(tmp_path) -> None:
    import matplotlib

    before = dict(matplotlib.rcParams)
    plots.figure(runner.run(grid()), tmp_path / "figure.png")
    assert dict(matplotlib.rcParams) == before
    assert "matplotlib.pyplot" not in sys.modules or not sys.modules["matplotlib.pyplot"].get_fignums()


@pytest.mark.parametrize(
    ("value", "text"),
    [(5e3, "5000"), (6484.2, "6484"), (0.625, "0.625"), (1.0, "1"), (0.0, "0"), (2e6, "2e+06"), (1e-7, "1e-07"),
     (-3.14159, "-3.142"), (123456.0, "123500")],
)  # fmt: skip
def test_numbers_are_written_as_one_writes_them(value: float, text: str) -> None:
    assert style.number(value) == text
