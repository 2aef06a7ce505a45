"""Compiled loops over single orbits, for `methods.swing`; needs the package numba (the extra `fast`).

All in one module, because what numba keeps on disk is made anew when the module itself changes, not when one that it
calls does. Three parts: one step of Taylor's method; the legs of an orbit, with their error and condition; reading.

H = lam cos b - mu cos 2b - phi sin b - sin(2b)/2 + sin(4b)/4, eq. (35) with its products written as multiple angles:
then every coefficient of the series of sin and cos follows from lower ones by sums of products. Half a swing of each
orbit is marched, forward and backward from its start to where it turns (or once round), and no more. A leg keeps its
series for reading, the transfer matrix of a change of its start for the condition number, and the covariance of what
the steps leave out and round off, carried along by the steps' own transfer matrices.
"""

from typing import Any

import numpy as np
from numba import njit

ORDER = 20
ROWS = 9
B, V, S, C, S2, C2, RATE, ETA, ZETA = range(ROWS)  # rows of a table of series; eta(0) = 1, zeta_t(0) = 1


def compiled(function: Any) -> Any:
    """The function as machine code, kept on disk; where no folder can be written, made anew in each process."""
    how: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}, "nogil": True}
    try:
        return njit(cache=True, **how)(function)
    except RuntimeError:  # numba found no place for its cache
        return njit(**how)(function)


@compiled
def expand(w: Any, lam: float, mu: float, phi: float, beta: float, v: float) -> None:
    """Fill the table w (ROWS, ORDER + 1) with the series about a point where beta and beta_t are given.

    Rows: beta, beta_t, sin and cos of beta and of 2 beta, H', and the two solutions of eta_tt = -H' eta.
    """
    w[B, 0], w[B, 1], w[V, 0] = beta, v, v
    w[S, 0], w[C, 0] = np.sin(beta), np.cos(beta)
    w[ETA, 0], w[ETA, 1], w[ZETA, 0], w[ZETA, 1] = 1.0, 0.0, 0.0, 1.0
    for k in range(ORDER - 1):
        sc = ss = vc = vs = 0.0
        for i in range(k + 1):
            j = k - i
            sc += w[S, i] * w[C, j]
            ss += w[S, i] * w[S, j]
            vc += w[V, i] * w[C, j]
            vs += w[V, i] * w[S, j]
        w[S2, k] = 2 * sc
        w[C2, k] = -2 * ss
        if k == 0:
            w[C2, 0] += 1.0
        w[S, k + 1], w[C, k + 1] = vc / (k + 1), -vs / (k + 1)
        s4 = c4 = 0.0
        for i in range(k + 1):
            s4 += w[S2, i] * w[C2, k - i]
            c4 += w[S2, i] * w[S2, k - i]
        s4, c4 = 2 * s4, -2 * c4
        if k == 0:
            c4 += 1.0
        pull = lam * w[C, k] - mu * w[C2, k] - phi * w[S, k] - w[S2, k] / 2 + s4 / 4
        w[RATE, k] = -lam * w[S, k] + 2 * mu * w[S2, k] - phi * w[C, k] - w[C2, k] + c4
        eta = zeta = 0.0
        for i in range(k + 1):
            eta += w[RATE, i] * w[ETA, k - i]
            zeta += w[RATE, i] * w[ZETA, k - i]
        both = (k + 1.0) * (k + 2.0)
        w[V, k + 1] = -pull / (k + 1)
        w[B, k + 2] = -pull / both
        w[ETA, k + 2], w[ZETA, k + 2] = -eta / both, -zeta / both
    last = ORDER - 1
    vc = vs = 0.0
    for i in range(last + 1):
        vc += w[V, i] * w[C, last - i]
        vs += w[V, i] * w[S, last - i]
    w[S, ORDER], w[C, ORDER] = vc / ORDER, -vs / ORDER
    w[V, ORDER] = w[S2, last] = 0.0


@compiled
def reach(w: Any, goal: float) -> float:
    """How far the series may be used for its last four terms to stay below `goal`: one or two may vanish by chance."""
    least = np.inf
    for k in range(ORDER - 3, ORDER + 1):
        size = max(abs(w[B, k]), max(abs(w[S, k - 1]), abs(w[C, k - 1])) / k)
        if size > 0:
            least = min(least, np.log(goal / size) / k)
    return float(np.exp(least))


