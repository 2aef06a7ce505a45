"""The words of a view on the page of a scene."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Cell:
    """The words of a view.

    Attributes
    ----------
    caption
        Below it.
    why_empty
        Why there is no rod.
    before
        To the left of it.
    number, stable
        The number of an equilibrium, in a dot that says whether it is stable; default: no dot.
    """

    caption: str
    why_empty: str = ""
    before: str = ""
    number: int | None = None
    stable: bool = False
