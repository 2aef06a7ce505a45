"""Lines of numbers against an axis: where they have gaps, and the numbers of their ticks."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from tests.workbench import small
from workbench.figures import fonts
from workbench.figures.axis_scales import Ticks, set_scale
from workbench.figures.sheet import sheet
from workbench.figures.trends import draw_line, trend
from workbench.run import in_memory
from workbench.stored.stored_study import StoredStudy


def test_a_line_has_a_gap_where_a_number_begins_after_it_stayed_at_0() -> None:
    fig, ax = plt.subplots()
    draw_line(ax, np.arange(6.0), np.array([3.0, 2.0, 0.0, 0.0, 0.0, -1.0]), False)
    draw_line(ax, np.arange(3.0), np.array([1.0, 0.0, -1.0]), False)  # it passes 0
    gaps = [np.flatnonzero(np.isnan(line.get_xdata())).tolist() for line in ax.lines]
    plt.close(fig)
    assert gaps == [[2, 6], []]


def test_a_narrow_axis_has_three_numbers_where_these_have_room() -> None:
    found = []
    for ends, logarithmic, unit in (((5e3, 4e4), True, 1e3), ((2.5, 10.0), False, 1.0), ((2.5, 10.0), True, 1.0)):
        with rc_context(fonts.RC | sheet("paper", 89).settings()):
            ax = Figure(figsize=(1, 1)).add_axes((0.2, 0.2, 0.57, 0.6))
            set_scale(ax.xaxis, ends, logarithmic, 0.04)
            ax.xaxis.set_major_formatter(Ticks(unit))
            found.append([label.get_text() for label in ax.get_xticklabels()])
    assert found == [["5", "10", "40"], ["3", "6", "9"], ["3", "6", "10"]]


def test_evenly_spaced_numbers_leave_no_wide_part_of_a_logarithmic_axis_free() -> None:
    """Forces from 2.5 to 10 N had 4, 6, 8 and 10: a third of the axis lay before the first."""
    ax = Figure(figsize=(5, 2)).add_axes((0.1, 0.2, 0.8, 0.6))
    set_scale(ax.xaxis, (2.5, 10.0), True, 0.04)
    assert [label.get_text() for label in ax.get_xticklabels()] == ["3", "6", "10"]


def test_the_dark_line_of_a_grid_says_where_it_is_and_the_axis_does_not() -> None:
    """The label of the axis had "at F₃ = 10 N", which the pale lines beside it are not."""
    grid = small.axis("E", [1e4, 2e4, 4e4]) + small.axis("R", [0.8, 1.0, 1.2])
    for axes, key, held in ((grid, "R = 0.8 cm", ""), (small.axis("E", [1e4, 2e4]) + small.axis("R", [0.8]), "", "R")):
        stored = StoredStudy(in_memory.run(small.study(axes, 'observables = ["kappa_max"]')))
        ax = Figure(figsize=(5, 2)).add_axes((0.1, 0.2, 0.8, 0.6))
        trend(stored.trend("kappa_max", "E"), ax)
        named = [label for label in ax.get_legend_handles_labels()[1] if not label.startswith("_")]
        assert [label.partition(";")[0] for label in named] == [key] * bool(key)
        assert held in ax.get_xlabel()
        assert (" at R" in ax.get_xlabel()) == bool(held)


def test_ticks_have_one_power_of_ten_where_one_of_them_needs_it() -> None:
    assert Ticks().format_ticks([0.0, 5e-5, 1e-4, 1.5e-4]) == ["0", "0.5·10⁻⁴", "1.0·10⁻⁴", "1.5·10⁻⁴"]
    assert Ticks().format_ticks([-0.5, 0.0, 0.25]) == ["−0.50", "0.00", "0.25"]