@compiled
def left_out(w: Any, h: float) -> float:
    """What the series of beta leaves out at h: a geometric rest, its ratio that of the last eight terms."""
    power = h
    for _ in range(ORDER - 8):
        power *= h
    earlier = last = 0.0
    for k in range(ORDER - 7, ORDER - 3):
        earlier = max(earlier, abs(w[B, k]) * power)
        power *= h
    for k in range(ORDER - 3, ORDER + 1):
        last = max(last, abs(w[B, k]) * power)
        power *= h
    ratio = min(np.sqrt(np.sqrt(last / max(earlier, 1e-300))), 0.8)
    power, last = 1.0, 0.0
    for k in range(ORDER, ORDER - 4, -1):
        last = max(last, abs(w[B, k]) * h**k * power)
        power *= ratio
    return float(last * ratio / (1 - ratio))


@compiled
def keep(w: Any, alpha: float, z: float, swirl: float, kept: Any) -> None:
    """beta and the integrals of sin, cos and sin cos of it, from what they are at the step's start, into (4, n)."""
    kept[0, 0], kept[1, 0], kept[2, 0], kept[3, 0] = w[B, 0], alpha, z, swirl
    for i in range(ORDER):
        share = 1.0 / (i + 1)
        kept[0, i + 1] = w[B, i + 1]
        kept[1, i + 1], kept[2, i + 1] = w[S, i] * share, w[C, i] * share
        kept[3, i + 1] = w[S2, i] * share / 2


@compiled
def value(row: Any, n: int, x: float) -> float:
    """The series with coefficients row[0 .. n] at x."""
    total = row[n]
    for k in range(n - 1, -1, -1):
        total = total * x + row[k]
    return float(total)


@compiled
def value_and_rate(row: Any, n: int, x: float) -> tuple[float, float]:
    """The series with coefficients row[0 .. n] and its derivative at x."""
    total, rate = row[n], 0.0
    for k in range(n - 1, -1, -1):
        rate = rate * x + total
        total = total * x + row[k]
    return total, rate


@compiled
def crossing(row: Any, n: int, level: float, h: float) -> float:
    """Where in [0, h] the series, monotone there or with one change of sign of its distance, passes `level`."""
    lo, hi = 0.0, h
    above = value(row, n, h) > level
    x = h
    for _ in range(60):
        y, rate = value_and_rate(row, n, x)
        if y == level:
            return x
        if (y > level) == above:
            hi = x
        else:
            lo = x
        step = (y - level) / rate if rate != 0 else np.inf
        new = x - step
        if not lo < new < hi:
            new = (lo + hi) / 2
        if abs(new - x) <= 1e-16 * h:
            return new
        x = new
    return x


EPS = 2.0**-52
MOST = 60  # steps of a leg: more are spent only next to a saddle or by huge loads, where `orbit` knows better
NODES = 2  # of each step, at which the growth of a change is looked at
STEADY = 1e6  # growth beyond this leaves the march too few digits to tell where the orbit goes
SAFETY = 3.0
LOST, TURNS, GOES_ROUND = 0, 1, 2

# what is known of a leg, as a row of numbers
FACTS = 13
TIME, ALPHA, Z, SWIRL, ERROR, LATE, FASTEST, STEPS, SWING, E11, E12, E21, E22 = range(FACTS)


