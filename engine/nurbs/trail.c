#include "nurbs/trail.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PARTS = 4 }; /* of a span when a chain becomes a trail */

void gd__trail_free(struct gd__trail *trail)
{
    free(trail->at);
    free(trail->run);
    *trail = (struct gd__trail){0};
}

enum gd_status gd__trail_add(struct gd__trail *trail, const double at[2])
{
    if (trail->count == trail->capacity) {
        uint32_t capacity = trail->capacity ? 2 * trail->capacity : 64;
        double(*places)[2] = realloc(trail->at, capacity * sizeof *places);
        if (places) trail->at = places;
        double *run = realloc(trail->run, capacity * sizeof *run);
        if (run) trail->run = run;
        if (!places || !run) return GD_NO_MEMORY;
        trail->capacity = capacity;
    }
    memcpy(trail->at[trail->count++], at, sizeof *trail->at);
    return GD_OK;
}

void gd__trail_measure(const struct gd_parametric *surface, struct gd__trail *trail)
{
    uint32_t kept = 0;
    struct gd_vec3 before = {0};
    for (uint32_t i = 0; i < trail->count; i++) {
        struct gd_vec3 x = gd__surface_position(surface, trail->at[i]);
        double step = i ? gd_vec3_distance(before, x) : 0;
        bool last = i + 1 == trail->count;
        if (i && !(step > 0) && !last) continue;
        memmove(trail->at[kept], trail->at[i], sizeof *trail->at);
        trail->run[kept] = kept ? trail->run[kept - 1] + step : 0;
        before = x;
        kept++;
    }
    trail->count = kept;
}

void gd__trail_place(const struct gd__trail *trail, double position, double at[2])
{
    uint32_t i = position > 0 ? (uint32_t)position : 0;
    if (i > trail->count - 2) i = trail->count - 2;
    double part = fmin(fmax(position - i, 0), 1);
    for (int k = 0; k < 2; k++) at[k] = (1 - part) * trail->at[i][k] + part * trail->at[i + 1][k];
}

double gd__trail_position(const struct gd__trail *trail, double run, uint32_t from)
{
    uint32_t low = from, high = trail->count - 1;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (run < trail->run[middle])
            high = middle;
        else
            low = middle;
    }
    double step = trail->run[low + 1] - trail->run[low];
    return low + (step > 0 ? fmin(fmax((run - trail->run[low]) / step, 0), 1) : 0);
}

enum gd_status gd__trail_of_chain(const struct gd__chain *chain, struct gd__trail *out)
{
    struct gd__trail trail = {0};
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        const struct gd__piece *piece = &chain->pieces[i];
        for (uint32_t span = 0; span < piece->spans; span++) {
            const double *knot = piece->knots + chain->degree + span;
            bool last = i + 1 == chain->piece_count && span + 1 == piece->spans;
            for (int k = 0; k < PARTS + last && !status; k++) {
                struct gd__curve_jet c;
                gd__piece_at(chain, piece, span, knot[0] + (knot[1] - knot[0]) * k / PARTS, &c);
                status = gd__trail_add(&trail, c.at);
            }
        }
    }
    if (status) {
        gd__trail_free(&trail);
        return status;
    }
    gd__trail_measure(chain->surface, &trail);
    *out = trail;
    return GD_OK;
}
