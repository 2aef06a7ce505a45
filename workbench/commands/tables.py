"""The tables of commands: columns and rows as text that fits the terminal, numbers to the right, verdicts in colour."""

import re
from collections.abc import Iterable, Mapping, Sequence
from math import degrees
from textwrap import wrap
from typing import Any

from solver.problem.quantities import unit_of

from ..words import escaping, unit_habits
from ..words.unit_habits import IN_TABLES, plain
from . import console

COLOURS = {  # verdict -> colour
    "true": "green",
    "true as a trend": "cyan",
    "true in part": "yellow",
    "not decided": "magenta",
    "false": "red",
}
GAP = 2  # characters between the columns


def print_table(columns: Sequence[str], rows: Iterable[Sequence[Any]], title: str | None = None) -> None:
    """Print a table; a cell that begins with a verdict has the verdict's colour.

    Where the terminal is too narrow, headings and texts break between words, and columns that still do not fit follow
    below, behind the first column again; no cell is cut.
    """
    cells = [[_cell(value) for value in row] for row in rows]
    texts = [[head, *(row[i].plain for row in cells)] for i, head in enumerate(columns)]
    low = [_narrowest(column) for column in texts]
    high = [max(len(line) for text in column for line in text.split("\n")) or 1 for column in texts]
    for k, block in enumerate(_blocks(low, console.out().width)):
        if k:
            console.say("")
        widths = _widths([low[i] for i in block], [high[i] for i in block], console.out().width)
        _print_block([columns[i] for i in block], [[row[i] for i in block] for row in cells], widths, title)
        title = None


def print_rows(
    rows: Iterable[Mapping[str, Any]], columns: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None
) -> None:
    """Print plain data as a table, a row for each mapping.

    columns: key -> heading; default: every key of the first row, as its own heading; then nothing where there is none.
    units: key -> unit as of `unit_printed`, for the heading; numbers under "deg" are in rad, and printed in degrees.
    """
    every, units = list(rows), units or {}
    heads = columns or (dict.fromkeys(every[0]) if every else {})
    cells = [[degrees(row[key]) if units.get(key) == "deg" else row[key] for key in heads] for row in every]
    if heads:
        print_table([column_title(text or key, units.get(key, "")) for key, text in heads.items()], cells)


def column_title(name: str, unit: str) -> str:
    """The heading of a column with its unit, which stays on one line."""
    return f"{name} ({unit.replace(' ', chr(0xA0))})" if unit else name


def number_stated(name: str, value: float, units: Mapping[str, str]) -> float:
    """A value of a quantity or a field in the unit of `unit_stated`."""
    from studies.grammar.axes import is_angle

    return degrees(value) if is_angle(name) else value * unit_habits.size_shown(name, units)


def unit_stated(name: str, units: Mapping[str, str]) -> str:
    """The unit in which engineers state a quantity or a field; degrees for an angle, nothing for a plain number."""
    return _in_degrees(unit_habits.unit_shown(name, units))


def unit_printed(name: str, units: Mapping[str, str]) -> str:
    """The unit of a quantity or a field as it is printed; nothing for a plain number."""
    from studies.grammar.axes import quantity_of

    return _in_degrees(unit_of(quantity_of(name).name, units))


def _in_degrees(unit: str) -> str:
    """A unit as it is printed: degrees for angles, nothing for a plain number."""
    return {"rad": "deg", "1": ""}.get(unit, unit)


def _narrowest(texts: Sequence[str]) -> int:
    """The smallest width of a column with this heading and these cells: a column of numbers or names stays whole."""
    head, *cells = texts
    whole = not any(" " in text for text in cells)
    each = [*head.split(" "), *(cells if whole else " ".join(cells).split())]
    return max(map(len, each), default=0) or 1


def _blocks(low: Sequence[int], width: int) -> list[list[int]]:
    """The columns in as many blocks as it takes to fit into the width, each with the first column."""
    blocks, used = [[0]], low[0]
    for i in range(1, len(low)):
        if used + GAP + low[i] > width and len(blocks[-1]) > 1:
            blocks.append([0])
            used = low[0]
        blocks[-1].append(i)
        used += GAP + low[i]
    return blocks


def _widths(low: Sequence[int], high: Sequence[int], width: int) -> list[int]:
    """The width of each column, from its smallest to its largest: the widest give way first."""
    room, limit = width - GAP * (len(low) - 1), max(high)
    while limit > 0 and sum(max(least, min(most, limit)) for least, most in zip(low, high, strict=True)) > room:
        limit -= 1
    return [max(least, min(most, limit)) for least, most in zip(low, high, strict=True)]


def _print_block(columns: Sequence[str], cells: Sequence[Any], widths: Sequence[int], title: str | None) -> None:
    from rich.table import Table

    table = Table(
        title=title, title_justify="left", box=None, padding=(0, GAP, 0, 0), pad_edge=False, header_style="bold"
    )
    for i, (column, width) in enumerate(zip(columns, widths, strict=True)):
        texts = [row[i].plain for row in cells]
        right = any(texts) and all(map(_is_number, texts))
        head = "\n".join(wrap(column, width, **console.WHOLE)).replace("\N{NO-BREAK SPACE}", " ")
        table.add_column(head, justify="right" if right else "left", width=width)
    for row in cells:
        table.add_row(*row)
    console.out().print(table, soft_wrap=False)


def _is_number(text: str) -> bool:
    """Whether a cell is a number, also one with its error or a bound, or empty, or what stands in the place of one."""
    number = r"[-+\u2212]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?"
    return bool(re.fullmatch(rf"(less than )?{number}( ± {number})?|\(.* ± .*\)e[-+]\d+|nan|inf|-|everywhere|", text))


def text_of(value: Any) -> str:
    """A value as a cell shows it: a float with the digits of `unit_habits.IN_TABLES`, a dash for None."""
    return "-" if value is None else plain(value, IN_TABLES) if isinstance(value, float) else str(value)


def _cell(value: Any) -> Any:
    from rich.text import Text

    text = "\n".join(map(escaping.line, text_of(value).split("\n")))
    word = next((word for word in sorted(COLOURS, key=len, reverse=True) if text.startswith(word)), None)
    return Text(text, style=COLOURS[word] if word else "")
