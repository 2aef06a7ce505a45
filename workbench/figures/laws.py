"""The panel of a law: its observable against its axis, what the law compares it with, the verdict with its reason."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from studies.law import Law
from studies.law_kinds import MONOTONE
from studies.verdict_words import PLAIN

from ..data import labels, law_numbers, law_verdicts, selection
from . import legend, style
from .sheet import SCREEN, Sheet
from .trends import trend


def panel(ds: xr.Dataset, ax: Axes, row: Mapping[str, Any], sheet: Sheet = SCREEN) -> Axes:
    """Draw a law, given as a row of `law_verdicts.verdicts`: its trend, the verdict above it, its reason below that.

    On a sheet without a title only the law stands above it; the verdict and the other observables are kept.
    """
    trend(ds, ax, row["observable"], row["axis"], row["at"])
    for step in row["exceptions"]:
        if all(step["at"][name] == value for name, value in row["at"].items()):
            ends = [labels.in_label_unit(ds[row["axis"]], step[end]) for end in ("from", "to")]
            case = step["from"] == step["to"]
            how: dict[str, Any] = {"marker": "o", "markersize": 9, "markerfacecolor": "none"} if case else {}
            heights = labels.in_label_unit(ds[row["observable"]], step["values"])
            ax.plot(ends, heights, color=style.VERDICT_COLOURS[row["verdict"]], linewidth=3, alpha=0.6, zorder=3,
                    label="a case outside" if case else "a step the wrong way", **how)  # fmt: skip
    draw_curve(ds, ax, row)
    title = f"{row['claim']}: {sentence(ds, row)}"
    pad = 6 + (_write_verdict(ds, ax, row) if sheet.titled else 0.0)
    ax.set_title(style.wrap(title, ax), loc="left", pad=pad)
    if not sheet.titled:
        _keep(ds, ax, row, title)
    elif row["also"]:
        text = style.wrap(_other_observables(ds, row), ax, style.small())
        lines = "\n" * (text.count("\n") + 2)
        ax.set_xlabel(ax.get_xlabel() + lines, linespacing=0.95)  # room that the layout sees
        note = ax.annotate(text, (0, 0), (-8, -4 * style.normal()), xycoords="axes fraction",
                           textcoords="offset points", va="top", size=style.small(), color=style.SOFT)  # fmt: skip
        note.set_in_layout(False)
    legend.add(ax)
    return ax


def _keep(ds: xr.Dataset, ax: Axes, row: Mapping[str, Any], title: str) -> None:
    """Keep the verdict and the other observables for the caption."""
    fig = ax.get_figure(root=True)
    assert fig is not None
    told = "; ".join(text for text in (PLAIN[row["verdict"]], _measure(ds, row), _other_observables(ds, row)) if text)
    legend.keep(fig, [f"{title}; {told.rstrip('.')}."])


def _measure(ds: xr.Dataset, row: Mapping[str, Any]) -> str:
    """What was measured, its numbers with their units, and the reason of the verdict."""
    numbers, axis = row["numbers"], ds[row["axis"]]
    said = WITH_NUMBERS[row["kind"]].measured(ds, row, numbers, axis) if numbers else row["found"]
    return labels.law_text(row, "; ".join(text for text in (said, law_verdicts.detail(row)) if text))


def _off(ds: xr.Dataset, row: Mapping[str, Any], numbers: Mapping[str, float], axis: xr.DataArray) -> str:
    off = (
        f"{100 * numbers['off']:.3g} %" if "relative" in row["rule"] else _number(numbers["off"], ds[row["observable"]])
    )
    return f"at most {off} off, at {row['axis']} = {_number(numbers['at'], axis)}"


def _range(ds: xr.Dataset, row: Mapping[str, Any], numbers: Mapping[str, float], axis: xr.DataArray) -> str:
    return " to ".join(_number(numbers[end], ds[row["observable"]]) for end in ("smallest", "largest"))


def _crossing(ds: xr.Dataset, row: Mapping[str, Any], numbers: Mapping[str, float], axis: xr.DataArray) -> str:
    if row["found"].count("between") > 1:
        return str(row["found"])
    return f"passes between {' and '.join(_number(numbers[end], axis) for end in ('from', 'to'))}"


def _write_verdict(ds: xr.Dataset, ax: Axes, row: Mapping[str, Any]) -> float:
    """Write the verdict above the axes and its reason below it, in the verdict's colour; their height in points."""
    colour = style.VERDICT_COLOURS[row["verdict"]]
    reason = style.wrap(_measure(ds, row), ax, style.small())
    below = 11 * (reason.count("\n") + 1) if reason else 0
    above: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points", "va": "bottom",
                             "color": colour}  # fmt: skip
    ax.annotate(reason, (0, 1), (0, 3), size=style.small(), **above)
    ax.annotate(PLAIN[row["verdict"]], (0, 1), (0, 3 + below), weight="bold", **above)
    return below + 14


