/* Catmull and Clark, Recursively generated B-spline surfaces on arbitrary topological meshes
 * (1978): quadrilaterals, bicubic B-splines. */
#include "subdiv/scheme.h"

#include <math.h>

static uint32_t catmull_clark_child_at(double s, double t, double ds, double dt, double slack)
{
    bool right = gd__is_beyond(s, ds, slack), up = gd__is_beyond(t, dt, slack);
    return up ? (right ? 2 : 3) : (right ? 1 : 0);
}

static struct gd_vec3 edge_point(const struct gd__net *net, uint32_t side,
                                 const struct gd_vec3 *face_points)
{
    struct gd_vec3 ends =
        gd_vec3_add(net->points[net->origin[side]], net->points[gd__side_end(net, side)]);
    struct gd_vec3 faces = gd_vec3_add(face_points[gd__face_of(net, side)],
                                       face_points[gd__face_of(net, net->twin[side])]);
    return gd_vec3_scale(gd_vec3_add(ends, faces), 0.25);
}

/* Returns (Q + 2R + (n-3)V) / n, where Q is the mean of the face points and R the mean of the
 * edges' midpoints. */
static struct gd_vec3 vertex_point(const struct gd__net *net, const struct gd__fan *fan,
                                   const struct gd_vec3 *face_points)
{
    double n = fan->count;
    struct gd_vec3 sum = {0};
    for (uint32_t i = 0; i < fan->count; i++) {
        sum = gd_vec3_add(sum, net->points[gd__side_end(net, fan->sides[i])]);
        sum = gd_vec3_add(sum, face_points[gd__face_of(net, fan->sides[i])]);
    }
    struct gd_vec3 own = net->points[net->origin[fan->sides[0]]];
    return gd_vec3_along(gd_vec3_scale(own, (n - 2) / n), 1 / (n * n), sum);
}

/* Returns the corner of a quad that is opposite to the origin of a side. */
static struct gd_vec3 catmull_clark_opposite(const struct gd__net *net, uint32_t side)
{
    return net->points[gd__side_end(net, gd__net_next(net, side))];
}

static struct gd_vec3 catmull_clark_spoke(const struct gd__net *net, const struct gd__fan *fan,
                                          uint32_t i)
{
    return net->points[gd__spoke_end(net, fan, i % gd__fan_spokes(fan))];
}

/* Returns (n^2 V + 4 sum E + sum F) / (n (n + 5)), where V is the vertex, E its n neighbours along
 * edges, and F the opposite corners of its n faces: Halstead, Kass, DeRose (1993). */
static struct gd_vec3 catmull_clark_limit(const struct gd__net *net, const struct gd__fan *fan)
{
    double n = fan->count;
    struct gd_vec3 sum = gd_vec3_scale(net->points[net->origin[fan->sides[0]]], n * n);
    for (uint32_t i = 0; i < fan->count; i++) {
        sum = gd_vec3_along(sum, 4, catmull_clark_spoke(net, fan, i));
        sum = gd_vec3_add(sum, catmull_clark_opposite(net, fan->sides[i]));
    }
    return gd_vec3_scale(sum, 1 / (n * (n + 5)));
}

static struct gd_vec3 catmull_clark_tangent(const struct gd__net *net, const struct gd__fan *fan,
                                            double angle)
{
    double n = fan->count, step = 2 * M_PI / n;
    double a = 1 + cos(step) + cos(M_PI / n) * sqrt(2 * (9 + cos(step)));
    struct gd_vec3 sum = {0};
    for (uint32_t i = 0; i < fan->count; i++) {
        double c = cos(i * step - angle), d = cos((i + 1) * step - angle);
        sum = gd_vec3_along(sum, a * c, catmull_clark_spoke(net, fan, i));
        sum = gd_vec3_along(sum, c + d, catmull_clark_opposite(net, fan->sides[i]));
    }
    return sum;
}

/* Eigenanalysis around a fixed vertex V with neighbours E and opposite corners F. Let e and f be
 * the sums of E - V and of F - V. A subdivision step maps them to (e + f / 4) / 2 and (2 e + f) /
 * 4. The larger eigenvalue of this map is (3 + sqrt 5) / 8. It exceeds the eigenvalue of every
 * component that is not symmetric under rotation. The left eigenvector is (1, (sqrt 5 - 1) / 4). */
static struct gd_vec3 catmull_clark_axis(const struct gd__net *net, const struct gd__fan *fan)
{
    const double weight = (sqrt(5) - 1) / 4;
    struct gd_vec3 own = net->points[net->origin[fan->sides[0]]], sum = {0};
    for (uint32_t i = 0; i < fan->count; i++) {
        sum = gd_vec3_add(sum, gd_vec3_sub(catmull_clark_spoke(net, fan, i), own));
        sum = gd_vec3_along(sum, weight,
                            gd_vec3_sub(catmull_clark_opposite(net, fan->sides[i]), own));
    }
    return sum;
}

