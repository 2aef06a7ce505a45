"""The laws in the report: sentences, verdicts with their reasons, the claims and their mechanics, and all readings."""

import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from studies.laws import law_words
from studies.laws.line_verdicts import FAILS, HOLDS, QUALIFIED, TREND, UNDECIDED, worst
from studies.paper.readings import DEFAULT, parse

from ..stored.stored_study import StoredStudy
from ..words import labels

CLASSES = {HOLDS: "holds", TREND: "trend", QUALIFIED: "qualified", UNDECIDED: "undecided", FAILS: "fails"}


def law_of(stored: StoredStudy, row: Mapping[str, Any]) -> dict[str, Any]:
    """One law and the other observables that it names, as text."""
    words = labels.long_name(stored[row["observable"]])
    return {
        "claim": row["claim"],
        "source": row["source"],
        "words": words,
        "stated": labels.typeset(law_words.law_in_words(row, words, labels.axis_symbol(row["axis"]))),
        "name": row["observable"],
        **_verdict(row, stored[row["observable"]]),
        "fixed": row["fixed"] or "not stated",
        "fixed_note": row["fixed_note"] or "",
        "also": [
            {
                "stated": labels.long_name(stored[also["observable"]]),
                "name": also["observable"],
                "role": f"{law_words.role(also)}:",
                **_verdict({**also, "axis": row["axis"]}, stored[also["observable"]]),
            }
            for also in row["also"]
        ],
    }


def _verdict(row: Mapping[str, Any], array: xr.DataArray) -> dict[str, str]:
    return {
        **_in_plain(row["verdict"]),
        "measured": _measure(row, array),
        "detail": labels.law_text(row, law_words.detail(row)),
    }


def _in_plain(verdict: str) -> dict[str, str]:
    """A verdict, its class in the style of the report, and its words."""
    return {"verdict": verdict, "class": CLASSES[verdict], "plain": verdict.capitalize()}


def _measure(row: Mapping[str, Any], array: xr.DataArray) -> str:
    """What was measured; the values of an angle at the two ends of the axis in degrees."""
    if not labels.is_angle(array) or row["found"]:
        return labels.typeset(law_words.measure(row))
    ends = {key: np.degrees(row[key]).tolist() for key in ("first", "last") if row[key]}
    return labels.typeset(law_words.measure({**row, **ends}).replace(" →", "° →") + "°")


