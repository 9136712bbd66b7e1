#include "nurbs/energy.h"

#include <string.h>

double gd__energy_value(const struct gd__chain *chain, const struct gd__piece *piece)
{
    int gauss = gd__chain_gauss(chain);
    double sum = 0;
    for (uint32_t span = 0; span < piece->spans && gd__pace(chain->pace, GD__STEP); span++) {
        const double *knot = piece->knots + chain->degree + span;
        for (int g = 0; g < gauss; g++) {
            struct gd__curve_jet c;
            struct gd_jet x;
            gd__piece_node(chain, piece, span, g, &c);
            gd__piece_jet(chain, piece, c.at, &x);
            struct gd_vec3 d = gd__velocity(&x, c.first);
            sum += 0.5 * (knot[1] - knot[0]) * gd__gauss(gauss)->weight[g] * gd_vec3_dot(d, d);
        }
    }
    return sum;
}

/* Terms of the Hessian at a node. Let d be the velocity d/dt x of the piece, x_a the surface's
 * derivative by coordinate a, and y_a = d/dt x_a. The derivative of d by coordinate a of control
 * point i is J_ia = N_i' x_a + N_i y_a. Then J_ia . J_jb = N_i' N_j' metric[a][b] + N_i' N_j
 * mixed[a][b] + N_i N_j' mixed[b][a] + N_i N_j square[a][b]. `square` also includes the terms of
 * make_covariant. */
struct forms {
    double linear[2], slope[2]; /* d . y_a, d . x_a */
    double metric[2][2], mixed[2][2], square[2][2];
};

/* Subtracts the normal components of y_a from `square`, and the curvature term K w w^T with K det g
 * = LN - M^2. */
static void make_covariant(const struct gd_jet *x, const double first[2], struct forms *f)
{
    struct gd_vec3 normal = gd_vec3_cross(x->u, x->v);
    double area = gd_vec3_length(normal);
    if (!(area > 0)) return;
    normal = gd_vec3_scale(normal, 1 / area);
    double l = gd_vec3_dot(x->uu, normal), m = gd_vec3_dot(x->uv, normal),
           n = gd_vec3_dot(x->vv, normal);
    double off[2] = {l * first[0] + m * first[1], m * first[0] + n * first[1]}, k = l * n - m * m;
    double across[2] = {-first[1], first[0]};
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) f->square[a][b] -= off[a] * off[b] + k * across[a] * across[b];
}

static void forms_of(const struct gd_jet *x, const double first[2], enum gd__hessian kind,
                     struct forms *out)
{
    struct gd_vec3 d = gd__velocity(x, first), tangent[2] = {x->u, x->v};
    struct gd_vec3 turn[2] = {gd_vec3_along(gd_vec3_scale(x->uu, first[0]), first[1], x->uv),
                              gd_vec3_along(gd_vec3_scale(x->uv, first[0]), first[1], x->vv)};
    for (int a = 0; a < 2; a++) {
        out->linear[a] = gd_vec3_dot(d, turn[a]);
        out->slope[a] = gd_vec3_dot(d, tangent[a]);
        for (int b = 0; b < 2; b++) {
            out->metric[a][b] = gd_vec3_dot(tangent[a], tangent[b]);
            out->mixed[a][b] = gd_vec3_dot(tangent[a], turn[b]);
            out->square[a][b] = gd_vec3_dot(turn[a], turn[b]);
        }
    }
    if (kind == GD__HESSIAN_NEWTON) make_covariant(x, first, out);
}

/* Adds a node to gradient and Hessian. `first_unknown` is the first unknown of the span's first
 * point. */
