/* Periodic orbits by quadrature, made of panels, and their values along the rod; solver/orbits/periodic_orbit.py
   explains them. */

#include "orbit_parts.h"

/* The orbits of a call until they are fetched. */
typedef struct {
    int64_t problems;
    points at;
    int64_t *first; /* of the panels of each problem, -1 for none */
    panels all;
} orbits;

void rod_orbits_free(orbits *made)
{
    if (!made)
        return;
    rod_panels_free(&made->all);
    free(made->first);
    free(made);
}

static int is_finite(const start_problem *p)
{
    return isfinite(p->lam) && isfinite(p->mu) && isfinite(p->phi) && isfinite(p->span) && isfinite(p->beta0) &&
           isfinite(p->dbeta0);
}

int rod_cut_orbit(const start_problem *p, const double *pinned, const critical *known, const grid *by, const points *at,
                  const cutting *how, arcs *from, panels *all)
{
    const double pin = pinned ? pinned[0] : wrapped(p->beta0), gap = pinned ? pinned[1] : square(p->dbeta0);
    const double deeper = pinned ? pinned[2] : 0;
    const int64_t begin = all->count;
    critical found;
    if (at->n > NODES || at->n < 4 || !is_finite(p) || (pinned && !(isfinite(pin) && isfinite(gap) && isfinite(deeper))))
        return NOT_POSSIBLE;
    int failed = known ? DONE : rod_critical(p->lam, p->mu, p->phi, by, &found);
    failed = failed ? failed : rod_arcs(p, pin, gap, known ? known : &found, from);
    failed = failed ? failed : rod_panelled(p, from->pieces, from->count, at, how, all);
    if (!failed && deeper > 0)
        failed = rod_rest(from->pieces, from->count, gap, deeper, at, all);
    for (int64_t i = begin; !failed && i < all->count; i++) {
        const piece *own = &from->pieces[all->rows[i].piece];
        all->rows[i].piece = own->arc;
    }
    return failed;
}

int64_t rod_copy_panels(const panels *from, int64_t first, int64_t size, int kept, int64_t row, const panel_arrays *to)
{
    for (int64_t i = first; i >= 0 && row < to->panels; i = from->rows[i].next, row++) {
        const panel *one = &from->rows[i];
        const double values[PANEL_COLUMNS] = {one->duration, one->base,       one->origin,       one->fastest,
                                              one->error,    one->time_error, one->time_rounding};
        to->arc[row] = one->piece;
        for (int k = 0; k < PANEL_COLUMNS; k++)
            to->columns[k * to->panels + row] = values[k];
        memcpy(to->series + FUNCTIONS * size * row, from->series + FUNCTIONS * size * i,
               sizeof(double) * (size_t)(kept * size));
    }
    return row;
}

void rod_orbits_sum(int64_t arcs, int64_t P, int64_t size, const int64_t *arc, const double *width, double *series,
                    double *since, int64_t *first, int64_t *count, double *duration, double *gain)
{
    for (int64_t k = 0; k < arcs; k++)
        count[k] = 0, duration[k] = 0, memset(gain + 3 * k, 0, sizeof(double) * 3);
    for (int64_t row = 0; row < P; row++) {
        const int64_t k = arc[row];
        since[row] = duration[k], duration[k] += width[row], count[k]++;
        for (int m = 0; series && m < 3; m++) {
            double *own = series + (FUNCTIONS * row + 2 + m) * size;
            const double gained = sum_of((int)size, own);
            own[0] += gain[3 * k + m], gain[3 * k + m] += gained;
        }
    }
    for (int64_t k = 0, before = 0; k < arcs; before += count[k++])
        first[k] = before;
}

static int one_orbit(orbits *made, int64_t b, const start_problem *p, const double *pinned, const grid *by,
                     const cutting *how, int64_t *kind, double *direction)
{
    arcs from;
    const int failed = rod_cut_orbit(p, pinned, NULL, by, &made->at, how, &from, &made->all);
    if (failed)
        return failed;
    kind[b] = from.kind, direction[b] = from.direction;
    made->first[b] = from.count ? made->all.first : -1;
    return DONE;
}

/* The orbits of n start problems (n, 6).

   pinned: (n, 3), as of `rod_cut_orbit`, or NULL. kind, direction: (n,), filled. sizes: the number of panels, and the
   status. Returns the orbits, to be fetched by `rod_orbits_fetch`, or NULL. */
