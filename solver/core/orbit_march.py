"""The march of many orbits, each over its two arcs and no farther."""

from typing import Any

import numpy as np

from .arc_march import LIBRATES, LOST, MOST, NODES, ROTATES, march_arc
from .loader import compiled
from .orbit_condition import beside_helix, condition_of_arcs, error_of_arcs
from .taylor_step import ORDER, ROWS

ESTIMATE = np.dtype([("error", float), ("condition", float)])


@compiled
def march(
    problems: Any,
    goals: Any,
    weights: Any,
    first: int,
    since: Any,
    width: Any,
    series: Any,
    count: Any,
    status: Any,
    arcs: Any,
    estimates: Any,
) -> tuple[int, int]:
    """March problems (B, 6): lam, mu, phi, span, beta0, v0; from number `first` until all are done or memory is full.

    goals, weights: (B,), what a step may leave out, and the weight of a change of beta_t. Fills since, width (P,) and
    series (P, 4, ORDER + 1) with the steps of all arcs in order; count (B, 2), their number; status (B, 2) and arcs
    (B, 2) of `ARC`, forward and backward; estimates (B,) of `ESTIMATE`. Returns how many problems and steps are done.
    """
    w = np.zeros((ROWS, ORDER + 1))
    grown, room, extra = np.empty((2, MOST * NODES, 3)), np.empty((4, 2, 2)), np.empty((2, 2))
    used = 0
    for i in range(first, problems.shape[0]):
        if used + 2 * MOST > since.size:
            return i, used
        lam, mu, phi, span, beta0, v0 = problems[i]
        start = used
        if not span > 0:
            continue
        for k in range(2):
            limit = span if k == 0 else span - 2 * arcs[i, 0].time
            mine = slice(used, used + MOST)
            status[i, k] = march_arc(
                (lam, mu, phi),
                beta0,
                v0 if k == 0 else -v0,
                goals[i],
                limit,
                w,
                since[mine],
                width[mine],
                series[mine],
                grown[k],
                arcs[i, k],
            )
            if status[i, k] == LOST:
                break
            count[i, k] = arcs[i, k].steps
            used += count[i, k]
            if v0 == 0 or status[i, 0] == ROTATES:
                break
        lost = status[i, 0] == LOST or (status[i, 0] == LIBRATES and v0 != 0 and status[i, 1] != LIBRATES)
        if lost:
            status[i, 0], used = LOST, start
            count[i, 0] = count[i, 1] = 0
            estimates[i].error = estimates[i].condition = np.inf
            continue
        librates = status[i, 0] == LIBRATES
        estimates[i].error = error_of_arcs(span, beta0, librates, arcs[i])
        steady = beside_helix(lam, mu, phi, span, beta0, v0, weights[i])
        if steady > 0:
            estimates[i].condition = steady
        else:
            estimates[i].condition = condition_of_arcs(
                span, weights[i], librates, count[i], arcs[i], grown, room, extra
            )
    return problems.shape[0], used