def _other_observables(ds: xr.Dataset, row: Mapping[str, Any]) -> str:
    """The verdicts of the other observables: the alternatives of the law, then those that decide nothing."""
    sentences = []
    for intro, equal in (("Alternative observables", True), ("For information only", False)):
        some = [also for also in row["also"] if also["alternative"] == equal]
        if some:
            brief = "; ".join(f"{labels.symbol(ds[also['observable']])} {_brief(also)}" for also in some)
            sentences.append(f"{intro}: {brief}.")
    return " ".join(sentences)


def _brief(row: Mapping[str, Any]) -> str:
    """What an observable does, in the words of its verdict, and how many of its steps go the wrong way."""
    wrong, does = len(row["exceptions"]), PLAIN[row["verdict"]]
    return f"{does} ({wrong} step{'s' * (wrong > 1)} wrong)" if wrong else does


DASHED, DOTTED = (0, (4, 2)), (0, (1, 1.5))  # of a curve and a lower bound; of an upper bound
SEEN = 4.0  # points across, from which a band is seen beside a line


def draw_curve(ds: xr.Dataset, ax: Axes, row: Mapping[str, Any]) -> None:
    """Draw what a law (a row of `law_verdicts.verdicts`) compares its observable with, on the line that decides."""
    if row["kind"] == MONOTONE:
        return
    law = Law.model_validate({key: row[key] for key in ("claim", "kind", "observable", "axis", "source")} | row["rule"])
    places = selection.line(ds, law.axis, row["at"])
    along = labels.in_label_unit(ds[law.axis], ds[law.axis].values[[place[law.axis] for place in places]])
    numbers = {
        key: values if key == "x" else labels.in_label_unit(ds[law.observable], values)
        for key, values in law_numbers.of_line(ds, law, places).items()
    }
    observed = labels.in_label_unit(ds[law.observable], [float(ds[law.observable].isel(place)) for place in places])
    WITH_NUMBERS[law.kind].draw(ax, ds, along, numbers | {"observed": observed}, law, row)


def _equals(ax: Axes, ds: xr.Dataset, along: Any, numbers: Any, law: Law, row: Any) -> None:
    values, array = numbers["formula"], ds[law.observable]
    half = labels.in_label_unit(array, law.absolute) if law.relative is None else law.relative * np.abs(values)
    _line(ax, along, values, formula(ds, law.formula, array))
    _allow(ax, along, values - half, values + half, f"± {_tolerance(row['rule'], array)}")


def _allow(ax: Axes, along: Any, low: Any, high: Any, tolerance: str) -> None:
    """Shade what a law allows, with its number."""
    if np.median(high - low) * style.inches(ax)[1] * 72 < SEEN * np.ptp(ax.get_ylim()):
        ax.plot([], [], " ", label=f"allowed: {tolerance}, not wider than the line")
    else:
        ax.fill_between(along, low, high, color=style.INK, alpha=0.12, linewidth=0, zorder=0,
                        label=f"allowed: {tolerance}")  # fmt: skip


