/* Loop, Smooth subdivision surfaces based on triangles (1987): triangles, quartic box splines. */
#include "subdiv/scheme.h"

#include <math.h>

static uint32_t loop_child_at(double s, double t, double ds, double dt, double slack)
{
    if (gd__is_beyond(s, ds, slack)) return 1;
    if (gd__is_beyond(t, dt, slack)) return 2;
    return gd__is_beyond(s + t, ds + dt, slack) ? 3 : 0;
}

/* Returns the corner opposite to a side in its face. */
static struct gd_vec3 apex(const struct gd__net *net, uint32_t side)
{
    return net->points[net->origin[gd__net_previous(net, side)]];
}

static struct gd_vec3 edge_point(const struct gd__net *net, uint32_t side,
                                 const struct gd_vec3 *face_points)
{
    (void)face_points;
    struct gd_vec3 ends =
        gd_vec3_add(net->points[net->origin[side]], net->points[gd__side_end(net, side)]);
    struct gd_vec3 wings = gd_vec3_add(apex(net, side), apex(net, net->twin[side]));
    return gd_vec3_along(gd_vec3_scale(ends, 0.375), 0.125, wings);
}

static struct gd_vec3 loop_spoke(const struct gd__net *net, const struct gd__fan *fan, uint32_t i)
{
    return net->points[gd__spoke_end(net, fan, i % gd__fan_spokes(fan))];
}

static struct gd_vec3 sum_of_spokes(const struct gd__net *net, const struct gd__fan *fan)
{
    struct gd_vec3 sum = {0};
    for (uint32_t i = 0; i < fan->count; i++) sum = gd_vec3_add(sum, loop_spoke(net, fan, i));
    return sum;
}

/* Returns Loop's weight of each neighbour. */
static double beta(uint32_t n)
{
    double c = 0.375 + 0.25 * cos(2 * M_PI / n);
    return (0.625 - c * c) / n;
}

static struct gd_vec3 vertex_point(const struct gd__net *net, const struct gd__fan *fan,
                                   const struct gd_vec3 *face_points)
{
    (void)face_points;
    double b = beta(fan->count);
    struct gd_vec3 own = net->points[net->origin[fan->sides[0]]];
    return gd_vec3_along(gd_vec3_scale(own, 1 - fan->count * b), b, sum_of_spokes(net, fan));
}

static struct gd_vec3 loop_limit(const struct gd__net *net, const struct gd__fan *fan)
{
    double own_weight = 0.375 / beta(fan->count);
    struct gd_vec3 own = net->points[net->origin[fan->sides[0]]];
    return gd_vec3_scale(gd_vec3_along(sum_of_spokes(net, fan), own_weight, own),
                         1 / (own_weight + fan->count));
}

static struct gd_vec3 loop_tangent(const struct gd__net *net, const struct gd__fan *fan,
                                   double angle)
{
    struct gd_vec3 sum = {0};
    for (uint32_t i = 0; i < fan->count; i++)
        sum = gd_vec3_along(sum, cos(i * 2 * M_PI / fan->count - angle), loop_spoke(net, fan, i));
    return sum;
}

/* Returns the sum of E - V over the neighbours E of the vertex V. If V is fixed, a subdivision step
 * multiplies this sum by 5/8. Components that are not symmetric under rotation shrink faster. */
static struct gd_vec3 loop_axis(const struct gd__net *net, const struct gd__fan *fan)
{
    struct gd_vec3 own = net->points[net->origin[fan->sides[0]]];
    return gd_vec3_along(sum_of_spokes(net, fan), -(double)fan->count, own);
}

/* Returns the tangent across a crease with k faces: the product of the points with the left
 * eigenvector for (3 + 2 cos theta) / 8, theta = pi / k. One step maps S = sum sin(i theta) E_i to
 * a multiple of S plus multiples of V and of the crease's neighbours Ea, Eb. To compensate for
 * these multiples, the eigenvector also contains a V + b (Ea + Eb), where sigma = cot(theta / 2), b
 * = (sin theta - sigma) / (1 + 2 cos theta) and a = -sigma - 2 b. */
static struct gd_vec3 loop_cross(const struct gd__net *net, const struct gd__fan *fan,
                                 uint32_t begin, uint32_t faces)
{
    struct gd_vec3 own = net->points[net->origin[fan->sides[0]]];
    struct gd_vec3 ends =
        gd_vec3_add(loop_spoke(net, fan, begin), loop_spoke(net, fan, begin + faces));
    if (faces == 1) return gd_vec3_along(ends, -2, own);
    double theta = M_PI / faces, sigma = 1 / tan(theta / 2),
           b = (sin(theta) - sigma) / (1 + 2 * cos(theta));
    struct gd_vec3 sum = gd_vec3_along(gd_vec3_scale(own, -sigma - 2 * b), b, ends);
    for (uint32_t i = 1; i < faces; i++)
        sum = gd_vec3_along(sum, sin(i * theta), loop_spoke(net, fan, begin + i));
    return sum;
}

