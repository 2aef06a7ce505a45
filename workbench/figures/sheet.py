"""The sheet that a figure is drawn for: its width, the sizes of its letters, and whether the title stands on it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from solver.problem.errors import InputError, check_known, no_such

from .fonts import LARGE, NORMAL, SMALL

MILLIMETRES = 25.4  # of an inch
NARROWEST, WIDEST = 60.0, 500.0  # millimetres
ONE_COLUMN = 6.0  # inches: on a narrower sheet panels stand one below the other
STYLES = {"screen": (NORMAL, SMALL, LARGE), "paper": (8.0, 7.0, 9.5)}  # points


@dataclass(frozen=True)
class Sheet:
    """A sheet.

    Attributes
    ----------
    width : float
        Inches.
    style : str
        A name of `STYLES`, which gives the sizes of the letters.
    titled : bool
        Whether the title of the study stands above the figure.
    panel : str, optional
        The one panel that is drawn; default: all.
    ranges : dict
        The lowest and the highest value of the vertical axis of observables, in the units of their labels; default:
        all that is drawn.
    """

    width: float = 9.6
    style: str = "screen"
    titled: bool = True
    panel: str | None = None
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def normal(self) -> float:
        """Points of ordinary letters."""
        return STYLES[self.style][0]

    @property
    def small(self) -> float:
        """Points of small letters."""
        return STYLES[self.style][1]

    @property
    def narrow(self) -> bool:
        """Whether panels stand one below the other."""
        return self.width < ONE_COLUMN

    def choose(self, panels: Iterable[str]) -> list[str]:
        """Which of the panels of a figure are drawn. Raises `InputError` for a panel that it has not."""
        if self.panel is not None and self.panel not in (known := list(panels)):
            raise no_such("panel", self.panel, known)
        return list(panels) if self.panel is None else [self.panel]

    def settings(self) -> dict[str, Any]:
        """Matplotlib's settings of the letters."""
        normal, small, large = STYLES[self.style]
        sizes = {"font.size": normal, "axes.titlesize": normal, "axes.labelsize": normal, "figure.titlesize": large}
        return sizes | dict.fromkeys(("xtick.labelsize", "ytick.labelsize", "legend.fontsize"), small)


SCREEN = Sheet()
COLUMN = Sheet(89 / MILLIMETRES, "paper", titled=False)  # of a page, and a telephone


def set_range(sheet: Sheet, ax: Any, name: str) -> None:
    """Set the range of the vertical axis of an observable, where the sheet has one."""
    if name in sheet.ranges:
        ax.set_ylim(*sheet.ranges[name])


def sheet(style: str = "screen", width: float | None = None, titled: bool = True, panel: str | None = None) -> Sheet:
    """The sheet of a style and a width in millimetres; default: 183 for paper, 244 for the screen.

    Raises `InputError` for an unknown style and for a width that no figure fits.
    """
    check_known("style", style, STYLES)
    if width is None:
        width = 183 if style == "paper" else SCREEN.width * MILLIMETRES
    if not NARROWEST <= width <= WIDEST:
        raise InputError(f"the width must be from {NARROWEST:g} to {WIDEST:g} mm, got {width:g}")
    return Sheet(width / MILLIMETRES, style, titled, panel)