def claims_of(sections: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Each claim with its section, its laws, their worst verdict, and that verdict in plain words."""
    claims: dict[str, dict[str, Any]] = {}
    for section in sections:
        for law in section["laws"]:
            claim = claims.setdefault(law["claim"], {**section, **law, "laws": []})
            claim["laws"].append(law)
            claim["judged"] = " and ".join(dict.fromkeys(_criterion(row) for row in claim["laws"]))
            claim |= _in_plain(worst([law["verdict"], claim["verdict"]]))
    return list(claims.values())


def _criterion(law: Mapping[str, Any]) -> str:
    """``the number of bends (or the bend number)``: the observable of a law, and its alternatives."""
    others = ", ".join(also["stated"] for also in law["also"] if also["role"].startswith("alternative"))
    return f"the {law['words']}{f' (or {others})' if others else ''}"


def of_readings(readings: StoredStudy | None) -> dict[str, Any] | None:
    """The table reading x claim: in each cell the verdict and the measured observables."""
    if readings is None:
        return None
    claims = [str(claim) for claim in readings["claim"].values]
    by_reading = readings.data("rows")
    table = []
    for reading in map(str, readings["reading"].values):
        cells = []
        for claim in claims:
            laws = [row for row in by_reading[reading] if row["claim"] == claim]
            verdict = worst([row["verdict"] for row in laws])
            measured = [
                f"{labels.symbol_of(row['observable'])} {labels.minus_signs(law_words.measure(row))}"
                for row in laws
                if row["first"]
            ]
            cells.append(
                {
                    **_in_plain(verdict),
                    "measured": measured,
                    "reason": sentence(_short(verdict, laws)),
                    "why": labels.typeset(
                        in_degrees("; ".join(f"{row['observable']}: {law_words.sentence(row)}" for row in laws))
                    ),
                }
            )
        counts = law_words.count(Counter(str(cell["verdict"]) for cell in cells))
        table.append({"name": reading, "words": parse(reading).words, "cells": cells, "counts": counts})
    return {"claims": claims, "rows": table}


def sentence(text: str) -> str:
    """A remark as a sentence; a Greek letter at its beginning is kept."""
    typeset = labels.typeset(in_degrees(text))
    return labels.sentence(typeset) if typeset else ""


def in_degrees(text: str) -> str:
    """The text with its angles in degrees: ``0.6 rad (34.38 deg)`` as ``34.38 deg``; a rate in rad per length stays."""
    return re.sub(
        r"(?<![\w.])([-−]?\d[\d.]*(?:e[-+]?\d+)?) rad\b(?!/)(?: \([^)]*deg\))?",
        lambda match: f"{np.degrees(float(match[1].replace('−', '-'))):.4g} deg",
        text,
    )


def _short(verdict: str, laws: Sequence[Mapping[str, Any]]) -> str:
    """Why a claim was not tested, or why it is true in part only."""
    if untested := [row for row in laws if not row["lines"]]:
        others = [f"along {labels.axis_symbol(row['axis'])} it is {row['verdict']}" for row in laws if row["lines"]]
        first = labels.law_text(untested[0], untested[0]["reason"])
        return law_words.join([first, *others])
    kinds = dict.fromkeys(kind for row in laws for kind in row["qualifications"])
    return ", ".join(kinds) if verdict == QUALIFIED else ""


def mechanism(claim: str, stored: StoredStudy) -> str:
    """Return why the laws of a claim come out as they do under the default reading of Table 1.

    Parameters
    ----------
    claim : str
        Its number in the paper, for example ``"(1)"``.
    stored : StoredStudy
        The stored panel.

    Returns
    -------
    Two or three sentences; none under another reading, which has other loads, and for a claim without a row here.
    """
    explain = MECHANISMS.get(claim)
    return "" if explain is None or stored.attrs.get("reading") != DEFAULT.name else explain(stored)


def _of_modulus(stored: StoredStudy) -> str:
    sweep = _ends(stored["amplitude"] * (180 / np.pi), "{:.0f}°")
    room = _ends(stored["L"] / stored["bend_number"], "{:.2g}") + f" {stored.units['length']}"
    squares = stored["kappa_max"] ** 2 - stored.along("kappa").isel(u=0) ** 2
    drop = _ends(stored.case.rod.bending_stiffness * squares / 2, "{:.3g}") + f" {stored.units['force']}"
    power = labels.minus_signs(f"{np.polyfit(np.log(stored['E']), np.log(stored['kappa_max']), 1)[0]:.2f}")
    return (
        "F₃ + Aκ²/2 is constant along the rod (eq. 27), so κ² grows from the start by 2/A times the drop of tension. "
        f"Down to the sharpest bend it drops by more with E ({drop}), but by less than A grows, so the bend opens: the "
        f"largest κ goes about with E to the power {power}. A bend sweeps about the same angle at every E ({sweep}), "
        f"so it needs more length: {room}."
    )


def _of_radius(stored: StoredStudy) -> str:
    twist = _ends(stored["M3"], "{:.3g}") + f" {_moment(stored)}"
    return (
        f"With F₁₀ and β₀′ given, the twisting moment M₃ = F₁₀/β₀′ + 3A sin 2β₀/(2ρ) falls ({twist}), and so does the "
        "curvature sin²β/ρ that the cylinder imposes: the sharpest bend opens. But the energy of lying across the "
        "axis, A sin⁴β/(2ρ²), falls too, so β swings farther."
    )


def _of_start_angle(stored: StoredStudy) -> str:
    force = _ends(stored["FZ"], "{:.3g}") + f" {stored.units['force']}"
    M3 = stored["M3"].values
    top = int(np.nanargmax(M3))
    at = f" up to {labels.equation(stored['beta0'], float(stored['beta0'].values[top]))}" * (top < M3.size - 1)
    twist = f"{at} (" + labels.minus_signs(f"{M3[0]:.3g} to {M3[top]:.3g} {_moment(stored)}") + ")"
    return (
        "F₁₀ and F₃₀ stay, but a larger β₀ turns F₃₀ away from the axis: the axial tension FZ = F₃₀ cos β₀ falls "
        f"({force}), and the twisting moment M₃ rises{twist}. Less tension and more twist make the bends shorter."
    )


def _of_end_angle(stored: StoredStudy) -> str:
    bends = _ends(stored["bend_number"], "{:.2f}")
    return (
        "The loads stay, and they set most of the spacing of the bends. Turning the far end changes the shape by a "
        f"fraction of one bend ({bends}), until this equilibrium ends at a fold: too little for another whole bend."
    )


def _of_forces(stored: StoredStudy) -> str:
    middle = {name: stored.sizes[name] // 2 for name in ("F1", "F3")}
    with_f1, with_f3 = (
        _ends(100 * stored["attached"].isel({other: middle[other]}), "{:.0f} %") for other in ("F3", "F1")
    )
    return (
        "Larger loads bend the rod more sharply, F₁₀ through the twisting moment and F₃₀ through the tension, and the "
        "contact force grows with them. But pull grows as well as push: the share of the length on which the cylinder "
        f"pushes goes from {with_f1} with F₁₀, and from {with_f3} with F₃₀."
    )


MECHANISMS: dict[str, Callable[[StoredStudy], str]] = {
    "(1)": _of_modulus,
    "(2)": _of_radius,
    "(3)": _of_start_angle,
    "(4)": _of_end_angle,
    "(5)": _of_forces,
}


def _ends(values: xr.DataArray, form: str) -> str:
    """The first and the last value along the axis of a panel."""
    return " to ".join(labels.minus_signs(form.format(float(values.values.flat[k]))) for k in (0, -1))


def _moment(stored: StoredStudy) -> str:
    return labels.unit(f"{stored.units['force']} {stored.units['length']}")
