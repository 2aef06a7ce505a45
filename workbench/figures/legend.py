"""Legends: each label once, however many artists carry it."""

from collections.abc import Sequence
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from . import notes as notes_of_figures
from . import style
from .sheet import SCREEN, Sheet
from .style import SOFT

# The best place covers no middle of a point; a wide pad in place of the distance to the axes keeps it off whole points
PADDED = {"borderpad": 1.0, "borderaxespad": 0.0}
HANDLE = 0.45  # inches of an entry beside its label


def add(ax: Axes, **where: Any) -> None:
    """The legend of what is drawn on the axes, none where nothing has a label; where: options of `Axes.legend`."""
    handles, labels = ax.get_legend_handles_labels()
    once = dict(zip(labels, handles, strict=True))
    if once:
        ax.legend(list(once.values()), list(once), **{"loc": "best", **PADDED, **where})


def below(fig: Figure, entries: Sequence[Artist], notes: Sequence[str] = (), sheet: Sheet = SCREEN) -> None:
    """One legend below all axes of a figure with a constrained layout: notes as text, then its entries in columns.

    On a sheet without a title the notes are kept for the caption.
    """
    if not sheet.titled:
        notes_of_figures.keep(fig, notes)
        notes = ()
    once = {str(entry.get_label()): entry for entry in entries}
    notes = [style.fitted(note, fig.get_figwidth() - 0.3, style.small()) for note in dict.fromkeys(notes)]
    if not once and not notes:
        return
    widest = max((HANDLE + style.width_of(label, style.small()) for label in once), default=1.0)
    columns = max(1, min(len(once), int((fig.get_figwidth() - 0.2) / widest)))
    found = fig.legend(list(once.values()) or [Patch(visible=False)], list(once) or [""], loc="outside lower left",
                       ncols=columns, title="\n".join(notes), alignment="left", handlelength=1.8, handleheight=1.2,
                       title_fontsize=style.small())  # fmt: skip
    found.get_title().set_color(SOFT)
