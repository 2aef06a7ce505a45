"""Monotone pieces of G along an orbit, each with a variable in which time is smooth: eq. (36), regularised.

On each piece one change of variables makes dt/du smooth however near a saddle the orbit passes: x = a sinh(u) over a
saddle that the orbit passes, x = x1 cosh(u) where it turns before the saddle, x = x1 sin(u) where it turns nearer the
centre. x is the distance from that saddle or centre.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import Array, Integers
from .local_potential import LocalPotential

PASS, SADDLE, CENTRE = 0, 1, 2
HELIX, LIBRATION, ROTATION = 0, 1, 2
_UNCERTAIN = 64.0  # times the rounding of an angle: how much the rounding of G may move the start


@dataclass(frozen=True, eq=False)
class Pieces:
    """P monotone pieces of arcs, in the order in which the orbit passes them away from its start.

    arc: (P,), 2 b for the forward arc of problem b, 2 b + 1 for the backward one. rank: (P,), 0 for the piece with the
    start, then counting away from it. kind: (P,), PASS, SADDLE or CENTRE. base: (P,), the angle from which x counts.
    scale: (P,), a or x1, signed. u0, u1: (P,), the near and the far end in u. local: G about `base`.
    """

    arc: Integers
    rank: Integers
    kind: Integers
    base: Array
    scale: Array
    u0: Array
    u1: Array
    local: LocalPotential

    def take(self, index: Any) -> "Pieces":
        fields = (self.arc, self.rank, self.kind, self.base, self.scale, self.u0, self.u1)
        arc, rank, kind, base, scale, u0, u1 = (v[index] for v in fields)
        return Pieces(arc, rank, kind, base, scale, u0, u1, self.local.take(index))

    @classmethod
    def from_core(cls, table: Array) -> "Pieces":
        """The pieces that the core made, (P, 17): see `rod_orbits_fetch`."""
        arc, rank, kind = table[:, :3].T.astype(np.int64)
        base, scale, u0, u1 = table[:, 3:7].T
        lam, mu, phi, o, level, *fixed = (table[:, k : k + 1] for k in range(7, table.shape[1]))
        return cls(arc, rank, kind, base, scale, u0, u1, LocalPotential(lam, mu, phi, o, level, tuple(fixed)))

    def displacement(self, u: Array) -> Array:
        """x at u (P, n)."""
        return self.scale[:, None] * _by_kind(self.kind, u, (np.sinh, np.cosh, np.sin))

    def pace(self, u: Array, x: Array) -> tuple[Array, Array]:
        """dt/|du| and |beta_t| at u, x (P, n)."""
        scale = self.scale[:, None]
        passes = self.kind == PASS
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            if passes.all():
                root = self._passing(x, scale)
            elif passes.any():
                root = np.where(passes[:, None], self._passing(x, scale), self._turning(x, scale))
            else:
                root = self._turning(x, scale)
            stretch = _by_kind(self.kind, u, (np.cosh, np.sinh, np.cos))
            return 1 / root, np.abs(scale * stretch) * root

    def _passing(self, x: Array, scale: Array) -> Array:
        return np.sqrt(self.local.speed2(x) / (x * x + scale * scale))

    def _turning(self, x: Array, scale: Array) -> Array:
        return _turning(self.local, x, scale)


def _turning(local: LocalPotential, x: Array, scale: Array) -> Array:
    """beta_t over sqrt(x1^2 - x^2), kept above zero where the turning point is next to a helix."""
    return np.sqrt(np.maximum(np.abs(local.ratio(x, scale)), local.faintest))


def _by_kind(kind: Any, u: Array, functions: tuple[Any, Any, Any]) -> Array:
    """The function of each row's kind at u (P, n)."""
    out = np.empty_like(u)
    with np.errstate(over="ignore"):
        for value, function in enumerate(functions):
            rows = kind == value
            if rows.any():
                out[rows] = function(u[rows])
    return out


def scales(local: LocalPotential, passes: Any, limit: Array) -> Array:
    """x1 where the orbit turns; a, the distance from the saddle at which the speed grows, where it passes, (P,)."""
    scale = np.empty(limit.size)
    turn = np.flatnonzero(~passes)
    if turn.size:
        scale[turn] = local.take(turn).turning(limit[turn])
    over = np.flatnonzero(passes)
    if over.size:
        scale[over] = _passing_scale(local.take(over), limit[over])
    return scale


def _passing_scale(local: LocalPotential, limit: Array) -> Array:
    """a of x = a sinh(u), (P,)."""
    level = local.level[:, 0]
    bend = local.steepness(np.zeros((limit.size, 1)))[:, 0] / 4
    with np.errstate(divide="ignore", invalid="ignore"):  # a float may not hold the squares
        rise = local.drop(limit[:, None])[:, 0] / limit**2
        a = np.sqrt(level / np.maximum(bend, rise))
    flat = np.flatnonzero((bend < 0.01 * rise) & (level < 0.1 * rise * limit**2))
    if flat.size:  # a saddle with next to no curvature: the speed grows with a higher power of x
        a[flat] = np.abs(local.take(flat).turning(limit[flat]))
    return np.where(np.isfinite(a), np.minimum(a, 1e8), 1e8)


def variable(form: Any, scale: Array, x: Array) -> Array:
    """u at x, (P,)."""
    ratio = x / scale
    return np.where(
        form == PASS,
        np.arcsinh(ratio),
        np.where(form == SADDLE, np.arccosh(np.maximum(ratio, 1)), np.arcsin(np.clip(ratio, -1, 1))),
    )


def start_variable(
    form: Any, scale: Array, x: Array, v: Array, first: Any, local: LocalPotential
) -> tuple[Array, Array]:
    """u at the start, from beta_t, which loses no digits next to a turning point; and the scale, (P,) each.

    Where G is so flat that its rounding leaves the turning point of a `first` piece uncertain, the turning point is
    moved to agree with angle and beta_t at the start; where it leaves beta_t uncertain, u follows from the angle.
    """
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        root = _turning(local, x[:, None], scale[:, None])[:, 0]
        sine = np.where(v == 0, 0.0, np.abs(v) / (np.abs(scale) * root))
        slanted = np.where(form == SADDLE, np.arcsinh(sine), np.arctan2(np.abs(x / scale), sine))
        u = np.where(form == PASS, np.arcsinh(x / scale), slanted)
        doubt = np.where(first & (form != PASS), local.weight(np.abs(x)) / root**2, 0)
        uncertain = doubt > _UNCERTAIN
        if uncertain.any():
            lost = uncertain & (doubt * sine**2 > _UNCERTAIN)
            moved = x / np.where(form == SADDLE, np.cosh(u), np.sin(u))
            scale = np.where(uncertain & ~lost, moved, scale)
            u = np.where(lost, variable(form, scale, x), u)
        return u, scale
