"""How everything drawn looks: colours, sizes, and how numbers and units are written."""

import re
from collections.abc import Mapping
from math import degrees, floor, log10
from textwrap import fill
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, ListedColormap, to_hex
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from solver.problem.errors import InputError
from solver.problem.quantities import quantity
from studies.axes import quantity_of
from studies.laws import FAILS, HOLDS, QUALIFIED, TREND, UNDECIDED

# Okabe and Ito: told apart under every common colour blindness, and in grey
PUSHED = "#0072b2"  # where the cylinder pushes
LIFTED = "#e69f00"  # where it would have to pull
UNPAINTED = "#d9c9a3"  # the rod beside its stripe
SURFACE = "#e3e6ea"  # the cylinder
INK, SOFT, FAINT = "#1c2430", "#5b6675", "#d5dae1"
# each 4.5 : 1 on white, and told apart under each kind of colour blindness
VERDICT_COLOURS = {HOLDS: "#01834e", TREND: "#1b4cc8", QUALIFIED: "#bb5802", UNDECIDED: "#6d727c", FAILS: "#8a050f"}
STABLE = "#b3261e"  # the stable ones among all equilibria

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
RAMP = colormaps["viridis"]
PUSH_RAMP = ListedColormap(RAMP(np.linspace(0, 0.6, 256)), "push")  # ends before it comes near the colour of lift-off
RAMP_ENDS = (0.0, 0.88)  # the last yellow is too light on white

DPI = 200
SMALL, NORMAL, LARGE = 8.0, 9.5, 12.0  # points
LETTER, BOLD = 0.6 / 72, 1.12  # inches that a letter is wide per point of its size; how much wider a bold one is

RC: Any = {
    "font.family": "DejaVu Sans",  # comes with Matplotlib
    "font.size": NORMAL,
    "axes.titlesize": NORMAL,
    "axes.labelsize": NORMAL,
    "axes.edgecolor": SOFT,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.color": INK,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "xtick.labelsize": SMALL,
    "ytick.labelsize": SMALL,
    "legend.frameon": False,
    "legend.fontsize": SMALL,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "figure.dpi": DPI,
    "savefig.dpi": DPI,
    "pdf.fonttype": 42,
    "mathtext.default": "regular",
    "text.parse_math": False,  # a title may come from anyone, and has its $ as they are
}


def number(value: float, digits: int = 4) -> str:
    """A number as one would write it: ``10910``, ``0.625``, ``2e+06``; exponents only where they shorten it."""
    if value == 0 or not abs(value) < float("inf"):
        return f"{value:g}"
    power = floor(log10(abs(value)))
    if not -4 <= power <= 5:
        return f"{value:.{digits}g}"
    text = f"{round(value, digits - 1 - power):.{max(digits - 1 - power, 0)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def unit(text: str) -> str:
    """``N/cm^2`` as ``N/cm²``; nothing for a plain number."""
    return "" if text == "1" else text.replace("^2", "²").replace("^3", "³").replace("^4", "⁴")


def is_angle(array: xr.DataArray) -> bool:
    """Whether it is shown in degrees."""
    return array.attrs.get("units") == "rad"


def shown(value: float, array: xr.DataArray, digits: int = 4) -> str:
    """A value of an axis with its unit, angles in degrees: ``10910 N/cm²``, ``15°``."""
    if is_angle(array):
        return f"{number(degrees(value), digits)}°".replace("-", "−")
    return f"{number(value, digits)} {unit(str(array.attrs.get('units', '1')))}".strip().replace("-", "−")


def symbol(axis: str) -> str:
    """The letter of an axis; `beta` as an axis is the angle at the start."""
    return quantity_of(axis).symbol


def axis_label(name: str, array: xr.DataArray, long: bool = True) -> str:
    """``Young's modulus  E [N/cm²]``, or ``E [N/cm²]``; angles in degrees."""
    text = f"{words(array)}  " if long else ""
    return f"{text}{symbol(name)}{_bracketed('°' if is_angle(array) else unit(str(array.attrs.get('units', '1'))))}"


def label(array: xr.DataArray) -> str:
    """``mean κ [1/cm]``: symbol and unit of a stored variable."""
    return f"{short(array)}{_bracketed(unit(str(array.attrs.get('units', '1'))))}"


def short(array: xr.DataArray) -> str:
    """The symbol of a stored variable, or its name."""
    return str(array.attrs.get("symbol", array.name))


def words(array: xr.DataArray) -> str:
    """The long name of a stored variable, without what stands in brackets."""
    return typeset(str(array.attrs.get("long_name", array.name)).partition(" (")[0])


