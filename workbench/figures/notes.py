"""The sentences that belong to a figure and not to a panel: below it, or kept for its caption.

A figure without a title has none of them on it; `kept` returns them, for the terminal and the table of its numbers.
"""

from collections.abc import Sequence
from typing import Any

from matplotlib.artist import Artist
from matplotlib.figure import Figure


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


def kept(fig: Figure) -> list[str]:
    """The sentences that a figure keeps, each once."""
    texts = [" ".join(text.split()) for one in fig.artists if isinstance(one, _Kept) for text in one.texts]
    return list(dict.fromkeys(texts))