def _bound(ax: Axes, ds: xr.Dataset, along: Any, numbers: Any, law: Law, row: Any) -> None:
    for key, word in (("least", "at least"), ("most", "at most")):
        if key in numbers:
            least = float(np.nanmin((numbers["observed"] - numbers[key]) * (1 if key == "least" else -1)))
            near = f"nearest: {labels.number(least, 3)} {'inside' if least >= 0 else 'outside'}".replace("-", "")
            words = f"{word} {formula(ds, getattr(law, key), ds[law.observable])} ({near})"
            _line(ax, along, numbers[key], words, DASHED if key == "least" else DOTTED)


def _scales(ax: Axes, ds: xr.Dataset, along: Any, numbers: Any, law: Law, row: Any) -> None:
    found = row["numbers"]
    if not found:
        return
    stored = np.abs(np.radians(along) if labels.is_angle(ds[law.axis]) else along)
    fitted = labels.in_label_unit(ds[law.observable], found["factor"] * stored ** found["exponent"])
    _line(ax, along, fitted, labels.typeset(f"fit: {row['found']}"))
    wide = np.exp(law.within * np.abs(np.log(stored / np.exp(np.mean(np.log(stored))))))
    low, high = np.sort([fitted / wide, fitted * wide], axis=0)
    _allow(ax, along, low, high, labels.minus_signs(f"exponent {law.exponent:g} ± {law.within:g}"))


def _boundary(ax: Axes, ds: xr.Dataset, along: Any, numbers: Any, law: Law, row: Any) -> None:
    axis = ds[law.axis]
    places = np.unique(labels.in_label_unit(axis, numbers["x"]))
    half, there = float(labels.in_label_unit(axis, law.within)), float(numbers["x"][0])
    _line(ax, along, numbers["passes"], f"the value {formula(ds, law.passes, ds[law.observable])}")
    if places.size == 1 and np.isfinite(places[0]):
        ax.axvspan(places[0] - half, places[0] + half, color=style.INK, alpha=0.12, linewidth=0, zorder=0)
        ax.axvline(places[0], color=style.SOFT, linewidth=1, zorder=1,
                   label=f"expected: {_number(there, axis)} ± {_number(law.within or 0.0, axis)}")  # fmt: skip
        if row["numbers"]:
            at = row["numbers"]["at"]
            share = f", {100 * abs(at - there) / abs(there):.2g} % off" if there else ""
            ax.plot(labels.in_label_unit(axis, at), numbers["passes"][0], "D", color="white", markersize=6, zorder=5,
                    markeredgecolor=style.INK, label=f"computed: {_number(at, axis)}{share}")  # fmt: skip


def _line(ax: Axes, along: Any, values: Any, label: str, look: Any = DASHED) -> None:
    ax.plot(along, values, color=style.INK, linewidth=1.3, linestyle=look, zorder=3, label=labels.minus_signs(label))


NO_BREAK = "\N{NO-BREAK SPACE}"
LETTERS = {"pi": "π", "bending_stiffness": "EI", "torsional_stiffness": "GJ"}  # as a study names them
LONGEST = 60  # letters of a formula beside a curve


def sentence(ds: xr.Dataset, row: Mapping[str, Any]) -> str:
    """``push in the middle equals FZ²·ρ/(4·EI) within 1 %, along FZ``.

    Parameters
    ----------
    ds
        The dataset of the law.
    row
        A row of `law_verdicts.verdicts`.
    """
    array, axis = ds[row["observable"]], labels.axis_symbol(row["axis"])
    if row["kind"] == MONOTONE:
        return labels.typeset(f"{labels.long_name(array)} {row['does']} with {axis}")
    predicate = WITH_NUMBERS[row["kind"]].predicate(ds, row["rule"], array, row["axis"])
    return labels.typeset(f"{labels.symbol(array)} {predicate}")


def _words_of_equals(ds: xr.Dataset, rule: Mapping[str, Any], array: xr.DataArray, axis: str) -> str:
    near = _tolerance(rule, array)
    return f"equals {formula(ds, rule['formula'], array)} within {near}, along {labels.axis_symbol(axis)}"