def typeset(text: str) -> str:
    """Plain words with the letters of physics: ``beta'(0) = -1 rad (5 deg)`` as ``β′(0) = −1 rad (5°)``."""
    for plain, letters in ((r"\bbeta'", "β′"), (r"\bbeta\b", "β"), (r"\bkappa\b", "κ"), (r"(?<=\d) deg\b", "°")):
        text = re.sub(plain, letters, text)
    return minus(text)


def reason(row: Mapping[str, Any], text: str) -> str:
    """What is said of a law (a row of `check.verdicts`), with symbols for the names of its observables and axes."""
    letters = {one["observable"]: quantity(one["observable"]).symbol for one in (row, *row.get("also", ()))}
    letters |= {axis: symbol(axis) for axis in (row.get("axis"), *row["at"]) if axis}
    return typeset(re.sub(r"\w+", lambda word: letters.get(word[0], word[0]), text))


def minus(text: str) -> str:
    """Hyphens before numbers as minus signs."""
    return re.sub(r"(?<![\w.])-(?=[\d.])", "−", text)


def reading(ds: xr.Dataset) -> str:
    """The reading in words, or nothing."""
    text = str(ds.attrs.get("reading", ""))
    return f"Table 1 read {text.replace('/', ', ')}" if text else ""


def colours(count: int) -> list[Any]:
    """So many colours along the ramp."""
    low, high = RAMP_ENDS
    return [RAMP(low + (high - low) * i / max(count - 1, 1)) for i in range(count)]


def hex_of(ramp: Colormap, share: float) -> str:
    """A colour of a ramp as ``#rrggbb``."""
    return to_hex(ramp(share))


def ramp_part() -> Colormap:
    """The ramp as far as it is used on white."""
    return ListedColormap(RAMP(np.linspace(*RAMP_ENDS, 256)), "ramp")


def entitle(fig: Figure, ds: xr.Dataset) -> None:
    """The study's title and its reading, above a constrained layout; the figure grows by the lines of a long title."""
    title = fill(str(ds.attrs["title"]), int((fig.get_figwidth() - 0.3) / (LARGE * LETTER * BOLD)))
    more = 0.2 * title.count("\n")  # inches
    fig.set_figheight(fig.get_figheight() + more)
    inch = 1 / fig.get_figheight()
    told = reading(ds)
    engine = fig.get_layout_engine()
    assert isinstance(engine, ConstrainedLayoutEngine)
    engine.set(rect=(0, 0, 1, 1 - ((0.62 if told else 0.4) + more) * inch), w_pad=0.1, h_pad=0.08)
    fig.text(0.012, 1 - 0.1 * inch, title, va="top", weight="bold", size=LARGE)
    fig.text(0.012, 1 - (0.36 + more) * inch, told, va="top", color=SOFT)


def wrapped(text: str, ax: Axes, size: float = NORMAL, bold: bool = False, upward: bool = False) -> str:
    """The text in lines that are no longer than the axes are wide (or high), for a font of that size in points."""
    room = inches(ax)[int(upward)]
    return fill(text, max(int(room / (size * LETTER * (BOLD if bold else 1))), 12))


def inches(ax: Axes) -> tuple[float, float]:
    """Width and height of axes before they are laid out: a little less than what they get."""
    box, figure = ax.get_position(), ax.get_figure(root=True)
    assert figure is not None
    return box.width * figure.get_figwidth(), box.height * figure.get_figheight()


def plain(value: float, _: object = None) -> str:
    """A tick's number in full: no offset, no power of ten beside the axis."""
    return f"{value:.10g}".replace("-", "−")


def power(value: float, _: object = None) -> str:
    """A tick of a logarithmic axis, a power of ten: ``10⁻³``."""
    exponent = f"{log10(value):.10g}" if value > 0 else ""
    return f"10{exponent.translate(RAISED)}" if exponent.lstrip("-").isdigit() else ""


def quiet(ax: Axes) -> Axes:
    """A faint grid behind everything."""
    ax.grid(color=FAINT, linewidth=0.6)
    ax.set_axisbelow(True)
    return ax


def picture_kind(path: Any, kinds: tuple[str, ...]) -> None:
    """Raise `InputError` unless the name ends in one of the kinds."""
    if path.suffix.lower() not in kinds:
        raise InputError(f"cannot draw {path.name!r}: choose a name that ends in {', '.join(kinds)}")


def _bracketed(text: str) -> str:
    return f" [{text}]" if text else ""
