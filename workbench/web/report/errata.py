"""The misprints of the paper: where, what is printed, what is right, and why.

In `printed` and `right`, `_{...}` is a subscript, `^{...}` a superscript, and `~` a space at which no line ends.
"""

import re
from html import escape
from typing import NamedTuple

RAISED = {"_": "sub", "^": "sup"}


class Erratum(NamedTuple):
    """One misprint."""

    where: str
    printed: str
    right: str
    why: str


ERRATA = (
    Erratum(
        "eq. (13), row 2, column 2",
        "−sin~α~sin~γ~−~cos~β~cos~α~cos~γ",
        "−sin~α~sin~γ~+~cos~β~cos~α~cos~γ",
        "the columns are unit vectors at right angles; with the printed sign the second is neither",
    ),
    Erratum(
        "eq. (14), row 1",
        "α′~+~β′~cos~γ",
        "α′~sin~β~sin~γ~+~β′~cos~γ",
        "a component of the rotation rate; without the factor it does not vanish with sin β",
    ),
    Erratum("eq. (15), row 3", "dξ/ds", "dζ/ds", "the third row is the axial coordinate"),
    Erratum(
        "eq. (16), third component",
        "∂g/∂ξ_{c}, twice",
        "∂g/∂ζ_{c}",
        "the normal of eq. (12); with the printed one the push has a part along the rod, which the next line denies",
    ),
    Erratum(
        "eq. (20)",
        "A~=~B~=~(π/16)~E~a⁴",
        "(π/4)~E~a⁴",
        "the second moment of a solid circular section of radius a; the ratio C/A is right. The workbench has both, as "
        "stiffness “paper” and “solid”",
    ),
    Erratum("eq. (24), row 5", "α″", "α″~sin~β", "the factor was lost; with it the row gives the F₁ of eq. (33)"),
    Erratum("eq. (28)", "ω₃₀", "ω₃₀²", "an energy is quadratic in the twist"),
    Erratum(
        "eqs. (32), (33)",
        "R",
        "ρ~=~R~+~a",
        "the curvature belongs to the centreline, which lies at ρ (inside: ρ = R − a)",
    ),
    Erratum(
        "eq. (34)",
        "[h~−~G(β)]^{−1/2} before the brace",
        "no such factor",
        "the contact force would be infinite at every turning point",
    ),
    Erratum(
        "eq. (35)",
        "G′(χ)/2, and β² in the last denominator",
        "G′(β)/2, and ρ²",
        "H is half the derivative of G by its own argument",
    ),
    Erratum(
        "eq. (36)",
        "one sign of the root",
        "each sign on its own interval",
        "it holds between turning points only: β′ changes its sign at each of them",
    ),
    Erratum(
        "eqs. (41), (42)",
        "v/(hh), and p_{k}~y_{k−1}~+~q_{k}~y_{k}~+~r_{k}~y_{k+1}~d_{k}",
        "v/(2h), and p_{k}~y_{k−1}~+~q_{k}~y_{k}~+~r_{k}~y_{k+1}~=~d_{k}",
        "the central difference (40); without “=” the row is no equation",
    ),
    Erratum(
        "Table 1",
        "F₁₀ and γ₀′",
        "one of the two",
        "γ₀′ = 0.5 implies F₁₀ = −2.268 N and not 5 N; F₂₀ and β(L) are not given, nor the sign convention of F₃₀. "
        "Hence the twelve readings",
    ),
)


def mark_up(text: str) -> str:
    """A text of `ERRATA` as HTML; no line ends within a formula."""
    return " ".join(_term(escape(word)) for word in text.split(" "))


def _term(word: str) -> str:
    """A word, or a formula, whose spaces are written as `~`."""
    raised = re.sub(r"([_^])\{([^}]*)\}", lambda match: f"<{RAISED[match[1]]}>{match[2]}</{RAISED[match[1]]}>", word)
    return f'<span class="term">{raised.replace("~", " ")}</span>' if re.search(r"[~_^/]", word) else raised