orbits *rod_orbits(int64_t n, const start_problem *problems, const double *pinned, const grid *by, const points *at,
                   const cutting *how, int64_t *kind, double *direction, int64_t sizes[2])
{
    orbits *made = calloc(1, sizeof(orbits));
    int failed = DONE;
    if (made)
        made->problems = n, made->at = *at, made->first = malloc(sizeof(int64_t) * (size_t)(n + 1));
    if (!made || !made->first)
        failed = NO_MEMORY;
    for (int64_t b = 0; b < n && !failed; b++)
        failed = one_orbit(made, b, &problems[b], pinned ? pinned + 3 * b : NULL, by, how, kind, direction);
    sizes[1] = failed;
    if (failed) {
        rod_orbits_free(made);
        return NULL;
    }
    sizes[0] = made->all.count;
    return made;
}

/* Fetches and frees the orbits. since, ...: as of `rod_orbits_sum`. */
void rod_orbits_fetch(orbits *made, const panel_arrays *to, double *since, int64_t *first, int64_t *count, double *duration,
                      double *gain)
{
    const int64_t size = made->at.n + 1;
    int64_t row = 0;
    for (int64_t b = 0, begin = 0; b < made->problems; b++, begin = row) {
        row = rod_copy_panels(&made->all, made->first[b], size, FUNCTIONS, row, to);
        for (int64_t i = begin; i < row; i++)
            to->arc[i] += 2 * b;
    }
    rod_orbits_sum(2 * made->problems, row, size, to->arc, to->columns, to->series, since, first, count, duration, gain);
    rod_orbits_free(made);
}

static phase located(double t, int kind, double ahead, double back)
{
    const double period = kind == HELIX ? INFINITY : (kind == LIBRATION ? 2 : 1) * (ahead + back);
    const double rest = isfinite(period) && !(t >= 0 && t < period) ? fmod(t, period) : t;
    phase out = {0, 0, rest, isfinite(period) ? rint((t - rest) / period) : 0};
    if (kind != LIBRATION)
        return out;
    out.second = rest > 2 * ahead;
    if (out.second)
        out.local = rest - 2 * ahead;
    const double limit = out.second ? back : ahead;
    out.mirrored = out.local > limit;
    if (out.mirrored)
        out.local = larger(2 * limit - out.local, 0);
    return out;
}

/* What an integral along the orbit has grown to, from its value within an arc; there, after: over both. */
double rod_unfolded(double value, const phase *where, double there, double after, int librates)
{
    const double limit = where->second ? after : there;
    value = (where->mirrored ? 2 * limit - value : value) + (where->second ? 2 * there : 0.0);
    return value + where->periods * (librates ? 2 * (there + after) : there);
}

/* The panel of orbit b in which the rod is at time t, and where in it, in [-1, 1]; the orbit has panels. near: the panel that
   is tried first, or -1. */
static inline int64_t place_from(const read_orbits *o, int64_t b, double t, int64_t near, phase *where, double *x)
{
    *where = located(t, (int)o->kind[b], o->duration[2 * b], o->duration[2 * b + 1]);
    const int64_t arc = 2 * b + where->second;
    int64_t panel = o->first[arc], last = o->first[arc] + (o->count[arc] > 1 ? o->count[arc] - 1 : 0);
    if (near >= panel && near <= last && where->local >= o->since[near] && (near == last || where->local < o->since[near + 1]))
        panel = last = near;
    while (panel < last) {
        const int64_t middle = (panel + last + 1) / 2;
        if (where->local >= o->since[middle])
            panel = middle;
        else
            last = middle - 1;
    }
    const int64_t end = o->first[2 * b] + o->count[2 * b] + o->count[2 * b + 1] - 1;
    panel = panel < end ? panel : end;
    *x = smaller(larger(2 * (where->local - o->since[panel]) / larger(o->width[panel], 5e-324) - 1, -1), 1);
    return panel;
}

int64_t rod_place(const read_orbits *o, int64_t b, double t, phase *where, double *x)
{
    return place_from(o, b, t, -1, where, x);
}

void rod_places_at(const read_orbits *o, int64_t b, int many, const double *t, int64_t *panel, phase *where, double *x)
{
    for (int i = 0; i < many; i++)
        panel[i] = place_from(o, b, t[i], i ? panel[i - 1] : -1, &where[i], &x[i]);
}