@compiled
def leg(
    load: Any,
    beta0: float,
    v0: float,
    goal: float,
    limit: float,
    w: Any,
    since: Any,
    width: Any,
    kept: Any,
    grown: Any,
    told: Any,
) -> int:
    """March one leg; fills since, width (MOST,), kept (MOST, 4, ORDER + 1), grown (MOST * NODES, 3) and told (13,).

    load: lam, mu, phi. limit: how far the rod goes. grown: time, and the growth of beta for a change of beta and of
    beta_t, at each node; the transfer matrix at the far end goes to told. Returns TURNS, GOES_ROUND or LOST.
    """
    lam, mu, phi = load
    heights = abs(lam) + abs(mu) + abs(phi) + 1
    # two zeros of beta_t lie at least pi / sqrt(max H') apart (Sturm): no step holds two
    longest = 3.0 / np.sqrt(abs(lam) + 2 * abs(mu) + abs(phi) + 2)
    way = np.sign(v0)
    beta, v, t = beta0, v0, 0.0
    alpha = z = swirl = 0.0
    a, b, c, d = 1.0, 0.0, 0.0, 1.0
    pbb = pbv = pvv = 0.0  # the covariance of the errors of beta and beta_t, and below what the loads' rounding makes
    lb = lv = 0.0
    worst = 0.0
    fastest = abs(v0)
    for k in range(MOST):
        expand(w, lam, mu, phi, beta, v)
        h = min(reach(w, goal), longest)
        if not h > 0:
            return LOST
        if k == 0 and way == 0:
            way = np.sign(value(w[V], ORDER - 1, h))
        end = LOST
        far, speed = value_and_rate(w[B], ORDER, h)
        if speed * way < 0:
            h = crossing(w[V], ORDER - 1, 0.0, h)
            end = TURNS
        elif abs(far - beta0) >= 2 * np.pi:
            h = crossing(w[B], ORDER, beta0 + way * 2 * np.pi, h)
            end = GOES_ROUND
        since[k], width[k] = t, h
        keep(w, alpha, z, swirl, kept[k])
        n = NODES * k
        last = t < limit < t + h  # the rod's own end counts too
        x = limit - t if last else h / 2
        e, f = value(w[ETA], ORDER, x), value(w[ZETA], ORDER, x)
        if last:
            eb = np.sqrt(e * e * pbb + 2 * e * f * pbv + f * f * pvv) + abs(e * lb + f * lv)
            worst = max(worst, eb + left_out(w, x) + EPS * (max(1.0, abs(beta)) + heights * x * x) / 2)
        grown[n, 0], grown[n, 1], grown[n, 2] = t + x, e * a + f * c, e * b + f * d
        e, ev = value_and_rate(w[ETA], ORDER, h)
        f, fv = value_and_rate(w[ZETA], ORDER, h)
        grown[n + 1, 0], grown[n + 1, 1], grown[n + 1, 2] = t + h, e * a + f * c, e * b + f * d
        a, b, c, d = grown[n + 1, 1], grown[n + 1, 2], ev * a + fv * c, ev * b + fv * d
        if not max(max(abs(a), abs(b)), max(abs(c), abs(d))) < STEADY:
            return LOST
        # what the step leaves out, and rounds off
        out = left_out(w, h)
        qb = out + EPS * max(1.0, abs(beta)) / 2
        qv = out * (ORDER + 1) / h + EPS * (abs(v) + heights * h) / 2
        pbb, pbv, pvv = (
            e * e * pbb + 2 * e * f * pbv + f * f * pvv + qb * qb,
            e * ev * pbb + (e * fv + f * ev) * pbv + f * fv * pvv,
            ev * ev * pbb + 2 * ev * fv * pbv + fv * fv * pvv + qv * qv,
        )
        lb, lv = e * lb + f * lv + EPS * heights * h * h / 4, ev * lb + fv * lv + EPS * heights * h / 2
        eb, ev = np.sqrt(pbb) + abs(lb), np.sqrt(pvv) + abs(lv)
        if t + h <= limit:
            worst = max(worst, eb)
        fastest = max(fastest, abs(value(w[V], ORDER - 1, h / 2)))
        beta, v = value_and_rate(w[B], ORDER, h)
        fastest = max(fastest, abs(v))
        alpha, z, swirl = value(kept[k, 1], ORDER, h), value(kept[k, 2], ORDER, h), value(kept[k, 3], ORDER, h)
        t += h
        if end != LOST:
            told[TIME], told[ALPHA], told[Z], told[SWIRL] = t, alpha, z, swirl
            told[ERROR], told[FASTEST], told[STEPS] = worst, fastest, k + 1
            told[SWING] = abs(beta - beta0)
            told[E11], told[E12], told[E21], told[E22] = a, b, c, d
            if end == TURNS:
                told[LATE] = ev / abs(value_and_rate(w[V], ORDER - 1, h)[1])
            else:
                told[LATE] = eb / abs(v)
            return end
    return LOST


