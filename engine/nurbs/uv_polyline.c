#include "nurbs/uv_polyline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "nurbs/bspline.h"

void gd__uv_polyline_free(struct gd__uv_polyline *polyline)
{
    free(polyline->at);
    free(polyline->arc);
    *polyline = (struct gd__uv_polyline){0};
}

enum gd_status gd__uv_polyline_add(struct gd__uv_polyline *polyline, const double at[2])
{
    /* a lower bound of the first array's capacity, which is larger if extending the second array
       failed before */
    uint32_t capacity = polyline->capacity;
    enum gd_status status = gd__array_extend(&polyline->at, &capacity, polyline->count + 1ULL,
                                             sizeof *polyline->at, NULL);
    if (!status)
        status = gd__array_extend(&polyline->arc, &polyline->capacity, polyline->count + 1ULL,
                                  sizeof *polyline->arc, NULL);
    if (!status) memcpy(polyline->at[polyline->count++], at, sizeof *polyline->at);
    return status;
}

enum gd_status gd__uv_polyline_append(struct gd__uv_polyline *polyline,
                                      const struct gd__uv_polyline *from, uint32_t begin,
                                      uint32_t end)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = begin; i < end && !status; i++)
        status = gd__uv_polyline_add(polyline, from->at[i]);
    return status;
}

void gd__uv_polyline_measure(const struct gd_parametric *surface, struct gd__uv_polyline *polyline)
{
    uint32_t kept = 0;
    struct gd_vec3 before = {0};
    for (uint32_t i = 0; i < polyline->count; i++) {
        struct gd_vec3 x = gd__surface_position(surface, polyline->at[i]);
        double step = i ? gd_vec3_distance(before, x) : 0;
        bool last = i + 1 == polyline->count;
        if (i && !(step > 0) && !last) continue;
        memmove(polyline->at[kept], polyline->at[i], sizeof *polyline->at);
        polyline->arc[kept] = kept ? polyline->arc[kept - 1] + step : 0;
        before = x;
        kept++;
    }
    polyline->count = kept;
}

void gd__uv_polyline_at(const struct gd__uv_polyline *polyline, double position, double at[2])
{
    uint32_t i = position > 0 ? (uint32_t)position : 0;
    if (i > polyline->count - 2) i = polyline->count - 2;
    double part = fmin(fmax(position - i, 0), 1);
    for (int k = 0; k < 2; k++)
        at[k] = (1 - part) * polyline->at[i][k] + part * polyline->at[i + 1][k];
}

double gd__uv_polyline_position(const struct gd__uv_polyline *polyline, double run, uint32_t from)
{
    uint32_t low = gd__interval(polyline->arc, from, polyline->count - 1, run);
    double step = polyline->arc[low + 1] - polyline->arc[low];
    return low + (step > 0 ? fmin(fmax((run - polyline->arc[low]) / step, 0), 1) : 0);
}

enum gd_status gd__uv_polyline_sample(const struct gd__chain *chain, struct gd__uv_polyline *out)
{
    enum { PARTS = GD__SAMPLES_A_SPAN };
    struct gd__uv_polyline polyline = {0};
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        const struct gd__piece *piece = &chain->pieces[i];
        for (uint32_t span = 0; span < piece->spans; span++) {
            const double *knot = piece->knots + chain->degree + span;
            bool last = i + 1 == chain->piece_count && span + 1 == piece->spans;
            for (int k = 0; k < PARTS + last && !status; k++) {
                struct gd__curve_jet c;
                gd__piece_at(chain, piece, span, knot[0] + (knot[1] - knot[0]) * k / PARTS, &c);
                status = gd__uv_polyline_add(&polyline, c.at);
                if (!status) status = gd__pace_step(chain->pace, GD__STEP / 8);
            }
        }
    }
    if (status)
        gd__uv_polyline_free(&polyline);
    else
        *out = polyline;
    return status;
}

enum gd_status gd__uv_polyline_of_chain(const struct gd__chain *chain, struct gd__uv_polyline *out)
{
    enum gd_status status = gd__uv_polyline_sample(chain, out);
    if (!status) gd__uv_polyline_measure(chain->surface, out);
    return status;
}
