"""The options of the command scene: one record, of which pictures, pages and films each take their part."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from .options import At, ForceOutput, PixelError, flag, number_option, option


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
    dpi: Annotated[
        int | None,
        option("DPI", "Resolution [pixels/inch]; default: 200, 1600 pixels of width for one case; of a film 160."),
    ] = None
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
        str | None, option("WIDTHxHEIGHT", "Size of the picture in pixels; default: as high as what it shows.")
    ] = None
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
            "Frames of a film, no more and no fewer; default: as many as let the rod move smoothly, with "
            "the first and the last for half a second more.",
        ),
    ] = None
    stored: Annotated[bool, flag("Film the stored cases alone, each for a third of a second.", "--stored")] = False
    out: Annotated[
        Path | None,
        option(
            "FILE",
            "Picture, .png or .jpg; frame_{:03d}.png: a picture for each value of --along or of the axis that --at "
            "does not name; .html, an offline page with all cases that --at leaves, in which the rod turns; "
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

    @property
    def of_picture(self) -> list[str]:
        """The options for pictures alone that were given."""
        given = {
            "--from": self.low is not None,
            "--to": self.high is not None,
            "--camera": self.camera is not None,
            "--color-range": self.color_range is not None,
            "--bare": self.bare,
            "--transparent": self.transparent,
            "--size": self.size is not None,
        }
        return [name for name, is_given in given.items() if is_given]

    @property
    def of_film(self) -> tuple[bool, ...]:
        """Whether each option for films alone was given."""
        return self.stored, self.show is not None, self.fps is not None, self.frames is not None