@compiled
def _return(e: Any, out: Any) -> None:
    """S E^-1 S E with S = diag(1, -1) and det E = 1: the transfer out to a turning point and back, (2, 2)."""
    a, b, c, d = e[E11], e[E12], e[E21], e[E22]
    out[0, 0], out[0, 1] = d * a + b * c, 2 * b * d
    out[1, 0], out[1, 1] = 2 * a * c, out[0, 0]


@compiled
def _multiply(a: Any, b: Any, out: Any) -> None:
    """out = a b, all (2, 2) and none the same."""
    for i in range(2):
        for j in range(2):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j]


@compiled
def _most(grown: Any, n: int, m: Any, sign: float, begin: float, when: Any, weight: float, best: float) -> float:
    """The largest growth of beta at the first n nodes of a leg travelled one way, at times begin + sign t.

    m: transfer (2, 2) from the rod's start to what the leg's own transfer applies to. when: span, period, rounds and
    what the transfer of one period adds, (4,), as one row.
    """
    span, period, rounds = when[0], when[1], when[2]
    for k in range(n):
        time = begin + sign * grown[k, 0]
        if time > span * (1 + 4 * EPS):
            continue
        p, q = grown[k, 1], grown[k, 2]
        x, y = p * m[0, 0] + q * m[1, 0], p * m[0, 1] + q * m[1, 1]
        best = max(best, max(abs(x), weight * abs(y)))
        if rounds > 0:
            many = rounds if time + rounds * period <= span else rounds - 1
            x, y = x + many * (x * when[3] + y * when[5]), y + many * (x * when[4] + y * when[6])
            best = max(best, max(abs(x), weight * abs(y)))
    return best


@compiled
def _largest(rate: float, span: float) -> tuple[float, float]:
    """The largest values on [0, span] of the two solutions of eta_tt = -rate eta that begin as 1 and as t."""
    root = np.sqrt(abs(rate))
    angle = min(root * span, 700.0)
    if not angle > 1e-150:
        return 1.0, span
    if rate > 0:
        return 1.0, (np.sin(angle) if angle < np.pi / 2 else 1.0) / root
    return np.cosh(angle), np.sinh(angle) / root


@compiled
def beside_helix(lam: float, mu: float, phi: float, span: float, beta: float, v: float, weight: float) -> float:
    """The condition number of a rod along which H' hardly changes, else 0: `sensitivity.beside_helix` of one rod."""
    s, c = np.sin(beta), np.cos(beta)
    s2, c2 = 2 * s * c, (c - s) * (c + s)
    size = abs(c)
    pull = (lam - (-mu if c < 0 else mu)) * c + mu * s * s * (1 + 2 * size) / (1 + size) - (phi + 2 * c * s * s) * s
    rate = -lam * s + 2 * mu * s2 - phi * c - 2 * s * s * (3 * c * c - s * s)
    second = -lam * c + 4 * mu * c2 + phi * s + 2 * s2 - 8 * s2 * c2
    even, odd = _largest(rate, span)
    half = _largest(rate, span / 2)[1]
    strays = abs(v) * odd + 2 * abs(pull) * half * half
    change = abs(second) * strays + (abs(lam) + 8 * abs(mu) + abs(phi) + 20) * strays * strays / 2
    root = np.sqrt(abs(rate))
    time = min(span, 1 / root) if root > 0 else span
    return max(1.0, max(even, odd * weight)) if change * span * time < 0.1 else 0.0


