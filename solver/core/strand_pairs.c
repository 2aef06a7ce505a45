/* Whether rods meet themselves: pairs of stretches of a rod that come near each other, by halving. One rod at a time.

   beta is periodic, so the curve repeats but for a screw: a turn and a rise, each period the same. Where two points meet, so
   do the two that lie whole periods before them, the first of them in the first period. So the first period is compared
   with itself and with each later one that comes near it; stretches of both are halved where they might meet. */

#include "orbit_parts.h"

enum { PARTS = 16, GRID = 4 * PARTS, WINDOW = 65536, DEEPEST = 48 }; /* DEEPEST: halvings */
#define FINEST 0.00390625 /* of the radius: shorter stretches count as points */

/* rod.c; orbits: of the march */
void rod_read(int64_t rod, const void *orbits, const void *kept, int64_t stations, const double *t, double *alpha, double *z,
              int64_t most);

/* Rods and their marched orbits with their steps, or where they are NULL their panels; period, length, a, apart,
   periods: (n,), lengths in units of rho. */
typedef struct {
    const void *orbits, *steps;
    const read_orbits *panels;
    const double *period, *length, *a, *apart;
    const int64_t *periods;
    int64_t rounds, most_pairs, together, lanes;
} rods;

/* Stretch i of the first period and stretch j of the k-th after it. */
typedef struct {
    int64_t k, i, j;
} pair;

typedef struct {
    pair *rows;
    int64_t count, room;
} pairs;

typedef struct {
    const rods *all;
    int64_t rod;
    double period, length, a, apart, turn, rise, alpha[GRID + 1], z[GRID + 1]; /* alpha and z on the grid */
    pairs now, next;
    double *points; /* times, alpha and z */
    int64_t point_room;
} search_of_rod;

static int add_pair(pairs *to, int64_t k, int64_t i, int64_t j)
{
    if (rod_roomy((void **)&to->rows, &to->room, to->count + 1, sizeof(pair)))
        return NO_MEMORY;
    to->rows[to->count++] = (pair){k, i, j};
    return DONE;
}

/* alpha and z of the rod at t, (n,). */
static void read_at(const search_of_rod *s, int64_t n, const double *t, double *alpha, double *z)
{
    const rods *all = s->all;
    for (int64_t i = 0; i < n && !all->orbits; i++) {
        double values[5];
        rod_orbit_at(all->panels, s->rod, t[i], values);
        alpha[i] = values[2], z[i] = values[3];
    }
    if (all->orbits)
        rod_read(s->rod, all->orbits, all->steps, n, t, alpha, z, all->lanes);
}

/* Whether period k comes near the first, of which it is the screw. */
static int comes_near(int64_t k, const search_of_rod *s, double high, double wide)
{
    const double turned = (double)k * s->turn + PI, rest = fmod(turned, TAU);
    const double around = fabs((rest < 0 ? rest + TAU : rest) - PI);
    return fabs((double)k * s->rise) <= high && around <= wide;
}

/* Whether two stretches are on the rod, in order, and somewhere far enough apart along it. */
static int possible(const search_of_rod *s, int64_t k, int64_t i, int64_t j, double size)
{
    const double before = (double)i * size, begins = (double)k * s->period + (double)j * size;
    return before < s->length && begins < s->length && begins >= before && begins + size - before >= s->apart;
}

/* The pairs of parts of the first and the k-th period whose heights allow them to meet; counts those possible. */
static int whole_pairs(search_of_rod *s, int64_t k, int64_t *used)
{
    const double size = s->period / PARTS, most = (2 * s->a + size) * (1 + 1e-12);
    for (int64_t i = 0; i < PARTS; i++)
        for (int64_t j = 0; j < PARTS; j++) {
            if (!possible(s, k, i, j, size))
                continue;
            ++*used;
            const double later = s->z[2 + 4 * j] + (double)k * s->rise;
            if (fabs(later - s->z[2 + 4 * i]) <= most && add_pair(&s->now, k, i, j))
                return NO_MEMORY;
        }
    return DONE;
}

/* alpha and z in the middles of stretches: of stretch v at v times `each`; where that is 0, of i and j of each pair in turn. */
typedef struct {
    const double *alpha, *z;
    int64_t each;
} middles;

/* Those of a level are on the grid, or all are read, unless there are fewer pairs. */
static int read_middles(search_of_rod *s, int level, double size, middles *out)
{
    const int64_t all = (int64_t)PARTS << level, of_pairs = 2 * s->now.count, n = all < of_pairs ? all : of_pairs;
    if (level < 2) {
        *out = (middles){s->alpha + (2 >> level), s->z + (2 >> level), 4 >> level};
        return DONE;
    }
    if (rod_roomy((void **)&s->points, &s->point_room, 3 * n, sizeof(double)))
        return NO_MEMORY;
    double *t = s->points, *alpha = t + n, *z = t + 2 * n;
    for (int64_t m = 0; m < n; m++) {
        const pair *p = &s->now.rows[m / 2];
        t[m] = ((double)(n == all ? m : m % 2 ? p->j : p->i) + 0.5) * size;
    }
    read_at(s, n, t, alpha, z);
    *out = (middles){alpha, z, n == all};
    return DONE;
}

