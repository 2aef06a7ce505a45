"""The laws in the report: sentences, verdicts with their reasons, the claims, and the table of all readings."""

import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from studies.laws import law_words
from studies.laws.line_verdicts import FAILS, HOLDS, QUALIFIED, TREND, UNDECIDED, worst

from ...words import labels

CLASSES = {HOLDS: "holds", TREND: "trend", QUALIFIED: "qualified", UNDECIDED: "undecided", FAILS: "fails"}


def law_of(ds: xr.Dataset, row: Mapping[str, Any]) -> dict[str, Any]:
    """One law and the other observables that it names, as text."""
    words = labels.long_name(ds[row["observable"]])
    return {
        "claim": row["claim"],
        "source": row["source"],
        "words": words,
        "stated": labels.typeset(law_words.law_in_words(row, words, labels.axis_symbol(row["axis"]))),
        "name": row["observable"],
        **_verdict(row, ds[row["observable"]]),
        "fixed": row["fixed"] or "not stated",
        "fixed_note": row["fixed_note"] or "",
        "also": [
            {
                "stated": labels.long_name(ds[also["observable"]]),
                "name": also["observable"],
                "role": f"{law_words.role(also)}:",
                **_verdict({**also, "axis": row["axis"]}, ds[also["observable"]]),
            }
            for also in row["also"]
        ],
    }


def _verdict(row: Mapping[str, Any], array: xr.DataArray) -> dict[str, str]:
    return {
        "verdict": row["verdict"],
        "class": CLASSES[row["verdict"]],
        "plain": law_words.PLAIN[row["verdict"]].capitalize(),
        "measured": _measure(row, array),
        "detail": labels.law_text(row, law_words.detail(row)),
    }


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
            verdict = worst([law["verdict"], claim["verdict"]])
            claim["judged"] = " and ".join(dict.fromkeys(_criterion(row) for row in claim["laws"]))
            claim |= {"verdict": verdict, "class": CLASSES[verdict], "plain": law_words.PLAIN[verdict].capitalize()}
    return list(claims.values())


def _criterion(law: Mapping[str, Any]) -> str:
    """``the number of bends (or the bend number)``: the observable of a law, and its alternatives."""
    others = ", ".join(also["stated"] for also in law["also"] if also["role"].startswith("alternative"))
    return f"the {law['words']}{f' (or {others})' if others else ''}"


def of_readings(readings: xr.Dataset | None) -> dict[str, Any] | None:
    """The table reading x claim: in each cell the verdict and the measured observables."""
    if readings is None:
        return None
    claims = [str(claim) for claim in readings["claim"].values]
    by_reading = json.loads(readings.attrs["rows"])
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
                    "verdict": verdict,
                    "plain": law_words.PLAIN[verdict].capitalize(),
                    "class": CLASSES[verdict],
                    "measured": measured,
                    "reason": sentence(_short(verdict, laws)),
                    "why": labels.typeset(
                        in_degrees("; ".join(f"{row['observable']}: {law_words.sentence(row)}" for row in laws))
                    ),
                }
            )
        counts = law_words.count(Counter(str(cell["verdict"]) for cell in cells))
        table.append({"name": reading, "words": reading.split("/"), "cells": cells, "counts": counts})
    return {"claims": claims, "rows": table}


def sentence(text: str) -> str:
    """A remark as a sentence; a Greek letter at its beginning is kept."""
    typeset = labels.typeset(in_degrees(text))
    return f"{typeset[0].upper() if typeset[0].isascii() else typeset[0]}{typeset[1:]}." if typeset else ""


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
        others = [
            f"along {labels.axis_symbol(row['axis'])} it is {law_words.PLAIN[row['verdict']]}"
            for row in laws
            if row["lines"]
        ]
        first = labels.law_text(untested[0], untested[0]["reason"])
        return law_words.join([first, *others])
    kinds = dict.fromkeys(kind for row in laws for kind in row["qualifications"])
    return ", ".join(kinds) if verdict == QUALIFIED else ""
