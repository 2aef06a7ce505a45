"""One case as a person reads it: tables of what is given and found; of a pipe, what is asked of it."""

import math
from typing import Any

from . import console

PROFILE = ("start", "middle", "largest", "at", "far")
HEADLINES = (
    "turns", "wraps", "height", "kappa_max", "bending_moment_max", "F3_size_max", "push_min", "push_max", "attached",
    "index",
)  # fmt: skip


def print_case(found: dict[str, Any], every: bool, whole: bool) -> None:
    """Print a case. whole: with tables of what is given and found; else what an engineer asks of a pipe."""
    if whole:
        _print_tables(found, every)
    else:
        console.say_units(found["units"])
        console.say(", ".join(_given(found)))
    console.say("")
    accuracy = (
        f": error {found['error']:.1e}, condition {found['condition']:.3g}" if math.isfinite(found["error"]) else ""
    )
    console.say(f"{found['outcome']} ({found['method']}, tolerance {found['tolerance']:g}{accuracy})")
    if found["which"]:
        console.say(found["which"])
    for sentence in found["pipe"]:
        console.say(sentence)
    if found["profile"]:
        _print_profile(found)
    if found["begun"] and not found["pipe"]:
        console.say(f"held: {', '.join(found['held'])}; the search began at {found['begun']}")
    if found["indices"]:
        console.say("index " + ", ".join(f"{index} under {loading}" for loading, index in found["indices"].items()))
    for sentence in found["warnings"]:
        console.say(sentence)
    if found["caution"] and not found["profile"]:
        console.say(f"caution: {found['caution']}")
    if found["left_out"]:
        console.say(found["left_out"])


def _print_profile(found: dict[str, Any]) -> None:
    """The numbers along a pipe: at its ends, the mean of its middle third, and the largest."""
    heads = ["", "unit", "s = 0", "middle", "largest", f"at s ({found['units']['length']})", "s = L"]
    rows = [[row["name"], row["unit"], *(f"{row[name]:.4g}" for name in PROFILE)] for row in found["profile"]]
    console.say("")
    console.print_table(heads, rows)
    console.say("middle: the mean of the middle third\n")


def _given(found: dict[str, Any]) -> list[str]:
    """What a case is given, as ``L = 300``; angles in degrees."""
    from studies.grammar.axes import in_words

    given = {name: value for name, value in found["case"].items() if name not in found["assumed"]}
    return [f"{name} {value}" if isinstance(value, str) else in_words(name, value) for name, value in given.items()]


def _print_tables(found: dict[str, Any], every: bool) -> None:
    from solver.problem.quantities import quantity
    from studies.grammar.axes import quantity_of

    console.say(f"rod: {found['source']}")
    console.say_units(found["units"], found["assumed"])
    if found["assumed"]:
        console.say(f"assumed: {', '.join(f'{name} = {value}' for name, value in found['assumed'].items())}")
    console.say("")
    rows = []
    for name, value in found["case"].items():
        row = None if isinstance(value, str) else quantity_of(name)
        unit = _unit(row.name, found) if row else ""
        turned = math.degrees(value) if unit == "rad" else 0.0
        degrees = f" ({turned:.6g} deg)" if turned and math.isfinite(turned) else ""
        shown = f"{value:.10g}" if isinstance(value, float) else value
        rows.append([name, shown, unit, f"{row.long_name}{degrees}" if row else ""])
    console.print_table(["given", "value", "unit", ""], rows)
    console.say("")
    if results := _results(found):
        plain = set(found["observables"]) | set(found["case"]) - set(HEADLINES)  # a load that is given stands above
        shown = [name for name in results if every or name in HEADLINES or name not in plain]
        console.print_table(
            ["found", "value", "unit", ""],
            [[name, results[name], _unit(name, found), quantity(name).long_name] for name in shown],
        )
        if more := len(results) - len(shown):
            console.say(f"{more} more numbers with --all")


def _results(found: dict[str, Any]) -> dict[str, float]:
    """Loads, reactions and observables; of an unsolved case those that are known, or none if no observable is known."""
    results = {**found["loads"], **found["reactions"], **found["observables"]}
    if found["solved"] and not found["pipe"]:
        return results
    known = {name: value for name, value in results.items() if not math.isnan(value)}
    return known if known.keys() & found["observables"].keys() else {}


def _unit(name: str, found: dict[str, Any]) -> str:
    from solver.problem.quantities import unit_of

    unit = unit_of(name, found["units"])
    return "" if unit == "1" else unit
