"""The state of a pipe along its length, in words: straight, sinusoidal or helical, each with where it is."""

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ..numerics.arrays import Array, Booleans, integral
from ..orbits.potential import TAU
from ..problem.case import ALONG_AXIS, ALONG_ITSELF, SIDES, Cylinder

STRAIGHT, SINUSOIDAL, HELICAL = "straight", "sinusoidal", "helical"
# rad of azimuth from one bend to the next: less is straight, as one sees it. x10: sinusoids count as straight
BENT = 0.1
# of the azimuth of the bend before: so bends die away in a straight rod below 0.97 of its buckling load. x10: every
# sinusoid counts as a turn at an end
DYING = 0.7
# of a bend: a straight piece beside it that is shorter is a part of it. x10: the tail of a bend is none
SHORT = 0.25
# of the largest push along the rod: a smaller one is none, a hundred times the default tolerance. x10: as good
SLIGHT = 1e-6
ROUNDING = 1e-13  # of A/rho^3: a smaller pull is none. x10: as good
LEAVES, RUBS = "leaves its branch", "buckles where friction"  # what a rod does on its way from the straight one


class StretchState(NamedTuple):
    """A stretch of a rod in one state, from one s to another [length]. turned: the azimuth that its first bend goes."""

    word: str
    begin: float
    end: float
    turned: float = 0.0


def least_pull(largest: Any, unit: Any = 1.0) -> Any:
    """The pull that a stretch of a rod has to reach somewhere to be one where the rod would lift off.

    largest: the largest size of the push along the rod. unit: A/rho^3.
    """
    return SLIGHT * largest + ROUNDING * unit


def azimuths(s: Array, alpha: Array, radius: Array, error: float) -> Array:
    """The azimuth along a rod at places s (n,).

    Nearer to the axis than the error of a place a rod has none: that of the next place; 0 where it has none all along.

    alpha: as computed, (n,). radius: the distance from the axis, (n,), in the unit of the error.
    """
    off = radius > error
    return np.interp(s, s[off], alpha[off]) if off.any() else np.zeros(s.shape)


def is_drawn(axial: Array, push: Array) -> Booleans:
    """Where a rod is in tension and the wall does not push, (n,), from the axial force and the push there."""
    drawn: Booleans = (axial > 0) & (push <= SLIGHT * np.abs(push).max())
    return drawn


def axial_force_along(wall: Cylinder, weight: float, FZ: float, s: Array, beta: Array, push: Array) -> Array:
    """FZ at places s (n,), from that at the far end, the weight per length and the friction, by trapezoids [force]."""
    sign, way = wall.sense
    turning = SIDES[wall.side] * np.sin(beta)
    share = np.cos(beta) if way == ALONG_ITSELF else np.ones(beta.shape) if way == ALONG_AXIS else turning
    inclination, friction = (float(value or 0.0) for value in (wall.inclination, wall.friction))
    density = weight * np.cos(inclination) + sign * friction * push * share
    added = integral(density, s)
    return np.asarray(FZ + added - added[-1])


def ends_turn(lies: bool, is_azimuth_held: bool) -> tuple[bool, bool]:
    """Whether a bend from the start, and one from the far end, may be the turn from the azimuth there to where the rod
    lies. lies: whether weight acts across the axis; else no place is lower. A far end whose azimuth is free lies too.
    """
    return lies, lies and is_azimuth_held


def states(
    s: Array, beta: Array, alpha: Array, drawn: Booleans | None = None, turns: tuple[bool, bool] = (True, True)
) -> tuple[StretchState, ...]:
    """The states along a rod, from its values at places s (n,), dense enough to show each change of sign of beta.

    Between two changes of sign the azimuth goes one way. There the rod is helical if it goes once round or more, or if
    beta at both ends is more than half of its largest, as on a part of a hoop; straight if it goes less than `BENT`,
    else sinusoidal. The tail of a bend, where beta is less than half of its largest, is straight as far as it goes less
    than `BENT`, or, of a bend of less than once round, that share of its azimuth: beside a helix next to a straight
    piece, or at an end of the rod where it is longer than half a turn of the helix; beside a sinusoid where it is
    longer than `SHORT` of it. Two helices that meet turn in different senses. Bends from an end to a straight stretch
    are straight too where each is at most `DYING` of the one before: there the rod turns from the azimuth of its end to
    where it lies.

    drawn: of `is_drawn`, (n,). What would be helical is straight there: tension draws the rod from one azimuth to
    another, and no load buckles it. turns: whether the rod may so turn at its start, and at its far end: where the
    azimuth of that end is free, or no weight across tells it where to lie, a bend there has buckled.
    """
    aside = np.flatnonzero(beta)  # a beta of exactly 0 lies within a crossing
    change = np.sign(beta[aside[1:]]) != np.sign(beta[aside[:-1]])
    before, after = aside[:-1][change], aside[1:][change]
    zeros = s[before] + (s[after] - s[before]) * beta[before] / (beta[before] - beta[after])
    at = np.searchsorted(s, zeros)  # they are places too, so that the states of a reversed rod are the same
    drawn = drawn if drawn is None else np.insert(drawn, at, drawn[at])
    s, beta, alpha = (
        np.insert(row, at, values) for row, values in ((s, zeros), (beta, 0.0), (alpha, np.interp(zeros, s, alpha)))
    )
    crossings = at + np.arange(at.size)
    cuts = [0, *crossings, s.size - 1]
    pieces = [piece for a, b in pairwise(cuts) if b > a for piece in _without_drawn(a, b, alpha, drawn)]
    parts, inner = list[StretchState](), list[tuple[float, float]]()
    bent = [False, *(turned >= BENT for *_, turned in pieces), False]
    for (first, last, turned), *around in zip(pieces, bent, bent[2:], strict=False):
        way, size = np.abs(alpha[first : last + 1] - alpha[first]), np.abs(beta[first : last + 1])
        wound = (size[[0, -1]] > size.max() / 2) & ~np.isin([first, last], crossings)
        helical, tail = turned >= TAU or wound.all(), BENT * min(1.0, turned / TAU)
        leaves, arrives = np.interp([tail, turned - tail], way, s[first : last + 1])
        short = SHORT * (arrives - leaves)
        whole = around if helical else [leaves - s[first] < short, s[last] - arrives < short]
        word = STRAIGHT if turned < BENT else HELICAL if helical else SINUSOIDAL
        parts.append(StretchState(word, s[first], s[last], turned))
        inner.append((s[first] if wound[0] or whole[0] else leaves, s[last] if wound[1] or whole[1] else arrives))
    for turn in turns:
        parts = (_without_end_turns(parts) if turn else parts)[::-1]
    return tuple(_join(_without_tails(parts, inner)))