/* Lists the six neighbours of corner k, counter-clockwise, beginning with the next corner and the
 * previous one. At a crease with three faces on this side, the neighbours beyond the crease are
 * constructed: each triangle at the crease is mirrored at the midpoint of its edge. Then the border
 * of the box spline is the crease's curve. */
static void neighbours(const struct gd__net *net, uint32_t k, struct gd__fan *fan,
                       struct gd_vec3 out[6])
{
    gd__fan_around(net, k, fan);
    uint32_t spokes = gd__fan_spokes(fan), at = 0;
    while (fan->sides[at] != k) at++;
    /* numbers of known neighbours counter-clockwise and clockwise of the spoke of side k */
    uint32_t left = 0, right = 0;
    out[0] = loop_spoke(net, fan, at);
    while (left + 1 < 6 &&
           (left == 0 || gd__spoke_sharpness(net, fan, (at + left) % spokes) == 0)) {
        left++;
        out[left] = loop_spoke(net, fan, at + left);
    }
    while (left + right + 1 < 6 &&
           gd__spoke_sharpness(net, fan, (at + spokes - right) % spokes) == 0) {
        right++;
        out[6 - right] = loop_spoke(net, fan, at + spokes - right);
    }
    if (left + right == 5) return;
    struct gd_vec3 own = net->points[net->origin[k]];
    /* spoke of the counter-clockwise end of the crease; the other end is three spokes further */
    uint32_t c = left;
    out[(c + 1) % 6] = gd_vec3_sub(gd_vec3_add(own, out[c]), out[(c + 5) % 6]);
    out[(c + 2) % 6] = gd_vec3_sub(gd_vec3_add(own, out[(c + 3) % 6]), out[(c + 4) % 6]);
}

/* Returns the index of the coefficient of a^i b^j c^(4-i-j), where a, b, c are the barycentric
 * coordinates and i + j <= 4. After to_powers it is the index of the coefficient of s^i t^j. */
static int monomial(int i, int j)
{
    int rest = 4 - i;
    return rest * (rest + 1) / 2 + rest - j;
}

struct term {
    int i, j, k; /* powers of the coordinates x, y, z */
    double factor;
};

/* Adds the point times a sum of terms. A term is a product of powers of three variables. x, y, z
 * are the numbers of the corners whose barycentric coordinates are the values of these variables.
 * Source of the basis: Stam, Evaluation of Loop subdivision surfaces (1998), appendix A. */
static void add_terms(struct gd__patch *out, struct gd_vec3 point, const struct term *terms,
                      int count, int x, int y, int z)
{
    for (int n = 0; n < count; n++) {
        int power[3];
        power[x] = terms[n].i;
        power[y] = terms[n].j;
        power[z] = terms[n].k;
        struct gd_vec3 *c = &out->c[monomial(power[0], power[1])];
        *c = gd_vec3_along(*c, terms[n].factor / 12, point);
    }
}

static const struct term at_corner[] = {
    {4, 0, 0, 6},  {3, 1, 0, 24}, {3, 0, 1, 24}, {2, 2, 0, 24}, {2, 0, 2, 24},
    {1, 3, 0, 8},  {1, 0, 3, 8},  {0, 4, 0, 1},  {0, 0, 4, 1},  {2, 1, 1, 60},
    {1, 2, 1, 36}, {1, 1, 2, 36}, {0, 3, 1, 6},  {0, 1, 3, 6},  {0, 2, 2, 12},
};
static const struct term across_edge[] = {
    /* x and y are the corners of the edge */
    {4, 0, 0, 1}, {0, 4, 0, 1}, {3, 1, 0, 6}, {1, 3, 0, 6}, {2, 2, 0, 12},
    {3, 0, 1, 2}, {0, 3, 1, 2}, {2, 1, 1, 6}, {1, 2, 1, 6},
};
/* The control point lies on the continuation of an edge beyond corner x. z is the other corner of
 * this edge. */
static const struct term beyond_corner[] = {{4, 0, 0, 1}, {3, 1, 0, 2}};

#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))

/* Converts monomials in the barycentric coordinates a = 1 - s - t, b = s, c = t to powers of s and
 * t. */
