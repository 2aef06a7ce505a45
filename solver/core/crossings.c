/* Where a curve that is known at points passes through itself: pairs of points near each other, found by cells of space. */

#include "stretches.h"

enum { BESIDE = 2 }; /* points along both stretches: pairs so near are of one place */

/* Pairs of a point i with the points `low` to `high`, and the nearest of them. */
typedef struct {
    int64_t i, low, high, j;
    double away;
} run;

/* A place where two stretches are near each other: of its pairs the nearest, and those of its last point and of the one
   before it. */
typedef struct {
    run nearest, now, before;
} place;

/* A curve and the lists of its points by cells: the last of each, and of each point the one before it. row: the pairs of
   the point in hand. */
typedef struct {
    const double *s, *points;
    double near, apart, whole;
    int64_t *last, *before, row_room, place_room, count;
    uint64_t mask;
    run *row;
    place *places;
} curve;

static void extend(run *to, const run *by)
{
    to->low = by->low < to->low ? by->low : to->low, to->high = by->high > to->high ? by->high : to->high;
}

static int touches(const run *one, const run *other)
{
    return one->i - other->i <= BESIDE && one->low <= other->high + BESIDE && one->high >= other->low - BESIDE;
}

/* Adds a run to the place that it touches, or as a new one; places that it joins become one. */
static int add_run(curve *c, const run *found)
{
    place *into = NULL;
    for (int64_t k = 0; k < c->count; k++) {
        place *p = &c->places[k];
        if (!touches(found, p->now.i < found->i ? &p->now : &p->before))
            continue;
        if (!into) {
            into = p;
            if (p->now.i < found->i)
                p->before = p->now, p->now = *found;
            extend(&p->now, found);
        } else {
            extend(p->now.i < found->i ? &into->before : &into->now, &p->now);
            if (p->nearest.away < into->nearest.away)
                into->nearest = p->nearest;
            c->places[k--] = c->places[--c->count];
        }
    }
    if (!into) {
        if (rod_roomy((void **)&c->places, &c->place_room, c->count + 1, sizeof(place)))
            return NO_MEMORY;
        into = &c->places[c->count++];
        into->nearest = into->now = into->before = *found;
    }
    if (found->away < into->nearest.away)
        into->nearest = *found;
    return DONE;
}

static uint64_t cell_of(const double *cell, int du, int dv, int dw)
{
    const uint64_t u = (uint64_t)(int64_t)(cell[0] + du), v = (uint64_t)(int64_t)(cell[1] + dv);
    return u * 73856093u ^ v * 19349663u ^ (uint64_t)(int64_t)(cell[2] + dw) * 83492791u;
}

static int by_low(const void *one, const void *other)
{
    const int64_t a = ((const run *)one)->low, b = ((const run *)other)->low;
    return (a > b) - (a < b);
}

/* The pairs of point i with those before it in the 27 cells about it, which may share a list, and puts it into its own cell.
   Returns their number, or -1 if there is no memory. */
static int64_t pairs_of(curve *c, int64_t i)
{
    const double *p = c->points + 3 * i, cell[3] = {floor(p[0] / c->near), floor(p[1] / c->near), floor(p[2] / c->near)};
    int64_t count = 0;
    for (int k = 0; k < 27; k++) {
        int64_t j = c->last[cell_of(cell, k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1) & c->mask];
        for (; j >= 0; j = c->before[j]) {
            const double *q = c->points + 3 * j, x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
            const double away = x * x + y * y + z * z, along = c->s[i] - c->s[j];
            if (!(smaller(along, c->whole - along) > c->apart && away < c->near * c->near))
                continue;
            if (rod_roomy((void **)&c->row, &c->row_room, count + 1, sizeof(run)))
                return -1;
            c->row[count++] = (run){i, j, j, j, away};
        }
    }
    int64_t *own = &c->last[cell_of(cell, 0, 0, 0) & c->mask];
    c->before[i] = *own, *own = i;
    return count;
}

/* Adds the runs of point i. */
static int compare(curve *c, int64_t i)
{
    const int64_t count = pairs_of(c, i);
    if (count > 0)
        qsort(c->row, (size_t)count, sizeof(run), by_low);
    for (int64_t k = 0; k < count;) {
        run found = c->row[k++];
        for (; k < count && c->row[k].low <= found.high + BESIDE; k++) {
            extend(&found, &c->row[k]);
            if (c->row[k].away < found.away)
                found.j = c->row[k].j, found.away = c->row[k].away;
        }
        if (add_run(c, &found))
            return NO_MEMORY;
    }
    return count < 0 ? NO_MEMORY : DONE;
}

/* The places where a curve through n points comes nearer to itself than `near`, at points more than `apart` apart along it.

   s: (n,), rising, along the curve. points: (n, 3). whole: the length of a closed curve, else infinite. pairs: (most, 2), of each place
   the two points that are nearest, the later one first. Returns how many places there are, which may be more than `most`, or
   -1 if there is no memory. */
int64_t rod_crossings(int64_t n, const double *s, const double *points, double near, double apart, double whole,
                      int64_t most, int64_t *pairs)
{
    uint64_t cells = 64;
    while (cells < (uint64_t)n)
        cells *= 2;
    curve c = {.s = s, .points = points, .near = near, .apart = apart, .whole = whole, .mask = cells - 1};
    c.last = malloc(sizeof(int64_t) * cells), c.before = malloc(sizeof(int64_t) * (size_t)(n + 1));
    int failed = c.last && c.before ? DONE : NO_MEMORY;
    if (!failed)
        memset(c.last, -1, sizeof(int64_t) * cells);
    for (int64_t i = 0; i < n && !failed; i++)
        failed = compare(&c, i);
    for (int64_t k = 0; k < c.count && k < most; k++)
        pairs[2 * k] = c.places[k].nearest.i, pairs[2 * k + 1] = c.places[k].nearest.j;
    free(c.last), free(c.before), free(c.row), free(c.places);
    return failed ? -1 : c.count;
}