/* beta, beta_t, alpha, z and the swirl of orbit b at t. */
void rod_orbit_at(const read_orbits *o, int64_t b, double t, double *out)
{
    const int kind = (int)o->kind[b], n = (int)o->coefficients;
    const double *gain = o->gain + 6 * b;
    if (kind == HELIX) {
        const double s = sin(o->beta0[b]), c = cos(o->beta0[b]);
        out[0] = o->beta0[b], out[1] = 0, out[2] = s * t, out[3] = c * t, out[4] = s * c * t;
        return;
    }
    if (!(o->count[2 * b] + o->count[2 * b + 1]) || t != t) {
        for (int f = 0; f < FUNCTIONS; f++)
            out[f] = NAN;
        return;
    }
    phase where;
    double x;
    const int64_t panel = rod_place(o, b, t, &where, &x);
    values_at(FUNCTIONS, o->series + FUNCTIONS * n * panel, n, x, out);
    out[0] += o->base[panel] + (kind == LIBRATION ? 0 : 2 * PI * o->direction[b] * where.periods);
    out[1] *= (where.second ? -o->direction[b] : o->direction[b]) * (where.mirrored ? -1.0 : 1.0);
    for (int k = 0; k < 3; k++)
        out[2 + k] = rod_unfolded(out[2 + k], &where, gain[k], gain[3 + k], kind == LIBRATION);
}

/* beta, beta_t, alpha, z and the swirl of n orbits at t (n, stations) into out (5, n, stations). */
void rod_orbits_read(const read_orbits *o, int64_t n, int64_t stations, const double *t, double *out)
{
    double values[FUNCTIONS];
    for (int64_t b = 0; b < n; b++)
        for (int64_t i = b * stations; i < (b + 1) * stations; i++) {
            rod_orbit_at(o, b, t[i], values);
            for (int f = 0; f < FUNCTIONS; f++)
                out[f * n * stations + i] = values[f];
        }
}

/* The pieces that n rods of these lengths cover of their orbits, and how often: `solution_pieces.Pieces`, (3 P,) each. The
   panel in which a rod ends is cut there. Reads kind, first, count, duration, since and width. Returns their number. */
int64_t rod_cover(const read_orbits *o, int64_t n, const double *span, const covered *out)
{
    int64_t size = 0;
    for (int64_t b = 0; b < n; b++) {
        const double ahead = o->duration[2 * b], back = o->duration[2 * b + 1];
        const int folded = o->kind[b] == LIBRATION, repeats = o->kind[b] != HELIX;
        const double period = (folded ? 2 : 1) * (ahead + back), rest = repeats ? fmod(span[b], period) : span[b];
        const double periods = repeats ? rint((span[b] - rest) / period) : 0;
        for (int cut = 0; cut < 3; cut++) /* whole pieces, then those that are cut on the way out and on the way back */
            for (int64_t j = 0; j < o->count[2 * b] + o->count[2 * b + 1]; j++) {
                const int second = j >= o->count[2 * b];
                const int64_t i = second ? o->first[2 * b + 1] + j - o->count[2 * b] : o->first[2 * b] + j;
                const double since = o->since[i], width = o->width[i], late = second ? back : 0;
                const double begins[2] = {since + (second ? 2 * ahead : 0), 2 * (ahead + late) - since - width};
                double share[2];
                for (int way = 0; way < 2; way++)
                    share[way] = smaller(larger((rest - begins[way]) / width, 0), 1);
                share[1] = folded ? share[1] : 0;
                const double times = periods * (folded ? 2 : 1) + (share[0] == 1) + (share[1] == 1);
                const double part = cut ? share[cut - 1] : 1, edge = 2 * part - 1;
                if (cut ? !(part > 0 && part < 1) : !(times > 0))
                    continue;
                out->of[size] = b, out->row[size] = i;
                out->low[size] = cut == 2 ? -edge : -1, out->high[size] = cut == 1 ? edge : 1;
                out->time[size] = part * width, out->count[size] = cut ? 1 : times;
                out->begin[size] = cut ? periods * (repeats ? period : 0) + begins[cut - 1] : begins[0];
                size++;
            }
    }
    return size;
}
