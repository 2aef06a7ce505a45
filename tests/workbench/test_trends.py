"""Lines of numbers against an axis: where they have gaps, and the numbers of their ticks."""

import matplotlib.pyplot as plt
import numpy as np

from workbench.figures.axis_scales import Ticks
from workbench.figures.trends import draw_line


def test_a_line_has_a_gap_where_a_number_begins_after_it_stayed_at_0() -> None:
    fig, ax = plt.subplots()
    draw_line(ax, np.arange(6.0), np.array([3.0, 2.0, 0.0, 0.0, 0.0, -1.0]), False)
    draw_line(ax, np.arange(3.0), np.array([1.0, 0.0, -1.0]), False)  # it passes 0
    gaps = [np.flatnonzero(np.isnan(line.get_xdata())).tolist() for line in ax.lines]
    plt.close(fig)
    assert gaps == [[2, 6], []]


def test_ticks_have_one_power_of_ten_where_one_of_them_needs_it() -> None:
    assert Ticks().format_ticks([0.0, 5e-5, 1e-4, 1.5e-4]) == ["0", "0.5·10⁻⁴", "1.0·10⁻⁴", "1.5·10⁻⁴"]
    assert Ticks().format_ticks([-0.5, 0.0, 0.25]) == ["−0.50", "0.00", "0.25"]
