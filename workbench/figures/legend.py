"""Legends, each label once, and the sentences that belong to a figure: below it, or kept for its caption."""

from collections.abc import Iterable, Sequence
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from . import fonts
from .colours import SOFT
from .scales import RoomLocator, Ticks
from .sheet import SCREEN, Sheet


class _Kept(Artist):
    """Sentences that a figure carries and does not draw."""

    def __init__(self, texts: Sequence[str]) -> None:
        super().__init__()
        self.texts = list(texts)
        self.set_in_layout(False)

    def draw(self, renderer: Any) -> None:
        """Draw nothing."""


def keep(fig: Figure, texts: Sequence[str]) -> None:
    """Keep sentences for the caption of a figure."""
    if texts:
        fig.add_artist(_Kept(texts), clip=False)


def notes_of(fig: Figure) -> list[str]:
    """The sentences that a figure keeps, each once."""
    texts = [" ".join(text.split()) for artist in fig.artists if isinstance(artist, _Kept) for text in artist.texts]
    return list(dict.fromkeys(texts))


# The best place covers no middle of a point; a wide pad in place of the distance to the axes keeps it off whole points
PADDED = {"borderpad": 1.0, "borderaxespad": 0.0}
ALONE: dict[str, Any] = {"fontsize": 1, "borderpad": 3.2}  # of a legend of notes: its empty entry takes no room
HANDLE = 0.45  # inches of an entry beside its label


def add(ax: Axes, **where: Any) -> None:
    """The legend of what is drawn on the axes, none where nothing has a label; where: options of `Axes.legend`."""
    once = {str(entry.get_label()): entry for entry in entries(ax)}
    if once:
        ax.legend(list(once.values()), list(once), **{"loc": "best", **PADDED, **where})


def entries(ax: Axes) -> list[Any]:
    """The labelled artists of axes: lines and areas in their order, then marks."""
    return sorted(
        ax.get_legend_handles_labels()[0], key=lambda one: isinstance(one, Line2D) and one.get_linestyle() == "None"
    )


def below(fig: Figure, said: Iterable[str | Artist], sheet: Sheet = SCREEN) -> Legend | None:
    """One legend below all axes of a figure with a constrained layout: sentences, then entries in columns.

    On a sheet without a title the sentences are kept for the caption.
    """
    said = list(said)
    notes = [note for note in said if isinstance(note, str)]
    entries = [entry for entry in said if isinstance(entry, Artist)]
    if not sheet.titled:
        keep(fig, notes)
        notes = []
    width = fig.get_figwidth() - 0.3
    room = width - HANDLE
    once = {fonts.break_lines(str(entry.get_label()), room, fonts.small()): entry for entry in entries}
    notes = [fonts.break_lines(note, width, fonts.small()) for note in dict.fromkeys(notes)]
    if not once and not notes:
        return None
    lines = [line for label in once for line in label.split("\n")]
    widest = max((HANDLE + fonts.width_of(line, fonts.small()) for line in lines), default=1.0)
    columns = max(1, min(len(once), int((width + 0.1) / widest)))
    how: dict[str, Any] = {} if once else ALONE
    found = fig.legend(list(once.values()) or [Patch(visible=False)], list(once) or [""], ncols=columns,
                       loc="outside lower left", title="\n".join(notes), alignment="left", handlelength=1.8,
                       handleheight=1.2, title_fontsize=fonts.small(), **how)  # fmt: skip
    found.get_title().set_color(SOFT)
    return found


def colour_bar(beside: Sequence[Axes], colours: ScalarMappable, label: str = "", **where: Any) -> Colorbar:
    """The bar of a scale of colours beside axes, with a name in small letters; where: options of `Figure.colorbar`."""
    fig = beside[0].get_figure(root=True)
    assert fig is not None
    bar = fig.colorbar(colours, **{} if "cax" in where else {"ax": list(beside)}, **where)  # type: ignore[arg-type]
    bar.set_label(label, size=fonts.small())
    bar.outline.set_visible(False)
    bar.ax.tick_params(length=2)
    if "ticks" not in where:
        bar.locator, bar.formatter = RoomLocator(), Ticks()
    bar.minorticks_off()
    return bar