def _without_tails(stretches: list[StretchState], inner: list[tuple[float, float]]) -> list[StretchState]:
    """The stretches, each that is not straight cut to its inner part; the rest of it is straight."""
    parts = list[StretchState]()
    for part, (leaves, arrives) in zip(stretches, inner, strict=True):
        if part.word == STRAIGHT:
            parts.append(part)
            continue
        before, after = StretchState(STRAIGHT, part.begin, leaves), StretchState(STRAIGHT, arrives, part.end)
        parts += [before, part._replace(begin=leaves, end=arrives), after]
    return [part for part in parts if part.end > part.begin]


def _without_drawn(first: int, last: int, alpha: Array, drawn: Booleans | None) -> list[tuple[int, int, float]]:
    """A stretch on which beta keeps its sign: from one place to another, and the azimuth that it goes.

    One that goes once round or more is cut where it is `drawn`, and goes no azimuth there.
    """
    whole = float(abs(alpha[last] - alpha[first]))
    if whole < TAU or drawn is None or not drawn[first : last + 1].any():
        return [(first, last, whole)]
    inner = drawn[first : last + 1]
    cuts = [first, *(first + np.flatnonzero(inner[1:] != inner[:-1]) + 1), last]
    return [(a, b, 0.0 if drawn[a] else float(abs(alpha[b] - alpha[a]))) for a, b in pairwise(cuts) if b > a]


def _without_end_turns(stretches: list[StretchState]) -> list[StretchState]:
    """The stretches, whose first bends are straight if they die away and straight ones follow.

    A straight stretch at the end itself that is shorter than the bend after it is a part of the turn.
    """
    words = [part.word for part in stretches]
    lengths = [part.end - part.begin for part in stretches]
    first = int(words[:2] == [STRAIGHT, SINUSOIDAL] and lengths[0] < lengths[1])
    bends = words.index(STRAIGHT, first) if STRAIGHT in words[first:] else 0
    die = all(later.turned <= DYING * part.turned for part, later in pairwise(stretches[first:bends]))
    if set(words[first:bends]) != {SINUSOIDAL} or not die:
        return stretches
    return [part._replace(word=STRAIGHT) for part in stretches[:bends]] + stretches[bends:]


def _join(stretches: list[StretchState]) -> list[StretchState]:
    """Neighbours of the same state as one, but for helices; a short straight piece next to bends joins them."""
    kept: list[StretchState] = []
    longest = max((part.end - part.begin for part in stretches if part.word == SINUSOIDAL), default=0.0)
    for i, part in enumerate(stretches):
        word, around = part.word, [other.word for other in stretches[max(0, i - 1) : i + 2] if other is not part]
        if word == STRAIGHT and STRAIGHT not in around:
            room = longest if len(around) == 2 else SHORT * longest * (around == [SINUSOIDAL])
            word = SINUSOIDAL if SINUSOIDAL in around and part.end - part.begin < room else word
        if kept and kept[-1].word == word != HELICAL:
            kept[-1] = StretchState(word, kept[-1].begin, float(part.end))
        else:
            kept.append(StretchState(word, float(part.begin), float(part.end), part.turned))
    for _ in range(2):  # the states are the same from either end
        kept = _without_end_layer(kept)[::-1]
    return kept


def _without_end_layer(stretches: list[StretchState]) -> list[StretchState]:
    """The stretches, without a straight one at the start that is shorter than half a turn of the helix after it."""
    if [part.word for part in stretches[:2]] != [STRAIGHT, HELICAL]:
        return stretches
    layer, helix = stretches[:2]
    if layer.end - layer.begin >= (helix.end - helix.begin) * TAU / 2 / max(helix.turned, TAU / 2):
        return stretches
    joined = helix._replace(begin=min(layer.begin, helix.begin), end=max(layer.end, helix.end))  # or from the far end
    return [joined, *stretches[2:]]


def _place(s: float) -> str:
    """An arc length with four digits, and no exponent: ``10560``, ``8.498``."""
    return f"{s:.4g}" if s < 9999.5 else f"{s:.0f}"


def in_words(parts: tuple[StretchState, ...], unit: str = "") -> str:
    """``straight from 0 to 12 m, sinusoidal to 288 m, straight to 300 m``."""
    unit = unit and f" {unit}"
    parts = tuple(part for part in parts if _place(part.begin) != _place(part.end))
    if len(parts) == 1:
        return f"{parts[0].word} all along"
    words = [part.word for part in parts]
    words = [f"{b} the other way" if a == b == HELICAL else b for a, b in pairwise(["", *words])]
    ends = [f"{'from 0 ' if i == 0 else ''}to {_place(part.end)}{unit}" for i, part in enumerate(parts)]
    return ", ".join(f"{word} {end}" for word, end in zip(words, ends, strict=True))
