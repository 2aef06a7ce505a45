"""The panel of a law: its observable against its axis, what the law compares it with, the verdict with its reason."""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from studies.laws import law_words
from studies.laws.line_verdicts import HOLDS, MONOTONE, NOISE, Show

from ..stored.stored_study import StoredStudy
from ..words import labels
from . import canvas, colours, fonts
from .trends import trend


def panel(stored: StoredStudy, ax: Axes, row: Mapping[str, Any]) -> str:
    """Draw a law, given as a row of `law_verdicts.verdicts`: its trend, and above it what it does, with the verdict.

    Returns its sentence of the caption.
    """
    is_covered = row["kind"] == "equals" or (row["kind"] == "scales" and bool(row["numbers"]))
    trend(stored, ax, row["observable"], row["axis"], row["at"], joined=not is_covered)
    colour = colours.VERDICTS[row["verdict"]]
    for step in row["exceptions"]:
        if all(step["at"][name] == value for name, value in row["at"].items()):
            ends = [labels.in_label_unit(stored[row["axis"]], step[end]) for end in ("from", "to")]
            case = step["from"] == step["to"]
            how: dict[str, Any] = {"marker": "o", "markersize": 9, "markerfacecolor": "none"} if case else {}
            heights = labels.in_label_unit(stored[row["observable"]], step["values"])
            ax.plot(
                ends,
                heights,
                color=colour,
                linewidth=3,
                alpha=0.6,
                zorder=3,
                label="a case outside" if case else "a step the wrong way",
                **how,
            )
    draw_curve(stored, ax, row)
    ax.set_title(fonts.wrap(_title(stored, row, fonts.inches(ax)[0]), ax), loc="left", color=colour)
    canvas.add_legend(ax)
    return caption_of(stored, row)


def is_trivial(stored: StoredStudy, row: Mapping[str, Any]) -> bool:
    """Whether a true law is of a number that is the same in all cases, or an identity but for rounding: a picture of it
    shows nothing."""
    exact = row["kind"] == "equals" and (row["rule"].get("relative") or 1.0) <= IDENTITY
    return row["verdict"] == HOLDS and (exact or stored.is_level(row["observable"]))


def _title(stored: StoredStudy, row: Mapping[str, Any], room: float) -> str:
    """What a law shows, as much of it as stands on a line of so many inches, and its verdict: the caption has all."""
    verdict = row["verdict"]
    if row["kind"] == MONOTONE:
        head, rest = _message(stored, row)
        titles = [f"{head}{rest} · {row['claim']}: {verdict}", f"{head}{rest} · {verdict}"]
        last = f"{head} · {row['claim']}: {verdict}"
    else:
        noun, law = _noun(stored, row), labels.typeset(_law(stored, row))
        titles = [f"{noun}{law}: {verdict}{_exponent_note(row)}", f"{noun}{law}: {verdict}"]
        last = f"{noun} · {row['claim']}: {verdict}"
    return next((title for title in titles if fonts.width_of(title, fonts.normal()) <= room), last)


def _noun(stored: StoredStudy, row: Mapping[str, Any]) -> str:
    """The observable of a law as a title begins with it."""
    array = stored[row["observable"]]
    full = labels.long_name(array)
    noun = full if len(full) <= LONGEST_NOUN else labels.symbol(array)
    return noun[:1].upper() + noun[1:] if noun[:1].isascii() else noun


def _law(stored: StoredStudy, row: Mapping[str, Any]) -> str:
    """What a law with numbers says of its observable, with its tolerance: ``: exponent −0.5 ± 0.01``."""
    array, axis, rule, kind = stored[row["observable"]], stored[row["axis"]], row["rule"], row["kind"]
    if kind == "equals":
        return f" = {_with_tolerance(stored, rule, array)}"
    if kind == "bounded":
        ends = [
            (word, formula(stored.expressions, rule[key], array)) for key, word in BOUNDS if rule.get(key) is not None
        ]
        return f" from {ends[0][1]} to {ends[1][1]}" if len(ends) == 2 else f": {' '.join(ends[0])}"
    if kind == "scales":
        return f": exponent {labels.number(rule['exponent'])} ± {labels.number(rule['within'])}"
    places = np.unique(_numbers_of(stored, row)["x"])
    place = formula(stored.expressions, rule["x"], axis)
    if places.size == 1 and np.isfinite(places[0]):
        place = _number(float(places[0]), axis).partition(NO_BREAK)[0]
    return f" = {formula(stored.expressions, rule['passes'], array)} at {place} ± {_number(rule['within'], axis)}"


