"""Orbits that stay at a saddle for longer than a gap in floating point can express: panels at rest are inserted."""

from dataclasses import replace
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..orbit.panels import Panels, join
from ..orbit.periodic_orbit import Orbit, assemble
from .transit_times import half_passages


def with_saddle_panels(brief: Orbit, span: Array, gap: Array, excess: Array) -> Orbit:
    """The orbits with panels in which the rod stays at the saddle from which its level is measured.

    brief: the orbits of a level with the float `gap` (B,). span: (B,), their true lengths. excess: (B,), by how much
    the log of the true gap is smaller. On the new panels beta is the angle of the saddle, to within the root of the
    gap, and alpha, z and the swirl grow evenly.
    """
    pieces = brief.arcs.pieces
    stay = half_passages(pieces, gap) * excess[pieces.arc // 2]
    end, piece = np.nonzero(stay)
    panels = brief.panels
    series = panels.series.copy()
    near = series.copy()
    near[..., 1::2] *= -1
    series[:, 2:, 0] -= near[:, 2:].sum(axis=2)  # integrals from each panel's own near end
    duration = stay[end, piece]
    rest = _still(panels, pieces.base[piece], duration)
    still = Panels(pieces.arc[piece], pieces.rank[piece], duration, *rest)
    every = join([replace(panels, series=series), still])
    place = np.concatenate([np.zeros(panels.arc.size), np.where(end == 0, -1, 1)])
    number = np.concatenate([np.arange(panels.arc.size), np.arange(piece.size)])
    every = every.take(np.lexsort((number, place, every.rank, every.arc)))
    return assemble(replace(brief.problem, span=span), brief.arcs, every)


def _still(panels: Panels, angle: Array, duration: Array) -> tuple[Any, ...]:
    """Series and errors of panels at rest at the angles (P,), in the shape of the others."""
    P = angle.size
    series = np.zeros((P, *panels.series.shape[1:]))
    s, c = np.sin(angle), np.cos(angle)
    series[:, 0, 0] = angle
    for k, rate in enumerate((s, c, s * c)):
        series[:, 2 + k, 0] = series[:, 2 + k, 1] = rate * duration / 2
    none = np.zeros(P)
    return series, none, none, none, none, np.zeros(P, dtype=panels.calls.dtype)
