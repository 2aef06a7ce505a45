"""How everything drawn looks: colours, sizes, and how numbers and units are written."""

from math import degrees, floor, log10
from typing import Any

import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes

from solver.errors import InputError
from solver.quantities import QUANTITIES, quantity
from studies.axes import quantity_of
from studies.laws import FAILS, HOLDS, TREND

# Okabe and Ito: told apart under every common colour blindness, and in grey
PUSHED = "#0072b2"  # where the cylinder pushes
LIFTED = "#e69f00"  # where it would have to pull
SURFACE = "#e3e6ea"  # the cylinder
INK, SOFT, FAINT = "#1c2430", "#5b6675", "#d5dae1"
VERDICT_COLOURS = {HOLDS: "#00704f", TREND: "#8a5a00", FAILS: "#b3261e"}

RAMP = colormaps["viridis"]
RAMP_ENDS = (0.0, 0.88)  # the last yellow is too light on white

DPI = 200
TEXT = {"small": 7.5, "normal": 9.0, "large": 11.5}

RC: dict[str, Any] = {
    "font.family": "DejaVu Sans",  # comes with Matplotlib
    "font.size": TEXT["normal"],
    "axes.titlesize": TEXT["normal"],
    "axes.labelsize": TEXT["normal"],
    "axes.edgecolor": SOFT,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.color": INK,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "xtick.labelsize": TEXT["small"],
    "ytick.labelsize": TEXT["small"],
    "legend.frameon": False,
    "legend.fontsize": TEXT["small"],
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "figure.dpi": DPI,
    "savefig.dpi": DPI,
    "pdf.fonttype": 42,
    "mathtext.default": "regular",
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


def shown(value: float, array: xr.DataArray) -> str:
    """A value of an axis with its unit, angles in degrees: ``10910 N/cm²``, ``15°``."""
    if is_angle(array):
        return f"{number(degrees(value))}°".replace("-", "−")
    return f"{number(value)} {unit(str(array.attrs.get('units', '1')))}".strip().replace("-", "−")


def symbol(name: str) -> str:
    """The letter of an axis or variable; an axis `beta` is the angle at the start."""
    return quantity_of(name).symbol if name in START_NAMES or name not in QUANTITIES else quantity(name).symbol


START_NAMES = ("beta", "dbeta", "F1", "F2", "F3", "alpha", "gamma")  # as axes these are values at the start


def axis_label(name: str, array: xr.DataArray) -> str:
    """``Young's modulus E [N/cm²]``; angles in degrees."""
    text = str(array.attrs.get("long_name", name)).partition(" (")[0]
    return f"{text}  {symbol(name)}{_bracketed('°' if is_angle(array) else unit(str(array.attrs['units'])))}"


def label(array: xr.DataArray) -> str:
    """``mean curvature  mean κ [1/cm]`` of a stored variable; angles in rad."""
    text, letter = str(array.attrs.get("long_name", array.name)), str(array.attrs.get("symbol", ""))
    letter = "" if letter in text or letter.isascii() and len(letter) > 3 else f"  {letter}"
    return f"{text.partition(' (')[0]}{letter}{_bracketed(unit(str(array.attrs.get('units', '1'))))}"


def reading(ds: xr.Dataset) -> str:
    """The reading in words, or nothing."""
    text = str(ds.attrs.get("reading", ""))
    return f"Table 1 read {text.replace('/', ', ')}" if text else ""


def colours(count: int) -> list[Any]:
    """So many colours along the ramp."""
    low, high = RAMP_ENDS
    return [RAMP(low + (high - low) * i / max(count - 1, 1)) for i in range(count)]


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