def _exponent_note(row: Mapping[str, Any]) -> str:
    """The measured exponent of a law, `` (−0.5001)``, where it is not written as that of the law; else nothing."""
    if row["kind"] != "scales" or not row["numbers"]:
        return ""
    measured, meant = (labels.number(of["exponent"]) for of in (row["numbers"], row["rule"]))
    return f" ({measured})" * (measured != meant)


def _message(stored: StoredStudy, row: Mapping[str, Any]) -> tuple[str, str]:
    """What the line of a law with a direction shows: ``Number of bends falls with E`` and ``: 8 to 5``.

    row: of `law_verdicts.verdicts`.
    """
    array, noun = stored[row["observable"]], _noun(stored, row)
    solved = stored.of_solved(row["observable"])
    values = np.array([float(solved.isel(place)) for place in stored.places(row["axis"], row["at"])])
    values = values[np.isfinite(values)]
    if not values.size:
        return noun, ""
    first, last = (labels.value(end, array) for end in (values[0], values[-1]))
    if np.ptp(values) <= NOISE * np.abs(values).max():
        return noun, f" stays at {first}"
    steps = np.sign(np.diff(values)) * np.sign(values[-1] - values[0])
    wrong, axis = int((steps < 0).sum()), labels.axis_symbol(row["axis"])
    does = "rises" if values[-1] > values[0] else "falls"
    if 2 * wrong >= steps.size or values[-1] == values[0]:
        return f"{noun} rises and falls with {axis}", ""
    but = f" but at {law_words.count_of(wrong, 'step')}" if wrong else ""
    first = first if first.endswith("°") else first.partition(" ")[0]
    return f"{noun} {does} with {axis}{but}", f": {first} to {last}"


def caption_of(stored: StoredStudy, row: Mapping[str, Any]) -> str:
    """The sentence of a caption on a law: the law, its verdict with what was measured, the other observables."""
    verdict = row["verdict"]
    others = law_words.others(row, lambda name: labels.symbol(stored[name]))
    said = "; ".join(text for text in (verdict, _measure(stored, row)) if text)
    return f"{row['claim']}: {sentence(stored, row)}; {said.rstrip('.')}. {others}".rstrip()


def _measure(stored: StoredStudy, row: Mapping[str, Any]) -> str:
    """What was measured, its numbers with their units, and the reason of the verdict."""
    said = law_words.measurement(row, _show(stored, row))
    return labels.law_text(row, "; ".join(text for text in (said, law_words.detail(row)) if text))


def _show(stored: StoredStudy, row: Mapping[str, Any]) -> Show:
    """How a law writes a number or a formula: with units and symbols."""
    axis = row["axis"]
    arrays = {"observable": stored[row["observable"]], "axis": stored[axis], "place": stored[axis]}

    def show(value: Any, of: str) -> str:
        named = f"{labels.axis_symbol(axis)} = " if of == "place" else ""
        return named + formula(stored.expressions, value, arrays[of])

    return show


DASHED, DOTTED = (0, (4, 2)), (0, (1, 1.5))  # of a curve and a lower bound; of an upper bound
SEEN = 4.0  # points across, from which a band is seen beside a line
LONGEST_NOUN = 24  # letters of an observable in a title, beyond which its symbol stands there
WHICH = ("claim", "kind", "observable", "axis", "rule")  # by these a law is found: the numbers of two such are equal
BOUNDS = ("least", "at least"), ("most", "at most")
IDENTITY = 1e-8  # a formula that agrees so well is an identity: its picture is a line on a line