@compiled
def judge(
    span: float, beta0: float, weight: float, swings: bool, count: Any, told: Any, grown: Any, judged: Any, m: Any
) -> None:
    """Error and condition of one orbit from its legs, into judged (2,); m (4, 2, 2) is room to work in.

    At the end of the way out the transfer is E; reflected at the turning point it comes back as S E^-1 S E, and the
    way back is the way out's own transfer applied to S times that. A period adds a multiple of one shear.
    """
    ahead, back = told[0, TIME], told[1, TIME]
    n, k = count[0] * NODES, count[1] * NODES
    period = 2 * (ahead + back) if swings else ahead
    rounds = np.floor(span / period)
    when = np.empty(7)
    when[0], when[1], when[2] = span, period, rounds
    if swings:
        _return(told[0], m[0])
        m[1] = m[0]
        if k > 0:
            _return(told[1], m[2])
            _multiply(m[2], m[0], m[1])
    else:
        for i in range(4):
            m[1, i // 2, i % 2] = told[0, E11 + i]
    when[3], when[4], when[5], when[6] = m[1, 0, 0] - 1, m[1, 0, 1], m[1, 1, 0], m[1, 1, 1] - 1
    m[3] = np.eye(2)
    best = _most(grown[0], n, m[3], 1.0, 0.0, when, weight, 1.0)
    if swings:
        m[3, 0], m[3, 1] = m[0, 0], -m[0, 1]
        best = _most(grown[0], n, m[3], -1.0, 2 * ahead, when, weight, best)
        if k > 0:
            best = _most(grown[1], k, m[0], 1.0, 2 * ahead, when, weight, best)
            m[3, 0], m[3, 1] = m[1, 0], -m[1, 1]
            best = _most(grown[1], k, m[3], -1.0, period, when, weight, best)
    # what the products of large transfers round off, as often as it is repeated
    largest = 1.0
    for i in range(n):
        largest = max(largest, max(abs(grown[0, i, 1]), abs(grown[0, i, 2]) * weight))
    for i in range(k):
        largest = max(largest, max(abs(grown[1, i, 1]), abs(grown[1, i, 2]) * weight))
    judged[1] = best if EPS * largest * largest * max(1.0, rounds) < 0.1 * best else np.inf
    late = rounds * told[0, LATE]
    if swings:
        late = 2 * (rounds + (span > rounds * period + ahead)) * told[0, LATE]
        late += 2 * (rounds + (span > rounds * period + 2 * ahead + back)) * told[1, LATE]
    fastest = max(told[0, FASTEST], told[1, FASTEST])
    shift = fastest * late
    if swings:
        shift = min(shift, told[0, SWING] + told[1, SWING])
    judged[0] = SAFETY * (max(told[0, ERROR], told[1, ERROR]) + shift) + EPS * (span * fastest + max(1.0, abs(beta0)))


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
    told: Any,
    judged: Any,
) -> tuple[int, int]:
    """Problems (B, 6): lam, mu, phi, span, beta0, v0; from number `first` on until all are done or the store is full.

    Fills since, width (P,) and series (P, 4, ORDER + 1) with the steps of all legs in order; count (B, 2), their
    number; status (B, 2) and told (B, 2, 13) of the legs; judged (B, 2), error and condition. Returns how many
    problems and how many steps are done.
    """
    w = np.zeros((ROWS, ORDER + 1))
    grown, room = np.empty((2, MOST * NODES, 3)), np.empty((4, 2, 2))
    used = 0
    for i in range(first, problems.shape[0]):
        if used + 2 * MOST > since.size:
            return i, used
        lam, mu, phi, span, beta0, v0 = problems[i]
        start = used
        if not span > 0:
            continue
        for part in range(2):
            limit = span if part == 0 else span - 2 * told[i, 0, TIME]
            mine = slice(used, used + MOST)
            status[i, part] = leg(
                (lam, mu, phi),
                beta0,
                v0 if part == 0 else -v0,
                goals[i],
                limit,
                w,
                since[mine],
                width[mine],
                series[mine],
                grown[part],
                told[i, part],
            )
            if status[i, part] == LOST:
                break
            count[i, part] = int(told[i, part, STEPS])
            used += count[i, part]
            if v0 == 0 or status[i, 0] == GOES_ROUND:
                break
        lost = status[i, 0] == LOST or (status[i, 0] == TURNS and v0 != 0 and status[i, 1] != TURNS)
        if lost:
            status[i, 0], used = LOST, start
            count[i, 0] = count[i, 1] = 0
            judged[i, 0] = judged[i, 1] = np.inf
            continue
        judge(span, beta0, weights[i], status[i, 0] == TURNS, count[i], told[i], grown, judged[i], room)
        steady = beside_helix(lam, mu, phi, span, beta0, v0, weights[i])
        if steady > 0:
            judged[i, 1] = steady
    return problems.shape[0], used


