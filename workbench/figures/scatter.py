"""The figure of samples: each observable against each sampled field, with the rank correlation of the two."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from solver.problem.errors import InputError
from studies.grammar.axes import SAMPLE

from ..stored.stored_study import StoredStudy
from ..words import labels
from . import canvas, colours, fonts, print_heights
from .axis_scales import SPARE, RoomLocator, Ticks, set_scale
from .map_panel import DENSE
from .sheet import SCREEN, Sheet
from .trends import UNBENT, Values, mark_missing

ROW_HEIGHT, LEAST_WIDTH, TALLEST = 2.1, 1.7, 6.7  # inches of a panel; of all
NARROW_ROW, LEAST_PANEL, BESIDE = 1.25, 0.85, 0.75  # on a narrow sheet; inches of a panel at least; of ticks and label
BETWEEN = 0.25  # inches between two rows of panels
MORE = 0.3, 0.8  # inches of the figure: below its panels, and beside them
FEW, MANY = 300, 4000  # samples up to which a dot is large, and beyond which the density is drawn
SHORT, LONG = 1.2, 1e4  # inches of a panel, on which numbers from so large on are written in thousands
LEAST = 8  # samples of which a rank correlation says something
BINS = (90, 60)  # of the density


def figure(stored: StoredStudy, show: Sequence[str] = (), sheet: Sheet = SCREEN) -> Figure:
    """Draw each observable against each sampled field.

    Beside samples the study may have axes: they are held where the laws or Table 1 put them. Each panel says the rank
    correlation (Spearman) of its two quantities, over the samples that have a number; not where a refinement chose the
    cases. Bends of nearly straight rods are left out, as of a map. In print the caption names the observables that have
    no room.

    Parameters
    ----------
    stored : StoredStudy
    show
        Observables; default: all.
    sheet : Sheet
        What the figure is drawn for. Its panel is an observable.

    Raises
    ------
    InputError
        For a study without samples or observables, an observable that is not stored, and an unknown panel.
    """
    known = stored.observables
    if SAMPLE not in stored.varied or not known:
        raise InputError("the kind samples draws the observables of samples, and the file has none")
    every = stored.names_of_figure(show) if show else sheet.choose(known)

    def draw(count: int) -> Figure:
        is_wide = sheet.style == SCREEN.style and not sheet.narrow
        width = max(sheet.width, LEAST_WIDTH * len(stored.sampled) + MORE[1]) if is_wide else sheet.width
        rows, sentence = _rows(stored, every[:count], width, sheet.narrow)
        said = [sentence, *canvas.say_left_out(every[count:], "--show or --panel")]
        return canvas.page(stored, sheet, rows, said, MORE[0], width=width)

    is_whole = sheet.panel is not None or bool(show) or sheet.style != "paper"
    return draw(len(every)) if is_whole else print_heights.with_room(draw, len(every))


def _rows(stored: StoredStudy, names: Sequence[str], width: float, narrow: bool) -> tuple[list[canvas.Row], str]:
    """The rows of panels of a figure of so many inches, and a sentence about them."""
    held = {axis: i for axis, i in stored.place().items() if axis != SAMPLE}
    every, most, high = (
        stored.sampled,
        max(int((width - BESIDE) / LEAST_PANEL), 1),
        NARROW_ROW if narrow else ROW_HEIGHT,
    )
    most = -(-len(every) // -(-len(every) // most))  # as many in each row
    blocks = [every[i : i + most] for i in range(0, len(every), most)]
    whole = min(len(blocks) * (high * len(names) + 0.5), max(TALLEST, 1.1 * len(blocks) * len(names)))
    across = len(blocks[0])
    tall, room = whole / len(names) / len(blocks), (width - BESIDE) / across - 0.1

    def draw(name: str, field: str, fields: list[str], ax: Axes) -> list[str]:
        ax.set_label(f"{name} against {field}")
        _draw_samples(stored.select(held), ax, name, field, room)
        ax.tick_params(labelleft=field == fields[0], labelbottom=name == names[-1])
        if name == names[-1]:
            label = fonts.fit_label(partial(labels.axis_label, stored[field]), room)
            written = ax.xaxis.get_major_formatter()
            ax.set_xlabel(label.replace("[", "[10³ ") if isinstance(written, Ticks) and written.unit > 1 else label)
        if field != fields[0]:
            return []
        ax.set_ylabel(fonts.fit_label(partial(labels.label, stored[name]), tall - BETWEEN, most=3))
        clause = labels.long_name(stored[name]).partition(", ")[2]
        is_lost = clause and ax.get_ylabel() == labels.label(stored[name])  # of a short label
        return [labels.sentence(f"{labels.symbol(stored[name])}: {clause}")] * bool(is_lost)

    rows = [
        row
        for fields in blocks
        for name in names
        for row in canvas.in_rows([partial(draw, name, field, fields) for field in fields], across, tall)
    ]
    count, at = stored.sizes[SAMPLE], stored.equations(held)
    dense = "; the darker, the more samples" if count > MANY else ""
    known = DENSE if stored.is_refined else "; r: rank correlation"
    said = f"{count} sample{'s' * (count != 1)}{f', at {at}' if at else ''}{known}{dense}."
    return rows, said + f" {UNBENT}" * any(bool(stored.select(held).unbent(name).any()) for name in names)


def _draw_samples(stored: StoredStudy, ax: Axes, name: str, field: str, room: float) -> None:
    """One observable against one field, on a panel of so many inches."""
    x, y = (labels.in_label_unit(stored[key], stored[key].values) for key in (field, name))
    straight, solved = stored.unbent(name).values, stored["solved"].values
    known = np.isfinite(y) & ~straight
    logarithmic = stored.is_logarithmic(field)
    set_scale(ax.xaxis, (float(x.min()), float(x.max())), logarithmic, SPARE)
    if room < SHORT and x.max() >= LONG and "[" in labels.axis_label(stored[field]):
        ax.xaxis.set_major_formatter(Ticks(1e3))
    if known.sum() > MANY:
        _density(ax, x[known], y[known], logarithmic)
    else:
        size, alpha = (16, 0.75) if x.size <= FEW else (5, 0.45)
        area = size * min(room / ROW_HEIGHT, 1.0) ** 2
        ax.scatter(x[known], y[known], s=area, color=colours.DATA, alpha=alpha, linewidths=0, zorder=3)
    mark_missing(ax, x, known | straight, solved, markersize=4, rasterized=x.size > MANY)
    if not stored.is_refined and (r := rank_correlation(x[known], y[known])) is not None:
        ax.set_title(f"r = {r:+.2f}".replace("-", "−"), loc="right", size=fonts.small(), color=colours.SOFT, pad=2)
    ax.yaxis.set_major_locator(RoomLocator("counts" if name in stored.counts else "numbers"))
    ax.margins(y=0.12)


def rank_correlation(x: Values, y: Values) -> float | None:
    """Spearman's rank correlation; None for fewer than `LEAST` samples, or where one of the two is constant."""
    from scipy.stats import rankdata

    if x.size < LEAST or np.ptp(x) == 0 or np.ptp(y) == 0:
        return None
    return float(np.corrcoef(rankdata(x), rankdata(y))[0, 1])


def _density(ax: Axes, x: Values, y: Values, logarithmic: bool) -> None:
    """How many samples lie where, on a logarithmic scale of colours: dots would hide one another."""
    space = np.geomspace if logarithmic else np.linspace
    spare = 0.01 * (float(np.ptp(y)) or abs(float(y[0])) or 1.0)
    bins: Any = [space(x.min(), x.max(), BINS[0] + 1), np.linspace(y.min() - spare, y.max() + spare, BINS[1] + 1)]
    ax.hist2d(x, y, bins, cmin=1, cmap=colours.COUNTS, norm=LogNorm(0.3), rasterized=True, zorder=3)
    ax.use_sticky_edges = False
