"""The letters and numbers of figures: large enough in print, one form in one picture, laws in symbols."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.text import Text

from solver.benchmark import ladders
from studies.language.loader import loads
from tests.workbench import small
from workbench.figures import (
    canvas,
    fonts,
    regions,
    study_figure,
)
from workbench.figures.sheet import sheet
from workbench.store import in_memory

FORMULA = "-8*pi**2*L**-2*cm + 0*bending_stiffness/(N*cm**3) + bowed**0.5/cm"
LAWS = (
    '[expressions]\nbowed = "kappa_max*rho"\n'
    + small.law("kappa_max", "E", claim="a", kind="equals", formula=FORMULA, absolute=9e9)
    + small.law("amplitude", "E", claim="b", kind="bounded", least=0.5)
)


@pytest.fixture(scope="module")
def judged() -> xr.Dataset:
    text = small.HEAD.replace("[units]", 'observables = ["amplitude", "turns", "wraps"]\n[units]')
    return in_memory.run(loads(f"{text}[axes.E]\nvalues = [1e4, 2e4]\n{LAWS}"))


def test_angles_are_in_degrees_on_every_axis(judged) -> None:
    ax = study_figure.figure(judged, sheet=sheet(panel="b")).axes[0]
    assert ax.get_ylabel() == "largest β minus smallest β [°]"
    drawn = next(line for line in ax.lines if len(line.get_xdata()) == 2)
    np.testing.assert_allclose(drawn.get_ydata(), np.degrees(judged["amplitude"].values))
    assert np.degrees(0.5) in [line.get_ydata()[0] for line in ax.lines]  # the bound
    assert judged["amplitude"].attrs["units"] == "rad"


def test_a_count_that_is_the_same_in_all_cases_is_a_sentence_and_no_panel(six) -> None:
    flag = (six["turns"] * 0 + 1).assign_attrs(long_name="1 where the rod intersects itself, else 0")
    level = six.assign(turns=six["turns"] * 0 + 3, overlaps=flag, met=flag * 0)
    level["met"].attrs = flag.attrs
    notes = study_figure.level_notes(level, ["overlaps", "met"])
    assert notes == ["The rod intersects itself in all cases.", "The rod intersects itself in no case."]
    fig = study_figure.figure(level, [])
    assert "number of bends" not in [ax.get_title(loc="left") for ax in fig.axes]
    assert any("Number of bends: 3 in all cases." in text.get_text() for text in fig.findobj(Text))
    alone = study_figure.figure(level, [], sheet(panel="turns"))
    assert len(alone.axes) == 1


def test_a_figure_without_a_title_has_no_room_for_one(six) -> None:
    tops = []
    for title in ("A title", ""):
        fig = canvas.figure((5, 3), lambda fig: fig.add_subplot(), six.assign_attrs(title=title))
        fig.draw_without_rendering()
        tops.append((1 - fig.axes[0].get_position().y1) * fig.get_figheight())
    assert tops[0] - tops[1] == pytest.approx(fonts.height_of("A title", fonts.LARGE), abs=0.02)  # one line


def test_no_two_methods_of_one_kind_of_problem_look_alike() -> None:
    looks = [(one.colour, one.marker, one.line) for one in ladders().values()]
    assert len({colour for colour, _, _ in looks}) == len(looks)
    for pair in (("verlet", "verlet extrapolated"), ("difference", "difference extrapolated")):
        first, second = (ladders()[name] for name in pair)
        assert first.marker != second.marker
        assert first.line != second.line


def test_regions_reach_to_their_curves_and_into_a_cusp() -> None:
    """A wedge between two lines that meet: a lattice of nine cells a side shows it as steps."""
    x, y = np.meshgrid(*2 * [(np.arange(9) + 0.5) / 9])
    coarse = np.where(np.abs(y - 0.5) < 0.4 * (x - 0.15), 1, 0)
    lines = [np.array([[0.15, 0.5], [1.2, 0.5 + sign * 0.42]]) for sign in (-1, 1)]
    fine = regions.fine(coarse, lines)
    rows, columns = (np.indices(fine.shape) + 0.5) / np.array(fine.shape)[:, None, None]
    true = np.abs(rows - 0.5) < 0.4 * (columns - 0.15)
    repeated = np.kron(coarse, np.ones(np.array(fine.shape) // 9, dtype=int))
    assert (fine == true).mean() > 0.995
    assert (repeated == true).mean() < 0.97


def test_regions_without_a_curve_between_them_stay_as_they_are_stored() -> None:
    coarse = np.array([[0, 0, 1, 1], [0, 0, 1, 1]])
    fine = regions.fine(coarse, [])
    np.testing.assert_array_equal(fine, np.kron(coarse, np.ones(np.array(fine.shape) // (2, 4), dtype=int)))
