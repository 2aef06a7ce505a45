"""The panel of a law: its observable against its axis, what the law compares it with, the verdict with its reason."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from studies.laws import law_words, line_verdicts
from studies.laws.law_kinds import MONOTONE, Show
from studies.laws.line_verdicts import NOISE

from ..stored.trend_lines import LawLine
from ..words import labels
from . import canvas, colours, fonts
from .trends import trend


def panel(law: LawLine, ax: Axes, title: str) -> str:
    """Draw a law: its trend, and above it a title in the colour of the verdict. Returns its sentence of the caption."""
    row = law.row
    trend(law, ax)
    colour = colours.VERDICTS[row["verdict"]]
    for step in row["exceptions"]:
        if all(step["at"][name] == value for name, value in row["at"].items()):
            ends = [labels.in_label_unit(law.axis, step[end]) for end in ("from", "to")]
            case = step["from"] == step["to"]
            how: dict[str, Any] = {"marker": "o", "markersize": 9, "markerfacecolor": "none"} if case else {}
            ax.plot(
                ends,
                labels.in_label_unit(law.observable, step["values"]),
                color=colour,
                linewidth=3,
                alpha=0.6,
                zorder=3,
                label="a case outside" if case else WRONG,
                **how,
            )
    if row["kind"] == MONOTONE:
        _mark_steps(law, ax, colour)
    draw_curve(law, ax)
    ax.set_title(fonts.wrap(title, ax), loc="left", color=colour)
    canvas.add_legend(ax)
    return caption_of(law)


def _mark_steps(law: LawLine, ax: Axes, colour: str) -> None:
    """Draw the steps the wrong way of the lines at other values of the other axes."""
    along = labels.in_label_unit(law.axis, law.along)
    for line in law.lines:
        if not np.array_equal(line, law.values, equal_nan=True):
            values = labels.in_label_unit(law.observable, line)
            for step in line_verdicts.judge(line, law.row["direction"], law.is_count).exceptions:
                ax.plot(along[[*step]], values[[*step]], color=colour, linewidth=1.2, zorder=1.5, label=WRONG)


def titles(laws: Sequence[LawLine], room: float, size: float) -> list[str]:
    """What each law of a picture shows, and its verdict: with numbers where all titles stand on lines of so many
    inches, else all with the name of the claim in their place; the caption has all.

    size: points of the letters.
    """
    full, short = [], []
    for law in laws:
        larger = f", error up to {words}" if (words := _larger_error(law)) else ""
        (head, rest), verdict = _message(law), f": {law.row['verdict']}{larger}".replace(" ", labels.NO_BREAK)
        claim = f" · {law.row['claim']}"
        full.append(f"{head}{rest}{claim * (law.row['kind'] == MONOTONE)}{verdict}{_exponent_note(law.row)}")
        short.append(f"{head}{claim}{verdict}")
    return full if all(fonts.width_of(title, size) <= room for title in full) else short


def _noun(law: LawLine) -> str:
    """The observable of a law as a title begins with it."""
    full = labels.long_name(law.observable)
    return labels.capital(full if len(full) <= LONGEST_NOUN else labels.symbol(law.observable))


def _rule(law: LawLine) -> str:
    """What a law with numbers says of its observable, with its tolerance: ``: exponent −0.5 ± 0.01``."""
    rule, kind = law.row["rule"], law.row["kind"]
    if kind == "equals":
        return f" = {_with_tolerance(law)}"
    if kind == "bounded":
        ends = [
            (word, labels.formula(law.formulas, rule[key], law.observable))
            for key, word in BOUNDS
            if rule.get(key) is not None
        ]
        return f" from {ends[0][1]} to {ends[1][1]}" if len(ends) == 2 else f": {' '.join(ends[0])}"
    if kind == "scales":
        return f": exponent {labels.number(rule['exponent'])} ± {labels.number(rule['within'])}"
    places = np.unique(law.compared["x"])
    place, within = labels.formula(law.formulas, rule["x"], law.axis), labels.one_word(rule["within"], law.axis)
    if places.size == 1 and np.isfinite(places[0]):
        texts = [labels.number(float(labels.in_label_unit(law.axis, each))) for each in (places[0], rule["within"])]
        unit = within[len(labels.powers_of_ten(texts[1])) :]
        decimals = max(len(text.partition(".")[2]) for text in texts)
        place, within = (text if "e" in text else f"{float(text):.{decimals}f}" for text in texts)
        within += unit
    passed = labels.formula(law.formulas, rule["passes"], law.observable)
    return f" = {passed} at {place} ± {within}"


def _exponent_note(row: Mapping[str, Any]) -> str:
    """The measured exponent of a law, `` (−0.5001)``, where it is not written as that of the law; else nothing."""
    if row["kind"] != "scales" or not row["numbers"]:
        return ""
    measured, meant = (labels.number(of["exponent"]) for of in (row["numbers"], row["rule"]))
    return f" ({measured})" * (measured != meant)


def _message(law: LawLine) -> tuple[str, str]:
    """What a law shows, and its numbers: ``Number of bends falls with E`` and ``: 8 to 5``."""
    noun, values = _noun(law), law.values[np.isfinite(law.values)]
    if law.row["kind"] != MONOTONE:
        return noun, labels.typeset(_rule(law))
    if not values.size:
        return noun, ""
    first, last = labels.values_alike(law.observable, values[[0, -1]])
    if np.ptp(values) <= NOISE * np.abs(values).max():
        return f"{noun} stays at {first}", ""
    steps = np.sign(np.diff(values)) * np.sign(values[-1] - values[0])
    wrong, axis = int((steps < 0).sum()), labels.symbol(law.axis)
    does = "rises" if values[-1] > values[0] else "falls"
    if 2 * wrong >= steps.size or values[-1] == values[0]:
        return f"{noun} rises and falls with {axis}", ""
    but = f" but at {law_words.count_of(wrong, 'step')}" if wrong else ""
    first = first if first.endswith("°") else first.partition(" ")[0]
    return f"{noun} {does} with {axis}{but}", f": {first} to {last}"


def caption_of(law: LawLine) -> str:
    """The sentence of a caption on a law: the law, its verdict with what was measured, the other observables."""
    row, show = law.row, show_of(law.formulas, law.observable, law.axis)
    others = law_words.others(row, lambda name: labels.symbol(law.others[name]))
    measured = law_words.measurement(row, show)
    said = law_words.join([row["verdict"], labels.law_text(row, measured)]).rstrip(".")
    larger = f" Its estimated error, up to {words}, exceeds the tolerance." if (words := _larger_error(law)) else ""
    return f"{row['claim']}: {sentence(law)}; {said}. {others}".rstrip() + larger


def _larger_error(law: LawLine) -> str:
    """The largest estimated error of an observable, ``3 %``, where it is more than its law allows; else nothing."""
    rule = law.row["rule"]
    if law.row["kind"] != "equals" or law.is_trivial:
        return ""
    relative = rule.get("relative")
    errors = law.errors / (1.0 if relative is None else np.abs(law.compared["formula"]))
    most = float(np.max(errors, initial=0.0, where=np.isfinite(errors)))
    if most <= (rule["absolute"] if relative is None else relative):
        return ""
    share = f"{labels.powers_of_ten(labels.number(100 * most, 2))}{labels.NO_BREAK}%"
    return share if relative is not None else labels.value(most, law.observable, 2)


def show_of(formulas: Mapping[str, str], observable: xr.DataArray, axis: xr.DataArray) -> Show:
    """How a law on an observable along an axis writes a number or a formula: with units and symbols."""

    def show(value: Any, of: str) -> str:
        named = f"{labels.symbol(axis)} = " if of == "place" else ""
        return named + labels.formula(formulas, value, observable if of == "observable" else axis)

    return show


WRONG = "a step the wrong way"  # in a legend
DASHED, DOTTED = (0, (4, 2)), (0, (1, 1.5))  # of a curve and a lower bound; of an upper bound
SEEN = 4.0  # points across, from which a band is seen beside a line
ALLOWED = "allowed"  # what a law allows
BAND: dict[str, Any] = {"color": colours.INK, "alpha": 0.12, "linewidth": 0, "zorder": 0}
LONGEST_NOUN = 24  # letters of an observable in a title, beyond which its symbol stands there
BOUNDS = ("least", "at least"), ("most", "at most")


def draw_curve(law: LawLine, ax: Axes) -> None:
    """Draw what a law compares its observable with, on the line that decides."""
    if law.row["kind"] != MONOTONE:
        WITH_NUMBERS[law.row["kind"]](ax, law, labels.in_label_unit(law.axis, law.along))


def _heights(law: LawLine, key: str) -> Any:
    """The numbers of that key with which a law compares its observable, in the unit of its label."""
    return labels.in_label_unit(law.observable, law.compared[key])


def _with_tolerance(law: LawLine) -> str:
    """The formula of a law and by how much its observable may be off: ``FZ²·ρ/(4·EI) ± 1 %``."""
    rule = law.row["rule"]
    if (relative := rule.get("relative")) is None:
        near = labels.one_word(rule["absolute"], law.observable)
    else:
        near = f"{100 * relative:.4g}{labels.NO_BREAK}%"
    return f"{labels.formula(law.formulas, rule['formula'], law.observable)} ± {near}"


def _equals(ax: Axes, law: LawLine, along: Any) -> None:
    counted = np.where(law.solved & ~np.isfinite(law.values), np.nan, _heights(law, "formula"))
    along, values = (np.insert(row, law.broken, np.nan) for row in (along, counted))
    rule = law.row["rule"]
    if rule.get("relative") is None:
        half = labels.in_label_unit(law.observable, rule["absolute"])
    else:
        half = rule["relative"] * np.abs(values)
    words = _with_tolerance(law)
    if law.alone:  # the numbers of each rod are its own
        ax.plot(along, values, "_", color=colours.INK, markersize=9, zorder=1.5, label=words)
        return
    _line(ax, along, values, words)
    _allow(ax, along, values, values - half, values + half)


def _allow(ax: Axes, along: Any, line: Any, low: Any, high: Any) -> None:
    """Shade what a law allows, and name it where the line does not hide it."""
    across = 2 * np.nanmedian(np.maximum(high - line, line - low)) / np.ptp(ax.get_ylim())
    seen = across * fonts.inches(ax)[1] * 72 >= SEEN
    ax.fill_between(along, low, high, label=ALLOWED if seen else "", **BAND)


def _bound(ax: Axes, law: LawLine, along: Any) -> None:
    for key, word in BOUNDS:
        if key in law.compared:
            words = f"{word} {labels.formula(law.formulas, law.row['rule'][key], law.observable)}"
            _line(ax, along, _heights(law, key), words, DASHED if key == "least" else DOTTED)


def _scales(ax: Axes, law: LawLine, along: Any) -> None:
    measured = law.row["numbers"]
    if not measured:
        return
    at, rule = np.abs(law.along), law.row["rule"]
    centre = np.exp(np.mean(np.log(at[np.isfinite(law.values)])))  # where the fit is the geometric mean of the values
    middle, share = measured["factor"] * centre ** measured["exponent"], at / centre
    fitted, *ends = (
        labels.in_label_unit(law.observable, middle * share**exponent)
        for exponent in (measured["exponent"], rule["exponent"] - rule["within"], rule["exponent"] + rule["within"])
    )
    _line(ax, along, fitted, "fit")
    _allow(ax, along, fitted, *np.sort(ends, axis=0))


def _boundary(ax: Axes, law: LawLine, along: Any) -> None:
    rule, numbers = law.row["rule"], law.row["numbers"]
    places = np.unique(labels.in_label_unit(law.axis, law.compared["x"]))
    half = float(labels.in_label_unit(law.axis, rule["within"]))
    heights = _heights(law, "passes")
    passed = labels.formula(law.formulas, rule["passes"], law.observable)
    _line(ax, along, heights, f"{labels.symbol(law.observable)} = {passed}")
    if places.size == 1 and np.isfinite(places[0]):
        ax.axvspan(places[0] - half, places[0] + half, label=ALLOWED, **BAND)
        ax.axvline(
            places[0],
            color=colours.SOFT,
            linewidth=1,
            zorder=1,
            label="expected",
        )
        if numbers:
            step = sorted(numbers[end] for end in ("from", "to"))
            ends = labels.in_label_unit(law.axis, np.array(step))
            ax.plot(
                ends,
                [heights[0]] * 2,
                "|-",
                color=colours.INK,
                linewidth=2.2,
                markersize=7,
                zorder=5,
                label=f"computed: {labels.number(ends[0])} to {labels.one_word(step[1], law.axis)}",
            )


def _line(ax: Axes, along: Any, values: Any, label: str, look: Any = DASHED) -> None:
    words = labels.minus_signs(labels.typeset(label))
    ax.plot(along, values, color=colours.INK, linewidth=1.0, linestyle=look, zorder=3, label=words)


def sentence(law: LawLine) -> str:
    """``push in the middle equals FZ²·ρ/(4·EI) within 1 %, along FZ``."""
    noun = (labels.long_name if law.row["kind"] == MONOTONE else labels.symbol)(law.observable)
    show = show_of(law.formulas, law.observable, law.axis)
    text = law_words.law_in_words(law.row, noun, labels.symbol(law.axis), show)
    return labels.typeset(text.replace(" %", f"{labels.NO_BREAK}%"))


WITH_NUMBERS = {"equals": _equals, "bounded": _bound, "scales": _scales, "boundary": _boundary}  # what draws a kind
