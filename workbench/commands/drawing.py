"""The options of the commands that draw and export: plot, scene, animate, gallery and export."""

from pathlib import Path
from typing import Annotated

from .options import At, File, ForcePicture, Json, PixelError, argument, flag, numbered, option


def plot(
    file: File,
    out: Annotated[Path | None, option("FILE", "Picture, .png, .pdf or .svg; default: FILE.png.")] = None,
    dpi: Annotated[int, option("DPI", "Resolution of a .png [pixels/inch].", min=50, max=1200)] = 200,
    force: ForcePicture = False,
) -> int:
    """Draw the developed curves and observables of a stored study.

    Developed curves are the centrelines on the unrolled cylinder. Each law is drawn in the panel of its observable.
    """
    from .plot import plot_file

    plot_file(file, out, force, dpi)
    return 0


def scene(
    file: Annotated[
        Path,
        argument(
            "FILE|STUDY",
            "Stored study; or TOML file or name of a study, which is solved with the stations that the picture needs.",
        ),
    ],
    at: At = None,
    kind: Annotated[
        str | None,
        option(
            "KIND",
            "plain, contact, curvature, twist, ghosts, grid or equilibria; default: contact, or equilibria "
            "for a dataset of equilibria.",
        ),
    ] = None,
    axis: Annotated[list[str] | None, option("AXIS", "Axis shown by ghosts, or one or two axes shown by grid.")] = None,
    along: Annotated[
        str | None, option("AXIS", "Fit camera and colours to all cases along this axis, as animate does.")
    ] = None,
    low: Annotated[float | None, numbered("First arc length drawn [length]; default: 0.", "--from")] = None,
    high: Annotated[float | None, numbered("Last arc length drawn [length]; default: L.", "--to")] = None,
    pixel_error: PixelError = 0.5,
    dpi: Annotated[int, option("DPI", "Resolution [pixels/inch]; 200 gives 1600 x 1200 pixels for one case.")] = 200,
    out: Annotated[
        Path | None, option("FILE", "Picture, .png or .jpg; default: FILE_scene.png or FILE_scene_E=10905.png.")
    ] = None,
    force: ForcePicture = False,
) -> int:
    """Draw the rod on its cylinder in three dimensions.

    Exit status 1 if OpenGL does not work here, or if the file has too few stations for the pixel error.
    """
    from .scene import scene_file

    return scene_file(file, at or [], out, force, kind, axis, along, (low, high), pixel_error, dpi)


def animate(
    file: File,
    axis: Annotated[str | None, option("AXIS", "Axis of the film; required if the study has several.")] = None,
    at: At = None,
    kind: Annotated[str, option("KIND", "plain, contact, curvature or twist.")] = "contact",
    show: Annotated[
        str | None, option("OBSERVABLE", "Observable drawn beside the rod; default: that of the axis's first law.")
    ] = None,
    out: Annotated[
        list[Path] | None, option("FILE", "Film, .mp4 or .gif; repeatable; default: FILE_AXIS.mp4.", "--out", "-o")
    ] = None,
    fps: Annotated[float, numbered("Frames per second; each stored case is one frame.")] = 3.0,
    pixel_error: PixelError = 0.5,
    dpi: Annotated[int, option("DPI", "Resolution [pixels/inch]; 120 gives 1488 x 720 pixels.")] = 120,
    force: ForcePicture = False,
) -> int:
    """Make a film of the cases along an axis.

    Each frame shows the rod and, beside it, the curve of an observable up to that case. Nothing is solved.
    """
    from .animate import animate_file

    return animate_file(file, axis, at or [], kind, show, out or [], fps, pixel_error, dpi, force)


def gallery(
    out: Annotated[Path, option("FOLDER", "Folder for the pictures.")] = Path("gallery"), force: ForcePicture = False
) -> int:
    """Draw one picture of every kind of scene, as in docs/reference/scenes.md."""
    from .gallery import draw_all

    return draw_all(out, force)


def export(
    file: File,
    out: Annotated[
        Path,
        option("FILE", "File to write: .step .stl .obj .glb .gltf .vtp .csv.", "--out", "-o"),
    ],
    at: At = None,
    tolerance: Annotated[
        float | None,
        numbered("Largest distance between the file and the rod [length]; default: 1e-6 rho for .step, 1e-3 a for "
                 "meshes."),
    ] = None,
    centreline: Annotated[
        bool, flag("Write the centreline to STEP, without a solid.", "--centreline")
    ] = False,
    overlap: Annotated[
        bool, flag("Write a solid to STEP even if the rod intersects itself.", "--overlap")
    ] = False,
    force: Annotated[bool, flag("Replace an existing file.", "--force")] = False,
    json: Json = False,
) -> int:  # fmt: skip
    """Export one stored rod to CAD, mesh or table formats.

    Exit status 1 if the rod intersects itself or is bent tighter than its own radius.
    """
    from .export import export_file

    return export_file(file, at or [], out, tolerance, centreline, overlap, force, json)