/* Halves the pairs that might meet; met: whether middles do. */
static int finer(search_of_rod *s, int level, int64_t *used, int *met)
{
    const double size = s->period / PARTS * ldexp(1, -level), thick = 2 * s->a, near = thick + size;
    middles at;
    s->next.count = 0;
    if (read_middles(s, level, size, &at))
        return NO_MEMORY;
    for (int64_t m = 0; m < s->now.count; m++) {
        const pair p = s->now.rows[m];
        const int64_t i = at.each ? at.each * p.i : 2 * m, j = at.each ? at.each * p.j : 2 * m + 1;
        const double rise = at.z[j] + (double)p.k * s->rise - at.z[i];
        if (fabs(rise) > near)
            continue;
        const double chord = 2 * sin((at.alpha[j] + (double)p.k * s->turn - at.alpha[i]) / 2);
        if (fabs(chord) > near)
            continue;
        const double distance = sqrt(chord * chord + rise * rise);
        const double first = ((double)p.i + 0.5) * size, later = (double)p.k * s->period + ((double)p.j + 0.5) * size;
        if (distance < thick && later <= s->length && later - first > PI * s->a) {
            *met = 1;
            return DONE;
        }
        if (!(distance <= near && size > FINEST * s->a && level < DEEPEST))
            continue;
        for (int child = 0; child < 4; child++) {
            const int64_t before = 2 * p.i + child / 2, after = 2 * p.j + child % 2;
            if (!possible(s, p.k, before, after, size / 2))
                continue;
            ++*used;
            if (add_pair(&s->next, p.k, before, after))
                return NO_MEMORY;
        }
    }
    const pairs done = s->now;
    s->now = s->next, s->next = done;
    return DONE;
}

/* Compares the first period with some others; used: the pairs compared; met: whether stretches meet. */
static int searched(search_of_rod *s, int64_t count, const int64_t *periods, int64_t left, int64_t *used, int *met)
{
    int failed = DONE;
    *used = 0, s->now.count = 0;
    for (int64_t m = 0; m < count && !failed; m++)
        failed = whole_pairs(s, periods[m], used);
    for (int level = 0; !failed && !*met && s->now.count && *used <= left; level++)
        failed = finer(s, level, used, met);
    return failed;
}

static void range_of(const double *values, double *range)
{
    double low = values[0], high = values[0];
    for (int i = 1; i <= GRID; i++)
        low = smaller(low, values[i]), high = larger(high, values[i]);
    *range = high - low;
}

/* 1 where the rod meets itself, 0 where it does not, NaN where more pairs would have to be compared. */
static int one_rod(search_of_rod *s, int64_t *near, double *found)
{
    const rods *all = s->all;
    const int64_t b = s->rod, periods = all->periods[b];
    double t[GRID + 1], high, wide;
    s->period = all->period[b], s->length = all->length[b], s->a = all->a[b], s->apart = all->apart[b];
    for (int i = 0; i <= GRID; i++)
        t[i] = s->period / GRID * i;
    read_at(s, GRID + 1, t, s->alpha, s->z);
    s->turn = s->alpha[GRID], s->rise = s->z[GRID];
    range_of(s->z, &high);
    range_of(s->alpha, &wide);
    /* no point between two of the grid is farther from both than half their distance */
    const double margin = s->a + s->period / GRID;
    high += 2 * margin, wide += 2 * asin(smaller(1, margin));
    const int enough = periods < all->rounds || fabs((double)periods * s->rise) > high;
    int64_t left = all->most_pairs, count = 0, used;
    int met = 0, failed = DONE;
    const double before = floor(fmin(s->apart / s->period, (double)all->rounds)) - 2; /* none is far enough apart */
    int64_t k = before > 0 ? (int64_t)before : 0;
    for (; k <= periods && fabs((double)k * s->rise) <= high && !met && left > 0 && !failed; k++) {
        if (comes_near(k, s, high, wide))
            near[count++] = k;
        const int last = k == periods || !(fabs((double)(k + 1) * s->rise) <= high) || (k + 1) % WINDOW == 0;
        if (count == all->together || (count && last)) {
            failed = searched(s, count, near, left, &used, &met);
            left -= used, count = 0;
        }
    }
    *found = met ? 1 : enough && left > 0 ? 0 : NAN;
    return failed;
}

/* Whether the rods from begin to end meet themselves: `observe.self_contact`, into found (n,). */
int rod_meets(const rods *all, double *found, int64_t begin, int64_t end)
{
    search_of_rod *s = calloc(1, sizeof(search_of_rod));
    int64_t *near = malloc(sizeof(int64_t) * (size_t)(all->together > 0 ? all->together : 1));
    int failed = s && near ? DONE : NO_MEMORY;
    if (s)
        s->all = all;
    for (int64_t b = begin; b < end && !failed; b++) {
        s->rod = b;
        failed = one_rod(s, near, &found[b]);
    }
    if (s)
        free(s->now.rows), free(s->next.rows), free(s->points);
    free(s), free(near);
    return failed;
}