def draw_curve(stored: StoredStudy, ax: Axes, row: Mapping[str, Any]) -> None:
    """Draw what a law (a row of `law_verdicts.verdicts`) compares its observable with, on the line that decides."""
    if row["kind"] == MONOTONE:
        return
    axis, places = row["axis"], stored.places(row["axis"], row["at"])
    along = labels.in_label_unit(stored[axis], stored[axis].values[[place[axis] for place in places]])
    numbers = {
        key: values if key == "x" else labels.in_label_unit(stored[row["observable"]], values)
        for key, values in _numbers_of(stored, row).items()
    }
    WITH_NUMBERS[row["kind"]](ax, stored, along, numbers, row)


def _numbers_of(stored: StoredStudy, row: Mapping[str, Any]) -> dict[str, Any]:
    """The numbers that a law compares its observable with, on the line that decides, in rising order of its axis."""
    laws = zip(stored.laws, stored.numbers_of_laws, strict=True)
    compared = next(numbers for law, numbers in laws if all(getattr(law, key) == row[key] for key in WHICH))
    places = stored.places(row["axis"], row["at"])
    on_line = tuple(np.array([place[name] for place in places]) for name in stored.axes)
    return {key: values[on_line] for key, values in compared.items()}


def _with_tolerance(stored: StoredStudy, rule: Mapping[str, Any], array: xr.DataArray) -> str:
    """The formula of a law and by how much its observable may be off: ``FZ²·ρ/(4·EI) ± 1 %``."""
    relative = rule.get("relative")
    near = _number(rule["absolute"], array) if relative is None else f"{100 * relative:.4g}{NO_BREAK}%"
    return f"{formula(stored.expressions, rule['formula'], array)} ± {near}"


def _equals(ax: Axes, stored: StoredStudy, along: Any, numbers: Any, row: Any) -> None:
    values, array, rule = numbers["formula"], stored[row["observable"]], row["rule"]
    if rule.get("relative") is None:
        half = labels.in_label_unit(array, rule["absolute"])
    else:
        half = rule["relative"] * np.abs(values)
    words = _with_tolerance(stored, rule, array)
    if stored.stand_alone:  # the numbers of each rod are its own
        ax.plot(along, values, "_", color=colours.INK, markersize=9, zorder=1.5, label=words)
        return
    _line(ax, along, values, words)
    _allow(ax, along, values - half, values + half)


def _allow(ax: Axes, along: Any, low: Any, high: Any) -> None:
    """Shade what a law allows, and name it where the line does not hide it."""
    seen = np.median(high - low) * fonts.inches(ax)[1] * 72 >= SEEN * np.ptp(ax.get_ylim())
    ax.fill_between(
        along, low, high, color=colours.INK, alpha=0.12, linewidth=0, zorder=0, label="allowed" if seen else ""
    )


def _bound(ax: Axes, stored: StoredStudy, along: Any, numbers: Any, row: Any) -> None:
    array, rule = stored[row["observable"]], row["rule"]
    for key, word in BOUNDS:
        if key in numbers:
            words = f"{word} {formula(stored.expressions, rule[key], array)}"
            _line(ax, along, numbers[key], words, DASHED if key == "least" else DOTTED)


def _scales(ax: Axes, stored: StoredStudy, along: Any, numbers: Any, row: Any) -> None:
    measured = row["numbers"]
    if not measured:
        return
    at = np.abs(np.radians(along) if labels.is_angle(stored[row["axis"]]) else along)
    fitted = labels.in_label_unit(stored[row["observable"]], measured["factor"] * at ** measured["exponent"])
    _line(ax, along, fitted, "fit")
    wide = np.exp(row["rule"]["within"] * np.abs(np.log(at / np.exp(np.mean(np.log(at))))))
    low, high = np.sort([fitted / wide, fitted * wide], axis=0)
    _allow(ax, along, low, high)