/* Returns the tangent across a crease with k faces: the product of the points with the left
 * eigenvector for mu = (5 + cos theta + sqrt((1 + cos theta)(9 + cos theta))) / 16, theta = pi / k.
 * Let A = sum sin(i theta) E_i, B = sum (sin(i theta) + sin((i+1) theta)) F_i and a = 16 mu - 4.
 * One step maps a A + B to mu (a A + B) plus multiples of V and of the crease's neighbours Ea, Eb.
 * To compensate for these multiples, the eigenvector also contains b (Ea + Eb) - ((a + 2) sigma + 2
 * b) V, where b = (mu sin theta - (2 mu - 1/4) sigma) / (mu - 1/4) and sigma = cot(theta / 2).
 * (Biermann, Levin and Zorin 2000 derive the eigenvector for modified rules with mu = 1/2. The
 * modified rules agree with the rules here only for k = 2.) If k = 1, the tangent across is the
 * crease's curvature vector. If the crease is also straight, it is the direction to the opposite
 * corner of the face. */
static struct gd_vec3 catmull_clark_cross(const struct gd__net *net, const struct gd__fan *fan,
                                          uint32_t begin, uint32_t faces)
{
    struct gd_vec3 own = net->points[net->origin[fan->sides[0]]];
    struct gd_vec3 ends = gd_vec3_add(catmull_clark_spoke(net, fan, begin),
                                      catmull_clark_spoke(net, fan, begin + faces));
    if (faces == 1) {
        struct gd_vec3 bend = gd_vec3_along(ends, -2, own),
                       along = gd_vec3_sub(catmull_clark_spoke(net, fan, begin), own);
        double area = gd_vec3_length(gd_vec3_cross(along, bend));
        return area > 0
                   ? bend
                   : gd_vec3_sub(catmull_clark_opposite(net, fan->sides[begin % fan->count]), own);
    }
    double theta = M_PI / faces, c = cos(theta), sigma = 1 / tan(theta / 2);
    double mu = (5 + c + sqrt((1 + c) * (9 + c))) / 16, a = 16 * mu - 4;
    double b = (mu * sin(theta) - (2 * mu - 0.25) * sigma) / (mu - 0.25);
    struct gd_vec3 sum = gd_vec3_along(gd_vec3_scale(own, -(a + 2) * sigma - 2 * b), b, ends);
    for (uint32_t i = 0; i < faces; i++) {
        sum = gd_vec3_along(sum, a * sin(i * theta), catmull_clark_spoke(net, fan, begin + i));
        sum = gd_vec3_along(sum, sin(i * theta) + sin((i + 1) * theta),
                            catmull_clark_opposite(net, fan->sides[(begin + i) % fan->count]));
    }
    return sum;
}

/* For each corner of the face, its position in the 4 x 4 grid of control points. For the side that
 * begins at this corner, the step in this grid that leads across the side, out of the face. */
static const int corner_place[4][2] = {{1, 1}, {2, 1}, {2, 2}, {1, 2}},
                 outwards[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};

static struct gd_vec3 *cell(struct gd__patch *patch, int i, int j)
{
    return &patch->c[4 * i + j];
}

/* Returns a + (a - b). If this is the control point beyond a sharp edge, the border of the spline
 * is the B-spline curve of the edge. */
static struct gd_vec3 mirrored(struct gd_vec3 a, struct gd_vec3 b)
{
    return gd_vec3_sub(gd_vec3_scale(a, 2), b);
}

/* Sets the two control points beyond side k. */
static void gather_beyond(const struct gd__net *net, int k, struct gd__patch *out)
{
    const int *a = corner_place[k], *b = corner_place[(k + 1) % 4], *d = outwards[k];
    struct gd_vec3 *beyond_a = cell(out, a[0] + d[0], a[1] + d[1]),
                   *beyond_b = cell(out, b[0] + d[0], b[1] + d[1]);
    if (net->sharpness[k] > 0) {
        *beyond_a = mirrored(*cell(out, a[0], a[1]), *cell(out, a[0] - d[0], a[1] - d[1]));
        *beyond_b = mirrored(*cell(out, b[0], b[1]), *cell(out, b[0] - d[0], b[1] - d[1]));
        return;
    }
    uint32_t twin = net->twin[k];
    *beyond_a = catmull_clark_opposite(net, twin);
    *beyond_b = net->points[net->origin[gd__net_previous(net, twin)]];
}