static void add_node(const struct gd__chain *chain, const struct gd__node *node,
                     const struct forms *f, double weight, uint32_t first_unknown,
                     struct gd__energy *out)
{
    uint32_t width = gd__energy_width(chain);
    for (uint32_t i = 0; i <= chain->degree; i++) {
        double n = weight * node->value[i], n1 = weight * node->first[i];
        for (int a = 0; a < 2; a++) {
            uint32_t row = first_unknown + 2 * i + (uint32_t)a;
            out->gradient[row] += n * f->linear[a] + n1 * f->slope[a];
            double *entry = out->hessian + (size_t)row * width;
            for (uint32_t j = 0; j <= i; j++) {
                double m = node->value[j], m1 = node->first[j];
                for (int b = 0; b < (j == i ? a + 1 : 2); b++)
                    entry[2 * (i - j) + (uint32_t)(a - b)] +=
                        n1 * (m1 * f->metric[a][b] + m * f->mixed[a][b]) +
                        n * (m1 * f->mixed[b][a] + m * f->square[a][b]);
            }
        }
    }
}

void gd__energy_expand(const struct gd__chain *chain, const struct gd__piece *piece,
                       enum gd__hessian kind, struct gd__energy *out)
{
    uint32_t unknowns = 2 * gd__piece_points(chain, piece);
    int gauss = gd__chain_gauss(chain);
    out->value = 0;
    memset(out->gradient, 0, unknowns * sizeof *out->gradient);
    memset(out->hessian, 0, (size_t)unknowns * gd__energy_width(chain) * sizeof *out->hessian);
    for (uint32_t span = 0; span < piece->spans && gd__pace(chain->pace, GD__STEP); span++) {
        const double *knot = piece->knots + chain->degree + span;
        for (int g = 0; g < gauss; g++) {
            struct gd__curve_jet c;
            struct gd_jet x;
            struct forms forms;
            double weight = (knot[1] - knot[0]) * gd__gauss(gauss)->weight[g];
            gd__piece_node(chain, piece, span, g, &c);
            gd__piece_jet(chain, piece, c.at, &x);
            forms_of(&x, c.first, kind, &forms);
            out->value +=
                0.5 * weight * (forms.slope[0] * c.first[0] + forms.slope[1] * c.first[1]);
            add_node(chain, &piece->nodes[span * (uint32_t)gauss + (uint32_t)g], &forms, weight,
                     2 * span, out);
        }
    }
}

void gd__energy_bend(const struct gd__chain *chain, const struct gd__piece *piece, uint32_t span,
                     double *bend, double *length)
{
    int gauss = gd__chain_gauss(chain);
    const double *knot = piece->knots + chain->degree + span;
    *bend = *length = 0;
    if (!gd__pace(chain->pace, GD__STEP)) return;
    for (int g = 0; g < gauss; g++) {
        struct gd__curve_jet c;
        struct gd_jet x;
        gd__piece_node(chain, piece, span, g, &c);
        gd__piece_jet(chain, piece, c.at, &x);
        struct gd_vec3 d = gd__velocity(&x, c.first), a = gd__acceleration(&x, &c);
        struct gd_vec3 normal = gd_vec3_cross(x.u, x.v);
        double area = gd_vec3_length(normal), speed = gd_vec3_length(d);
        double weight = (knot[1] - knot[0]) * gd__gauss(gauss)->weight[g];
        *length += weight * speed;
        if (!(area > 0) || !(speed > 0)) continue;
        double curvature =
            gd_vec3_dot(gd_vec3_cross(d, a), normal) / (area * speed * speed * speed);
        *bend += weight * speed * curvature * curvature;
    }
}

double gd__energy_length(const struct gd__chain *chain, const struct gd__piece *piece,
                         uint32_t span, int gauss, int parts)
{
    const double *knot = piece->knots + chain->degree + span, width = (knot[1] - knot[0]) / parts;
    const struct gd__gauss *rule = gd__gauss(gauss);
    double sum = 0;
    for (int i = 0; i < parts * gauss && gd__pace(chain->pace, GD__STEP); i++) {
        struct gd__curve_jet c;
        struct gd_jet x;
        gd__piece_at(chain, piece, span, knot[0] + (i / gauss + rule->node[i % gauss]) * width, &c);
        gd__piece_jet(chain, piece, c.at, &x);
        sum += rule->weight[i % gauss] * width * gd_vec3_length(gd__velocity(&x, c.first));
    }
    return sum;
}
