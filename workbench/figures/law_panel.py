"""The panel of a law: its observable against its axis, its formula, the verdict with its reason, and what is wrong."""

from collections.abc import Mapping
from typing import Any

import xarray as xr
from matplotlib.axes import Axes

from studies.reasons import PLAIN

from ..data import labels, law_verdicts
from . import law_words, legend, notes, style
from .law_curve import curve
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
    curve(ds, ax, row)
    title = f"{row['claim']}: {law_words.sentence(ds, row)}"
    pad = 6 + (_write_verdict(ax, row) if sheet.titled else 0.0)
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
    told = "; ".join(text for text in (PLAIN[row["verdict"]], _measure(row), _other_observables(ds, row)) if text)
    notes.keep(fig, [f"{title}; {told.rstrip('.')}."])


def _measure(row: Mapping[str, Any]) -> str:
    return labels.law_text(row, "; ".join(text for text in (row["found"], law_verdicts.detail(row)) if text))


def _write_verdict(ax: Axes, row: Mapping[str, Any]) -> float:
    """Write the verdict above the axes and its reason below it, in the verdict's colour; their height in points."""
    colour = style.VERDICT_COLOURS[row["verdict"]]
    reason = style.wrap(_measure(row), ax, style.small())
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