def _tolerance(rule: Mapping[str, Any], array: xr.DataArray) -> str:
    return f"{100 * rule['relative']:.4g}{NO_BREAK}%" if "relative" in rule else _number(rule["absolute"], array)


def _words_of_bounds(ds: xr.Dataset, rule: Mapping[str, Any], array: xr.DataArray, axis: str) -> str:
    return f"is {bounds(ds, rule, array)}, along {labels.axis_symbol(axis)}"


def _words_of_scales(ds: xr.Dataset, rule: Mapping[str, Any], array: xr.DataArray, axis: str) -> str:
    exponent = f"{rule['exponent']:.4g} within {rule['within']:.4g}"
    size = labels.axis_symbol(axis) if (ds[axis] >= 0).all() else f"|{labels.axis_symbol(axis)}|"
    return f"is a power of {size}, its exponent {exponent}"


def _words_of_boundary(ds: xr.Dataset, rule: Mapping[str, Any], array: xr.DataArray, axis: str) -> str:
    place = f"{formula(ds, rule['x'], ds[axis])} within {_number(rule['within'], ds[axis])}"
    return f"passes {formula(ds, rule['passes'], array)} at {labels.axis_symbol(axis)} = {place}"


def bounds(ds: xr.Dataset, rule: Mapping[str, Any], array: xr.DataArray) -> str:
    """``at least 0.9 and at most 1``."""
    ends = (("least", "at least"), ("most", "at most"))
    return " and ".join(f"{word} {formula(ds, rule[key], array)}" for key, word in ends if key in rule)


def formula(ds: xr.Dataset, value: Any, array: xr.DataArray) -> str:
    """A formula in symbols, or a number with the unit of a variable; an expression by its own formula, or by its name.

    ``FZ**2*rho/(4*bending_stiffness)`` is ``FZ²·ρ/(4·EI)``. A formula of more than `LONGEST` letters leaves no room for
    the curves: then an expression is named, and any other formula is cut off with "…".
    """
    if not isinstance(value, str):
        return _number(value, array)
    if value in ds and "expression" in ds[value].attrs:
        whole = _in_symbols(ds, str(ds[value].attrs["expression"]))
        return whole if len(whole) <= LONGEST else _symbol(ds, value)
    whole = _in_symbols(ds, value)
    return whole if len(whole) <= LONGEST else f"{whole[: LONGEST - 1].rstrip()}…"


def _in_symbols(ds: xr.Dataset, value: str) -> str:
    text = re.sub(r"[A-Za-z_]\w*", lambda found: _symbol(ds, found[0]), value)
    text = re.sub(r"\*\*\s*(?:\((-?[\d.]+)\)|(-?[\d.]+))", lambda found: _exponent(found[1] or found[2]), text)
    return re.sub(r"\s*\*\s*", "·", text.replace("**", "^").replace(" - ", " − "))


def _symbol(ds: xr.Dataset, name: str) -> str:
    if name in LETTERS:
        return LETTERS[name]
    return name.replace("_", " ") if name in ds and "expression" in ds[name].attrs else labels.symbol_of(name)


def _exponent(text: str) -> str:
    """A whole exponent raised, any other after a caret."""
    return text.translate(labels.SUPERSCRIPTS) if "." not in text else f"^{text}".replace("-", "−")


def _number(value: float, array: xr.DataArray) -> str:
    """A number in the unit of a variable's label, which no line ends between."""
    return labels.value(float(value), array).replace(" ", NO_BREAK)


@dataclass(frozen=True)
class Panel:
    """How a kind of law with numbers is drawn, what its sentence says of the observable, and of what was measured."""

    draw: Callable[..., None]
    predicate: Callable[..., str]
    measured: Callable[..., str]


WITH_NUMBERS = {
    "equals": Panel(_equals, _words_of_equals, _off),
    "bounded": Panel(_bound, _words_of_bounds, _range),
    "scales": Panel(_scales, _words_of_scales, lambda ds, row, numbers, axis: row["found"]),
    "boundary": Panel(_boundary, _words_of_boundary, _crossing),
}