/* Sets the control point diagonally beyond corner k, between the sides `before` and k. */
static void gather_diagonal(const struct gd__net *net, int k, struct gd__patch *out)
{
    int before = (k + 3) % 4;
    const int *a = corner_place[k], *d = outwards[k], *e = outwards[before];
    int i = a[0] + d[0] + e[0], j = a[1] + d[1] + e[1];
    if (net->sharpness[k] > 0)
        *cell(out, i, j) = mirrored(*cell(out, a[0] + e[0], a[1] + e[1]),
                                    *cell(out, a[0] + e[0] - d[0], a[1] + e[1] - d[1]));
    else if (net->sharpness[before] > 0)
        *cell(out, i, j) = mirrored(*cell(out, a[0] + d[0], a[1] + d[1]),
                                    *cell(out, a[0] + d[0] - e[0], a[1] + d[1] - e[1]));
    else
        *cell(out, i, j) = net->points[net->origin[gd__net_previous(
            net, net->twin[gd__net_next(net, net->twin[k])])]];
}

static void catmull_clark_patch(const struct gd__net *net, struct gd__fan *fan,
                                struct gd__patch *out)
{
    (void)fan;
    for (int k = 0; k < 4; k++)
        *cell(out, corner_place[k][0], corner_place[k][1]) = net->points[net->origin[k]];
    for (int k = 0; k < 4; k++) gather_beyond(net, k, out);
    for (int k = 0; k < 4; k++) gather_diagonal(net, k, out);
}

/* The uniform cubic B-spline's four weights, and their derivatives. */
struct weights {
    double b[4], d[4], dd[4];
};

static struct weights weights_at(double t)
{
    double r = 1 - t;
    return (struct weights){
        {r * r * r / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * r * r * r - 6 * r * r + 4) / 6,
         t * t * t / 6},
        {-r * r / 2, (3 * t * t - 4 * t) / 2, (4 * r - 3 * r * r) / 2, t * t / 2},
        {r, 3 * t - 2, 3 * r - 2, t}};
}

static struct gd_vec3 catmull_clark_combine(const double w[4], const struct gd_vec3 *c, int stride)
{
    struct gd_vec3 sum = gd_vec3_scale(c[0], w[0]);
    for (int i = 1; i < 4; i++) sum = gd_vec3_along(sum, w[i], c[i * stride]);
    return sum;
}

static void catmull_clark_evaluate(const struct gd__patch *patch, double s, double t,
                                   struct gd__jet *out)
{
    struct weights u = weights_at(s), v = weights_at(t);
    struct gd_vec3 p[4], d[4], dd[4];
    for (int j = 0; j < 4; j++) {
        p[j] = catmull_clark_combine(u.b, patch->c + j, 4);
        d[j] = catmull_clark_combine(u.d, patch->c + j, 4);
        dd[j] = catmull_clark_combine(u.dd, patch->c + j, 4);
    }
    *out = (struct gd__jet){catmull_clark_combine(v.b, p, 1), catmull_clark_combine(v.b, d, 1),
                            catmull_clark_combine(v.d, p, 1), catmull_clark_combine(v.b, dd, 1),
                            catmull_clark_combine(v.d, d, 1), catmull_clark_combine(v.dd, p, 1)};
}

static void catmull_clark_row(const struct gd__patch *patch, uint32_t i,
                              const struct gd__grid_rows *rows)
{
    struct weights u = weights_at((double)i / rows->cells);
    struct gd_vec3 p[4], d[4];
    for (int j = 0; j < 4; j++) {
        p[j] = catmull_clark_combine(u.b, patch->c + j, 4);
        d[j] = catmull_clark_combine(u.d, patch->c + j, 4);
    }
    for (uint32_t j = 0; j <= rows->cells; j++) {
        struct weights v = weights_at((double)j / rows->cells);
        ptrdiff_t at = rows->origin + (ptrdiff_t)i * rows->step_s + (ptrdiff_t)j * rows->step_t;
        rows->positions[at] = catmull_clark_combine(v.b, p, 1);
        rows->normals[at] =
            gd_vec3_cross(catmull_clark_combine(v.b, d, 1), catmull_clark_combine(v.d, p, 1));
    }
}

const struct gd__scheme gd__catmull_clark = {
    .arity = 4,
    .valence = 4,
    .face_points = true,
    .children = {{{0, 0}, {1, 0}, {0, 1}},
                 {{2, 0}, {0, 1}, {-1, 0}},
                 {{2, 2}, {-1, 0}, {0, -1}},
                 {{0, 2}, {0, -1}, {1, 0}}},
    .corner_patches = true,
    .child_at = catmull_clark_child_at,
    .edge_point = edge_point,
    .vertex_point = vertex_point,
    .limit = catmull_clark_limit,
    .tangent = catmull_clark_tangent,
    .axis = catmull_clark_axis,
    .cross = catmull_clark_cross,
    .patch = catmull_clark_patch,
    .evaluate = catmull_clark_evaluate,
    .row = catmull_clark_row,
};
