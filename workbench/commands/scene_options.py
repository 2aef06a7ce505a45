"""The options of the command scene: one record, of which pictures, pages and films each take their part."""

from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from .options import At, ForceOutput, NoTitle, PixelError, flag, number_option, option

if TYPE_CHECKING:
    from ..scene.settings import Settings


FLAGS = {"low": "--from", "high": "--to"}  # of options that are not written as they are named
# not of pages, nor of branches
OF_PICTURE = ("low", "high", "camera", "color_range", "no_title", "bare", "transparent", "size")
OF_FILM = ("stored", "show", "fps", "frames")


@dataclass(frozen=True)
class SceneOptions:
    """What `scene` is asked to draw, and how."""

    at: At = None
    kind: Annotated[
        str | None,
        option(
            "KIND",
            "plain: in one colour; contact, curvature: in its colours; twist: with a stripe; double-helix: as DNA; "
            "ghosts: rods of an axis on one cylinder; grid: each in its own view; equilibria; let-go: a rod on the "
            "cylinder and let go; of branches: branches, the stable rods below their diagram, or snap, a film of a "
            "rod whose load changes until it snaps; default: contact, or as suits the file.",
        ),
    ] = None
    axis: Annotated[
        list[str] | None, option("AXIS", "Axis shown by ghosts or grid; two axes of a grid: --axis E --axis R.")
    ] = None
    along: Annotated[
        str | None, option("AXIS", "Axis along which the pictures of all cases have the same camera and colour scale.")
    ] = None
    low: Annotated[float | None, number_option("First arc length drawn [length]; default: 0.", "--from")] = None
    high: Annotated[float | None, number_option("Last arc length drawn [length]; default: L.", "--to")] = None
    pixel_error: PixelError = 0.5
    dpi: Annotated[int | None, option("DPI", "Resolution [pixels/inch]; default: 200, of a film 160.")] = None
    camera: Annotated[
        str | None,
        option(
            "CAMERA",
            "oblique, front, side, end (along the axis), AZIMUTH,ELEVATION in degrees, or sides, two views of one "
            "case; default: oblique for one case, else 0,12.",
        ),
    ] = None
    color_range: Annotated[
        str | None, option("LOW,HIGH", "Values at the ends of the colour bar; default: the extremes of the rods.")
    ] = None
    size: Annotated[
        str | None,
        option("WIDTHxHEIGHT", "Size in pixels; default: as high as what a picture shows, of a film 1280x720."),
    ] = None
    no_title: NoTitle = False
    bare: Annotated[bool, flag("Draw the views alone: no words, no bars.", "--bare")] = False
    transparent: Annotated[bool, flag("Leave the background transparent (.png).", "--transparent")] = False
    theme: Annotated[
        str | None,
        option("THEME", "light or dark: the background unless --background is given; words stand out from it."),
    ] = None
    background: Annotated[str | None, option("COLOUR", "Colour of the background, such as '#14181e' or navy.")] = None
    color: Annotated[str | None, option("COLOUR", "Colour of the rods, of the kind plain.")] = None
    show: Annotated[
        str | None, option("OBSERVABLE", "Observable drawn beside a film; default: that of the axis's first law.")
    ] = None
    fps: Annotated[float | None, number_option("Frames per second of a film; default: 24.")] = None
    frames: Annotated[
        int | None,
        option(
            "NUMBER",
            "Frames of a film, no more and no fewer, as pictures too, frame_{:03d}.png; default: as many as let the "
            "rod move smoothly, with the first and the last for half a second more.",
        ),
    ] = None
    stored: Annotated[bool, flag("Film the stored cases alone, each for a third of a second.", "--stored")] = False
    out: Annotated[
        Path | None,
        option(
            "FILE",
            "Picture, .png or .jpg; frame_{:03d}.png: a picture for each value of --along or of the axis that --at "
            "does not name; .html, an offline page with all cases that --at leaves, in which the rod turns, of rods "
            "that lie on the cylinder without weight and friction; "
            ".mp4, .webp or .gif, a film of the cases along the axis, or along --along, or of a rod let go; "
            "default: FILE_scene.png or FILE_scene_E=10905.png.",
            "--out",
            "-o",
        ),
    ] = None
    force: ForceOutput = False

    @property
    def axes(self) -> list[str]:
        """The axes of ghosts or of a grid, or of a film."""
        return self.axis or []

    def flags_of(self, *names: str) -> list[str]:
        """The flags of those of these options that the user gave, as on the command line."""
        values = {name: getattr(self, name) for name in names}
        named = [name for name, value in values.items() if not (value is None or value is False or value == [])]
        return [FLAGS.get(name, f"--{name.replace('_', '-')}") for name in named]

    def settings(self, dpi: int = 200) -> "Settings":
        """How it is drawn; dpi: where none was given. Raises `InputError` for an invalid option."""
        from ..scene.settings import Settings, check, color_of, pair_of

        settings = Settings(
            pixel_error=self.pixel_error,
            dpi=self.dpi or dpi,
            span=None if self.low is self.high is None else (self.low or 0.0, inf if self.high is None else self.high),
            camera=self.camera,
            color_range=pair_of(self.color_range, ",", float, "--color-range takes two numbers LOW,HIGH"),
            titled=not self.no_title,
            bare=self.bare,
            transparent=self.transparent,
            size=pair_of(self.size, "x", int, "--size takes WIDTHxHEIGHT in pixels, for example 1600x1200"),
            theme=self.theme,
            background=color_of("--background", self.background),
            color=color_of("--color", self.color),
        )
        check(settings)
        return settings

    @property
    def has_film_pictures(self) -> bool:
        """Whether the frames of a film are asked for as pictures, each a file."""
        return self.frames is not None and self.out is not None and "{" in self.out.name
