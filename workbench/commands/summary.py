"""The command summary: print what a stored dataset holds."""

from pathlib import Path
from typing import Any

from ..data import law_verdicts
from ..run.summary import summary
from . import console


def summarise(path: Path, json: bool) -> int:
    """Print what the file holds; always 0, as that is what was asked. Raises `InputError`."""
    told = summary(path)
    if json:
        console.print_json(told)
    else:
        _print(told)
    return 0


def _print(told: dict[str, Any]) -> None:
    reading = f", {told['reading']}" if told["reading"] else ""
    console.say(f"{told['title']}{reading}")
    size = f"{told['bytes'] / 1e6:.3g} MB" if told["bytes"] >= 1e6 else f"{told['bytes'] / 1e3:.3g} kB"
    console.say(f"{told['file']}: {size}, format {told['format']}, study {told['study_name']}, made {told['created']}")
    console.say(f"method {told['method']}, tolerance {told['tolerance']:g}; {_versions(told['versions'])}")
    along = f"{', '.join(told['along'])} at {told['stations']} stations" if told["along"] else "nothing"
    console.say(f"along the rod: {along}")
    console.say("")
    rows = [[a["name"], a["count"], a["from"], a["to"], a["units"]] for a in told["axes"]]
    console.print_table(["axis", "values", "from", "to", "units"], rows or [["(none)", "", "", "", ""]])
    console.say("")
    if told["observables"]:
        rows = [[_cell(o[key]) for key in ("name", "min", "median", "max", "units")] for o in told["observables"]]
        console.print_table(["observable", "min", "median", "max", "units"], rows)
        console.say("")
    console.say(f"{told['cases']} cases, {told['unsolved']} unsolved")
    for text, count in told["outcomes"].items():
        console.say(f"  {count} x {text}")
    for worst in told["worst"]:
        at = ", ".join(f"{name} = {value:.6g}" for name, value in worst["at"].items())
        console.say(f"largest {worst['name']}: {_cell(worst['value'])}{f' at {at}' if at else ''}")
    for name in ("equilibria", "branches"):
        if told[name]:
            console.say(told[name])
    if told["caution"]:
        console.say(f"caution: {told['caution']}")
    if told["laws"]:
        console.say("")
        console.print_table(["law", "", "verdict"], [[v["claim"], v["stated"], v["said"]] for v in told["laws"]])
        console.say(law_verdicts.tallied(told["laws"]))


def _cell(value: Any) -> Any:
    return "-" if value is None else f"{value:.6g}" if isinstance(value, float) else value


def _versions(versions: dict[str, str]) -> str:
    return ", ".join(f"{name} {number}" for name, number in versions.items())
