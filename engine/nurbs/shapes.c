/* Analytic surfaces: torus, helicoid, graph of a polynomial. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/parametric.h"

static enum gd_status no_memory(struct gd_detail *detail)
{
    return gd_fail_status(detail, GD_NO_MEMORY);
}

static bool is_range(const double range[2])
{
    return isfinite(range[0]) && isfinite(range[1]) && range[0] < range[1];
}

/* --- torus ------------------------------------------------------------------------------------ */

struct torus {
    double major, minor;
};

static void torus_jet(const void *shape, uint32_t cell_u, uint32_t cell_v, double u, double v,
                      struct gd_jet *out)
{
    (void)cell_u, (void)cell_v;
    const struct torus *torus = shape;
    double cu = cos(u), su = sin(u), rc = torus->minor * cos(v), rs = torus->minor * sin(v),
           w = torus->major + rc;
    *out = (struct gd_jet){.x = {w * cu, w * su, rs},
                           .u = {-w * su, w * cu, 0},
                           .v = {-rs * cu, -rs * su, rc},
                           .uu = {-w * cu, -w * su, 0},
                           .uv = {rs * su, -rs * cu, 0},
                           .vv = {-rc * cu, -rc * su, -rs}};
}

enum gd_status gd_parametric_torus(double major, double minor, struct gd_parametric **out,
                                   struct gd_detail *detail)
{
    if (!(minor > 0 && minor < major && isfinite(major)))
        return gd_fail(
            detail, GD_INVALID_ARGUMENT,
            "a torus needs a minor radius greater than 0 and less than its major radius");
    struct torus *torus = malloc(sizeof *torus);
    if (!torus) return no_memory(detail);
    *torus = (struct torus){major, minor};
    struct gd_axis turn = {.low = 0, .high = 2 * M_PI, .closed = true};
    return gd_parametric_create(
        &(struct gd_evaluator){turn, turn, torus_jet, free, torus, sizeof *torus}, out, detail);
}

/* --- helicoid --------------------------------------------------------------------------------- */

static void helicoid_jet(const void *shape, uint32_t cell_u, uint32_t cell_v, double u, double v,
                         struct gd_jet *out)
{
    (void)cell_u, (void)cell_v;
    double pitch = *(const double *)shape, c = cos(u), s = sin(u);
    *out = (struct gd_jet){.x = {v * c, v * s, pitch * u},
                           .u = {-v * s, v * c, pitch},
                           .v = {c, s, 0},
                           .uu = {-v * c, -v * s, 0},
                           .uv = {-s, c, 0}};
}

enum gd_status gd_parametric_helicoid(double pitch, const double u_range[2],
                                      const double v_range[2], struct gd_parametric **out,
                                      struct gd_detail *detail)
{
    if (!isfinite(pitch) || pitch == 0 || !is_range(u_range) || !is_range(v_range))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a helicoid needs a finite pitch that is not 0 and two ranges [low, high] "
                       "with low < high");
    double *kept = malloc(sizeof *kept);
    if (!kept) return no_memory(detail);
    *kept = pitch;
    return gd_parametric_create(&(struct gd_evaluator){{.low = u_range[0], .high = u_range[1]},
                                                       {.low = v_range[0], .high = v_range[1]},
                                                       helicoid_jet,
                                                       free,
                                                       kept,
                                                       sizeof *kept},
                                out, detail);
}

/* --- graph of a polynomial -------------------------------------------------------------------- */

struct graph {
    uint32_t degree_u, degree_v;
    double coefficients[];
};

/* Computes value and two derivatives of a polynomial by Horner's rule. */
static void shapes_horner(uint32_t degree, const double *coefficients, double t, double out[3])
{
    out[0] = out[1] = out[2] = 0;
    for (uint32_t i = degree + 1; i-- > 0;) {
        out[2] = out[2] * t + 2 * out[1];
        out[1] = out[1] * t + out[0];
        out[0] = out[0] * t + coefficients[i];
    }
}

static void graph_jet(const void *shape, uint32_t cell_u, uint32_t cell_v, double u, double v,
                      struct gd_jet *out)
{
    (void)cell_u, (void)cell_v;
    const struct graph *graph = shape;
    double rows[3][GD_GRAPH_DEGREE_MAX + 1], sum[3][3];
    for (uint32_t i = 0; i <= graph->degree_u; i++) {
        double row[3];
        shapes_horner(graph->degree_v, graph->coefficients + i * (graph->degree_v + 1), v, row);
        for (int k = 0; k < 3; k++) rows[k][i] = row[k];
    }
    for (int k = 0; k < 3; k++) shapes_horner(graph->degree_u, rows[k], u, sum[k]);
    *out = (struct gd_jet){.x = {u, v, sum[0][0]},
                           .u = {1, 0, sum[0][1]},
                           .v = {0, 1, sum[1][0]},
                           .uu = {0, 0, sum[0][2]},
                           .uv = {0, 0, sum[1][1]},
                           .vv = {0, 0, sum[2][0]}};
}

enum gd_status gd_parametric_graph(const struct gd_graph *wanted, struct gd_parametric **out,
                                   struct gd_detail *detail)
{
    uint32_t degree_u = wanted->degree_u, degree_v = wanted->degree_v;
    const double *u_range = wanted->u_range, *v_range = wanted->v_range;
    if (degree_u > GD_GRAPH_DEGREE_MAX || degree_v > GD_GRAPH_DEGREE_MAX)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "a polynomial's degrees must not be above %d",
                       GD_GRAPH_DEGREE_MAX);
    if (!is_range(u_range) || !is_range(v_range))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a graph needs two finite ranges [low, high] with low < high");
    uint32_t count = (degree_u + 1) * (degree_v + 1);
    for (uint32_t i = 0; i < count; i++)
        if (!isfinite(wanted->coefficients[i]))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "coefficient %u of the polynomial is not finite", i);
    size_t bytes = sizeof(struct graph) + count * sizeof(double);
    struct graph *graph = malloc(bytes);
    if (!graph) return no_memory(detail);
    graph->degree_u = degree_u;
    graph->degree_v = degree_v;
    memcpy(graph->coefficients, wanted->coefficients, count * sizeof(double));
    return gd_parametric_create(&(struct gd_evaluator){{.low = u_range[0], .high = u_range[1]},
                                                       {.low = v_range[0], .high = v_range[1]},
                                                       graph_jet,
                                                       free,
                                                       graph,
                                                       bytes},
                                out, detail);
}
