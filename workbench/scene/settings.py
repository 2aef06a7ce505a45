"""How a scene is drawn, whatever it shows. No OpenGL."""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import TypeVar

from solver.problem.errors import InputError, no_such

from ..figures import colours, fonts
from .views import views_of

Number = TypeVar("Number", int, float)
PICTURES = (".png", ".jpg")  # the suffixes of pictures of scenes
DPIS = (50, 600)
SIDES = (200, 12_000)  # pixels of a page's width and height
MOST_PIXELS = 40_000_000


@dataclass(frozen=True)
class Settings:
    """How a scene is drawn.

    Attributes
    ----------
    pixel_error
        The error allowed of the drawn surface in pixels.
    dpi
        Pixels per inch of the picture.
    span
        The arc lengths between which the rod is drawn [length], the second infinite for its end; default: all of it.
    strict
        Raise `TooFewStations` where the stations do not allow the pixel error; default: draw as well as they allow.
    camera
        A name of `views.CAMERAS`, or azimuth and elevation in degrees; default: oblique where one case is shown, else
        from the front and a little above.
    color_range
        The values at the ends of the colour bar; default: those that the rods have.
    titled
        With the title, the case and the notes, which else are in the caption.
    bare
        The views alone, without words and bars.
    transparent
        Without background.
    size
        Width and height of the picture in pixels; default: as high as its content.
    samples
        Along each side of a pixel.
    theme
        A name of `colours.THEMES`, whose background there is without `background`; default: light.
    background
        ``#rrggbb``, from which words and lines stand out; default: that of the theme.
    color
        ``#rrggbb`` of the rods, of a kind in one colour.
    """

    pixel_error: float = 0.5
    dpi: int = fonts.DPI
    span: tuple[float, float] | None = None
    strict: bool = False
    camera: str | None = None
    color_range: tuple[float, float] | None = None
    titled: bool = True
    bare: bool = False
    transparent: bool = False
    size: tuple[int, int] | None = None
    samples: int = 4
    theme: str | None = None
    background: str | None = None
    color: str | None = None

    @property
    def is_end_view(self) -> bool:
        """Whether rods are seen along the axis."""
        return self.camera == "end"

    @property
    def look(self) -> dict[str, str]:
        """The colours in place of those of the theme light: of the background, of words and of lines."""
        background = self.background or colours.THEMES[self.theme or "light"][0]
        return dict(zip(colours.THEMES["light"], colours.theme_with(background), strict=True))


DEFAULT = Settings()


def check(settings: Settings) -> None:
    """Raise `InputError` for an invalid value."""
    if not 0.01 <= settings.pixel_error <= 10:
        raise InputError(f"--pixel-error must be between 0.01 and 10 pixels, got {settings.pixel_error:g}")
    if not DPIS[0] <= settings.dpi <= DPIS[1]:
        raise InputError(f"--dpi must be between {DPIS[0]} and {DPIS[1]}, got {settings.dpi}")
    views_of(settings.camera)
    if settings.theme is not None and settings.theme not in colours.THEMES:
        raise no_such("theme", settings.theme, colours.THEMES)
    if settings.background is not None and settings.transparent:
        raise InputError("--background and --transparent exclude each other")
    if settings.color_range and not -inf < settings.color_range[0] < settings.color_range[1] < inf:
        low, high = settings.color_range
        raise InputError(f"--color-range takes a lower and a higher finite number, got {low:g},{high:g}")
    if settings.size and (
        not all(SIDES[0] <= side <= SIDES[1] for side in settings.size)
        or settings.size[0] * settings.size[1] > MOST_PIXELS
    ):
        wide, high = settings.size
        raise InputError(
            f"--size must have between {SIDES[0]} and {SIDES[1]} pixels on each side and at most {MOST_PIXELS} in all, "
            f"got {wide}x{high}"
        )


def color_of(option: str, text: str | None) -> str | None:
    """A colour as ``#rrggbb``, of that form or a name of CSS. Raises `InputError`, also for one that is transparent."""
    from matplotlib.colors import is_color_like, to_hex, to_rgba

    if text is None:
        return None
    if not is_color_like(text) or to_rgba(text)[3] < 1:
        raise InputError(f"{option} takes an opaque colour, such as '#14181e' or navy, got {text!r}")
    return to_hex(text)


def check_name(path: Path, settings: Settings) -> None:
    """Raise `InputError` where a file of that name cannot hold the picture."""
    if settings.transparent and path.suffix.lower() != ".png":
        raise InputError(f"only a .png can have a transparent background (--transparent), not {path.name}")


def pair_of(
    text: str | None, between: str, number: Callable[[str], Number], takes: str
) -> tuple[Number, Number] | None:
    """The two numbers of an option. Raises `InputError`; takes: the option and what it takes."""
    if text is None:
        return None
    try:
        first, second = map(number, text.lower().split(between))
    except ValueError:
        raise InputError(f"{takes}, got {text!r}") from None
    return first, second