@compiled
def read(
    t: Any,
    lost: Any,
    swings: Any,
    told: Any,
    first: Any,
    count: Any,
    since: Any,
    width: Any,
    series: Any,
    angle: Any,
    speed: Any,
    azimuth: Any,
    height: Any,
) -> None:
    """beta, beta_t, alpha, z at t (B, n), into angle, speed, azimuth, height, (B, n) each.

    lost: (B,), NaN then. swings: (B,), or it goes round. told, first, count: (B, 2, ..) of the legs;
    since, width, series: of their steps.
    """
    for i in range(t.shape[0]):
        if lost[i]:
            angle[i] = speed[i] = azimuth[i] = height[i] = np.nan
            continue
        ahead, back = told[i, 0, TIME], told[i, 1, TIME]
        period = 2 * (ahead + back) if swings[i] else ahead
        k = first[i, 0]
        turn = 0.0 if swings[i] else np.sign(series[k, 0, 1]) * 2 * np.pi
        for j in range(t.shape[1]):
            local, rounds, part, mirrored = fold(t[i, j], period, ahead, back, swings[i])
            k = find(since, first[i, part], count[i, part], k, local)
            x = min(local - since[k], width[k])
            beta, alpha, z = series[k, 0, ORDER], series[k, 1, ORDER], series[k, 2, ORDER]
            v = 0.0
            for n in range(1, ORDER + 1):
                v = v * x + beta
                beta = beta * x + series[k, 0, ORDER - n]
                alpha = alpha * x + series[k, 1, ORDER - n]
                z = z * x + series[k, 2, ORDER - n]
            angle[i, j], speed[i, j] = beta + turn * rounds, -v if mirrored else v
            azimuth[i, j] = unfold(alpha, told[i, 0, ALPHA], told[i, 1, ALPHA], swings[i], part, mirrored, rounds)
            height[i, j] = unfold(z, told[i, 0, Z], told[i, 1, Z], swings[i], part, mirrored, rounds)


@compiled
def swirl(
    t: Any, lost: Any, swings: Any, told: Any, first: Any, count: Any, since: Any, width: Any, series: Any, out: Any
) -> None:
    """The integral of sin(beta) cos(beta) from the start to t (B, n), into out (B, n)."""
    for i in range(t.shape[0]):
        if lost[i]:
            out[i] = np.nan
            continue
        ahead, back = told[i, 0, TIME], told[i, 1, TIME]
        period = 2 * (ahead + back) if swings[i] else ahead
        k = first[i, 0]
        for j in range(t.shape[1]):
            local, rounds, part, mirrored = fold(t[i, j], period, ahead, back, swings[i])
            k = find(since, first[i, part], count[i, part], k, local)
            total = value(series[k, 3], ORDER, min(local - since[k], width[k]))
            out[i, j] = unfold(total, told[i, 0, SWIRL], told[i, 1, SWIRL], swings[i], part, mirrored, rounds)


@compiled
def fold(t: float, period: float, ahead: float, back: float, swings: bool) -> tuple[float, float, int, bool]:
    """Time within a leg, periods gone by, which leg, whether on its way back."""
    rounds = np.floor(t / period)
    rest = max(t - rounds * period, 0.0)
    if not swings:
        return rest, rounds, 0, False
    if rest <= 2 * ahead:
        return (rest, rounds, 0, False) if rest <= ahead else (2 * ahead - rest, rounds, 0, True)
    rest -= 2 * ahead
    return (rest, rounds, 1, False) if rest <= back else (max(2 * back - rest, 0.0), rounds, 1, True)


@compiled
def find(since: Any, first: int, count: int, near: int, local: float) -> int:
    """The step of a leg in which a time lies, looked for from the step `near`."""
    k = min(max(near, first), first + count - 1)
    while k > first and local < since[k]:
        k -= 1
    while k + 1 < first + count and local >= since[k + 1]:
        k += 1
    return k


@compiled
def unfold(total: float, there: float, after: float, swings: bool, part: int, mirrored: bool, rounds: float) -> float:
    """A quantity that grows along the rod, from its value within a leg and its gains over both legs."""
    if not swings:
        return total + rounds * there
    limit = after if part == 1 else there
    value = 2 * limit - total if mirrored else total
    if part == 1:
        value += 2 * there
    return value + rounds * 2 * (there + after)