def _boundary(ax: Axes, stored: StoredStudy, along: Any, numbers: Any, row: Any) -> None:
    axis, array, rule = stored[row["axis"]], stored[row["observable"]], row["rule"]
    places = np.unique(labels.in_label_unit(axis, numbers["x"]))
    half = float(labels.in_label_unit(axis, rule["within"]))
    passed = formula(stored.expressions, rule["passes"], array)
    _line(ax, along, numbers["passes"], f"{labels.symbol(array)} = {passed}")
    if places.size == 1 and np.isfinite(places[0]):
        ax.axvspan(places[0] - half, places[0] + half, color=colours.INK, alpha=0.12, linewidth=0, zorder=0)
        ax.axvline(
            places[0],
            color=colours.SOFT,
            linewidth=1,
            zorder=1,
            label="expected",
        )
        if row["numbers"]:
            step = sorted(row["numbers"][end] for end in ("from", "to"))
            ends = labels.in_label_unit(axis, np.array(step))
            ax.plot(
                ends,
                [numbers["passes"][0]] * 2,
                "|-",
                color=colours.INK,
                linewidth=2.2,
                markersize=7,
                zorder=5,
                label=f"computed: {labels.number(ends[0])} to {_number(step[1], axis)}",
            )


def _line(ax: Axes, along: Any, values: Any, label: str, look: Any = DASHED) -> None:
    ax.plot(along, values, color=colours.INK, linewidth=1.0, linestyle=look, zorder=3, label=labels.minus_signs(label))


NO_BREAK = "\N{NO-BREAK SPACE}"
LETTERS = {"pi": "π", "bending_stiffness": "EI", "torsional_stiffness": "GJ"}  # as a study names them
LONGEST = 60  # letters of a formula beside a curve


def sentence(stored: StoredStudy, row: Mapping[str, Any]) -> str:
    """``push in the middle equals FZ²·ρ/(4·EI) within 1 %, along FZ``.

    Parameters
    ----------
    stored
        The dataset of the law.
    row
        A row of `law_verdicts.verdicts`.
    """
    array = stored[row["observable"]]
    noun = labels.long_name(array) if row["kind"] == MONOTONE else labels.symbol(array)
    text = law_words.law_in_words(row, noun, labels.axis_symbol(row["axis"]), _show(stored, row))
    return labels.typeset(text.replace(" %", f"{NO_BREAK}%"))


def formula(expressions: Mapping[str, str], value: Any, array: xr.DataArray) -> str:
    """A formula in symbols, or a number with the unit of a variable; an expression by its own formula, or by its name.

    ``FZ**2*rho/(4*bending_stiffness)`` is ``FZ²·ρ/(4·EI)``. A formula of more than `LONGEST` letters leaves no room for
    the curves: then an expression is named, and any other formula is cut off with "…". expressions: name -> formula, as
    stored.
    """
    if not isinstance(value, str):
        return _number(value, array)
    whole = _in_symbols(expressions, expressions.get(value, value))
    if len(whole) <= LONGEST:
        return whole
    return _symbol(expressions, value) if value in expressions else f"{whole[: LONGEST - 1].rstrip()}…"


def _in_symbols(expressions: Mapping[str, str], value: str) -> str:
    text = re.sub(r"[A-Za-z_]\w*", lambda found: _symbol(expressions, found[0]), value)
    text = re.sub(r"\*\*\s*(?:\((-?[\d.]+)\)|(-?[\d.]+))", lambda found: _exponent(found[1] or found[2]), text)
    return re.sub(r"\s*\*\s*", "·", text.replace("**", "^").replace(" - ", " − "))


def _symbol(expressions: Mapping[str, str], name: str) -> str:
    if name in LETTERS:
        return LETTERS[name]
    return name.replace("_", " ") if name in expressions else labels.symbol_of(name)


def _exponent(text: str) -> str:
    """A whole exponent raised, any other after a caret."""
    return text.translate(labels.SUPERSCRIPTS) if "." not in text else f"^{text}".replace("-", "−")


def _number(value: float, array: xr.DataArray) -> str:
    """A number in the unit of a variable's label, which no line ends between."""
    return labels.value(float(value), array).replace(" ", NO_BREAK)


WITH_NUMBERS = {"equals": _equals, "bounded": _bound, "scales": _scales, "boundary": _boundary}  # what draws a kind
