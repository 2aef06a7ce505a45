"""The edge around words and lines that stand on a picture."""

from typing import Self

from matplotlib.patheffects import withStroke

from .colours import THEMES


class Halo(withStroke):
    """An edge in the colour of the background; width: points, on both sides together. alpha: its opacity."""

    def __init__(self, width: float, alpha: float = 1.0, background: str = THEMES["light"][0]) -> None:
        super().__init__(linewidth=width, foreground=background, alpha=alpha)
        self.width, self.alpha, self.background = width, alpha, background

    def on(self, background: str) -> Self:
        """An edge of this width and opacity in the colour of another background."""
        return type(self)(self.width, self.alpha, background)