static void to_powers(struct gd__patch *patch)
{
    static const double factorial[] = {1, 1, 2, 6, 24};
    struct gd__patch powers = {0};
    for (int i = 0; i <= 4; i++) {
        for (int j = 0; i + j <= 4; j++) {
            for (int p = 0; p <= i; p++) {
                for (int q = 0; p + q <= i; q++) { /* the term (-s)^p (-t)^q of (1 - s - t)^i */
                    double ways =
                        factorial[i] / (factorial[p] * factorial[q] * factorial[i - p - q]);
                    struct gd_vec3 *c = &powers.c[monomial(j + p, 4 - i - j + q)];
                    *c = gd_vec3_along(*c, (p + q) % 2 ? -ways : ways, patch->c[monomial(i, j)]);
                }
            }
        }
    }
    *patch = powers;
}

static void loop_patch(const struct gd__net *net, struct gd__fan *fan, struct gd__patch *out)
{
    *out = (struct gd__patch){0};
    for (int k = 0; k < 3; k++) {
        int next = (k + 1) % 3, before = (k + 2) % 3;
        struct gd_vec3 ring[6];
        neighbours(net, (uint32_t)k, fan, ring);
        add_terms(out, net->points[net->origin[k]], at_corner, COUNT(at_corner), k, next, before);
        add_terms(out, ring[5], across_edge, COUNT(across_edge), k, next, before);
        add_terms(out, ring[4], beyond_corner, COUNT(beyond_corner), k, next, before);
        add_terms(out, ring[3], beyond_corner, COUNT(beyond_corner), k, before, next);
    }
    to_powers(out);
}

/* A polynomial's value and first two derivatives. */
struct horner {
    struct gd_vec3 p, d, dd;
};

/* Evaluates the polynomial with the coefficients c[0] to c[degree] by Horner's rule. */
static struct horner loop_horner(const struct gd_vec3 *c, int degree, double x)
{
    struct horner h = {0};
    for (int i = degree; i >= 0; i--) {
        h.dd = gd_vec3_along(h.d, x, h.dd);
        h.d = gd_vec3_along(h.p, x, h.d);
        h.p = gd_vec3_along(c[i], x, h.p);
    }
    h.dd = gd_vec3_scale(h.dd, 2);
    return h;
}

/* The patch at a fixed s. Its values and its derivatives by s are polynomials in t; these are their
 * coefficients. */
struct row {
    struct gd_vec3 p[5], s[5], ss[5];
};

static struct row row_at(const struct gd__patch *patch, double s)
{
    struct row row;
    for (int n = 0; n <= 4; n++) {
        struct gd_vec3 column[5];
        for (int m = 0; m + n <= 4; m++) column[m] = patch->c[monomial(m, n)];
        struct horner h = loop_horner(column, 4 - n, s);
        row.p[n] = h.p, row.s[n] = h.d, row.ss[n] = h.dd;
    }
    return row;
}

static void loop_evaluate(const struct gd__patch *patch, double s, double t, struct gd__jet *out)
{
    struct row row = row_at(patch, s);
    struct horner p = loop_horner(row.p, 4, t), ds = loop_horner(row.s, 3, t),
                  dss = loop_horner(row.ss, 2, t);
    *out = (struct gd__jet){.p = p.p, .s = ds.p, .t = p.d, .ss = dss.p, .st = ds.d, .tt = p.dd};
}

static void loop_row(const struct gd__patch *patch, uint32_t i, const struct gd__grid_rows *rows)
{
    struct row row = row_at(patch, (double)i / rows->cells);
    for (uint32_t j = 0; i + j <= rows->cells; j++) {
        double t = (double)j / rows->cells;
        struct horner p = loop_horner(row.p, 4, t), ds = loop_horner(row.s, 3, t);
        ptrdiff_t at = rows->origin + (ptrdiff_t)i * rows->step_s + (ptrdiff_t)j * rows->step_t;
        rows->positions[at] = p.p;
        rows->normals[at] = gd_vec3_cross(ds.p, p.d);
    }
}

const struct gd__scheme gd__loop = {
    .arity = 3,
    .valence = 6,
    .face_points = false,
    .children = {{{0, 0}, {1, 0}, {0, 1}},
                 {{2, 0}, {-1, 1}, {-1, 0}},
                 {{0, 2}, {0, -1}, {1, -1}},
                 {{1, 0}, {0, 1}, {-1, 1}}},
    .corner_patches = false,
    .child_at = loop_child_at,
    .edge_point = edge_point,
    .vertex_point = vertex_point,
    .limit = loop_limit,
    .tangent = loop_tangent,
    .axis = loop_axis,
    .cross = loop_cross,
    .patch = loop_patch,
    .evaluate = loop_evaluate,
    .row = loop_row,
};
