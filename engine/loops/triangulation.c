#include "loops/triangulation.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

#define NONE UINT32_MAX

/* Edge i of a triangle lies opposite corner i, between the corners i + 1 and i + 2. */
struct triangle {
    uint32_t corner[3], beside[3]; /* beside[i]: the triangle across edge i; NONE: outside */
    bool fixed[3];                 /* edge i is a constraint */
};

struct work {
    const struct gd__triangulation_input *input;
    struct gd__pace *pace;
    struct gd__lattice_node far[3]; /* corners of the triangle around all points: count + i */
    struct triangle *triangles;
    uint32_t count, last;  /* last: where the next search begins */
    uint32_t *triangle_of; /* a triangle at each point */
    uint32_t *same;        /* the first point at the same place */
    uint32_t (*stack)[2];  /* edges to be checked: triangle, edge */
    uint32_t stack_count, stack_capacity;
};

static struct gd__lattice_node node_of(const struct work *w, uint32_t point)
{
    return point < w->input->count ? w->input->points[point] : w->far[point - w->input->count];
}

static int turn(const struct work *w, uint32_t a, uint32_t b, uint32_t c)
{
    return gd__lattice_turn(node_of(w, a), node_of(w, b), node_of(w, c));
}

/* Returns true if d lies inside the circle through a, b, c, which are counter-clockwise. */
static bool in_circle(const struct work *w, const uint32_t abc[3], uint32_t d)
{
    struct gd__lattice_node o = node_of(w, d);
    __int128 x[3], y[3], square[3];
    for (int i = 0; i < 3; i++) {
        struct gd__lattice_node p = node_of(w, abc[i]);
        x[i] = p.x - o.x, y[i] = p.y - o.y;
        square[i] = x[i] * x[i] + y[i] * y[i];
    }
    return square[0] * (x[1] * y[2] - x[2] * y[1]) + square[1] * (x[2] * y[0] - x[0] * y[2]) +
               square[2] * (x[0] * y[1] - x[1] * y[0]) >
           0;
}

static int edge_to(const struct triangle *t, uint32_t beside)
{
    for (int i = 0; i < 3; i++)
        if (t->beside[i] == beside) return i;
    return -1;
}

static int corner_of(const struct triangle *t, uint32_t point)
{
    for (int i = 0; i < 3; i++)
        if (t->corner[i] == point) return i;
    return -1;
}

static void set_triangle(struct work *w, uint32_t number, const struct triangle *t)
{
    w->triangles[number] = *t;
    for (int i = 0; i < 3; i++) w->triangle_of[t->corner[i]] = number;
}

static void replace_beside(struct work *w, uint32_t triangle, uint32_t old, uint32_t now)
{
    if (triangle == NONE) return;
    int edge = edge_to(&w->triangles[triangle], old);
    if (edge >= 0) w->triangles[triangle].beside[edge] = now;
}

/* Replaces the common edge of a triangle and its neighbour by the other diagonal of their
 * quadrangle. Let (a, b, c) be the triangle, (b, c) the edge, and d the neighbour's third corner.
 * The new triangles are (a, b, d) and (a, d, c). */
static void flip(struct work *w, uint32_t number, int edge)
{
    struct triangle t = w->triangles[number];
    uint32_t other = t.beside[edge];
    struct triangle u = w->triangles[other];
    int back = edge_to(&u, number), e1 = (edge + 1) % 3, e2 = (edge + 2) % 3;
    int b1 = (back + 1) % 3, b2 = (back + 2) % 3;
    uint32_t a = t.corner[edge], b = t.corner[e1], c = t.corner[e2], d = u.corner[back];
    struct triangle first = {
        {a, b, d}, {u.beside[b1], other, t.beside[e2]}, {u.fixed[b1], false, t.fixed[e2]}};
    struct triangle second = {
        {a, d, c}, {u.beside[b2], t.beside[e1], number}, {u.fixed[b2], t.fixed[e1], false}};
    set_triangle(w, number, &first);
    set_triangle(w, other, &second);
    replace_beside(w, u.beside[b1], other, number);
    replace_beside(w, t.beside[e1], number, other);
}

static enum gd_status push(struct work *w, uint32_t triangle, int edge)
{
    enum gd_status status = gd__array_extend(&w->stack, &w->stack_capacity, w->stack_count + 1ULL,
                                             sizeof *w->stack, NULL);
    if (status) return status;
    w->stack[w->stack_count][0] = triangle;
    w->stack[w->stack_count++][1] = (uint32_t)edge;
    return GD_OK;
}

/* Flips edges opposite a new point until no other point lies in the circumcircle of one of its
 * triangles. */
static enum gd_status legalize(struct work *w, uint32_t point)
{
    enum gd_status status = GD_OK;
    while (w->stack_count && !status) {
        uint32_t number = w->stack[--w->stack_count][0];
        struct triangle *t = &w->triangles[number];
        int edge = corner_of(t, point);
        if (!gd__pace(w->pace, 8)) return w->pace->status;
        if (edge < 0 || t->beside[edge] == NONE || t->fixed[edge]) continue;
        uint32_t other = t->beside[edge];
        const struct triangle *u = &w->triangles[other];
        int back = edge_to(u, number);
        if (!in_circle(w, t->corner, u->corner[back])) continue;
        flip(w, number, edge);
        status = push(w, number, 0);
        if (!status) status = push(w, other, 0);
    }
    return status;
}

/* Walks to the triangle that contains a point. Sets *edge to the edge on which the point lies, or
 * -1. */
static enum gd_status locate(struct work *w, uint32_t point, uint32_t *found, int *edge)
{
    uint32_t number = w->last;
    for (;;) {
        const struct triangle *t = &w->triangles[number];
        int across = -1;
        *edge = -1;
        if (!gd__pace(w->pace, 1)) return w->pace->status;
        for (int i = 0; i < 3; i++) {
            int side = turn(w, t->corner[(i + 1) % 3], t->corner[(i + 2) % 3], point);
            if (side < 0) across = i;
            if (side == 0) *edge = i;
        }
        if (across < 0) break;
        number = t->beside[across];
        if (number == NONE) return GD_INTERNAL;
    }
    *found = number;
    return GD_OK;
}

/* Divides a triangle into three triangles, which meet at a point inside it. */
static enum gd_status split_triangle(struct work *w, uint32_t number, uint32_t point)
{
    struct triangle t = w->triangles[number];
    uint32_t part[3] = {number, w->count, w->count + 1};
    w->count += 2;
    enum gd_status status = GD_OK;
    for (int i = 0; i < 3; i++) {
        int a = (i + 1) % 3, b = (i + 2) % 3;
        struct triangle piece = {{point, t.corner[a], t.corner[b]},
                                 {t.beside[i], part[a], part[b]},
                                 {t.fixed[i], false, false}};
        set_triangle(w, part[i], &piece);
        replace_beside(w, t.beside[i], number, part[i]);
    }
    for (int i = 0; i < 3 && !status; i++) status = push(w, part[i], 0);
    return status;
}

/* Divides both triangles of an edge at a point on this edge. */
static enum gd_status split_edge(struct work *w, uint32_t number, int edge, uint32_t point)
{
    struct triangle t = w->triangles[number];
    uint32_t other = t.beside[edge];
    if (other == NONE) return GD_INTERNAL;
    struct triangle u = w->triangles[other];
    int back = edge_to(&u, number), e1 = (edge + 1) % 3, e2 = (edge + 2) % 3;
    int b1 = (back + 1) % 3, b2 = (back + 2) % 3;
    uint32_t a = t.corner[edge], b = t.corner[e1], c = t.corner[e2], d = u.corner[back];
    uint32_t n1 = w->count, n2 = w->count + 1;
    w->count += 2;
    bool fixed = t.fixed[edge];
    /* (point, a, b) and (point, c, a) from t; (point, b, d) and (point, d, c) from u */
    set_triangle(
        w, number,
        &(struct triangle){{point, a, b}, {t.beside[e2], other, n1}, {t.fixed[e2], fixed, false}});
    set_triangle(
        w, n1,
        &(struct triangle){{point, c, a}, {t.beside[e1], number, n2}, {t.fixed[e1], false, fixed}});
    set_triangle(
        w, other,
        &(struct triangle){{point, b, d}, {u.beside[b1], n2, number}, {u.fixed[b1], false, fixed}});
    set_triangle(
        w, n2,
        &(struct triangle){{point, d, c}, {u.beside[b2], n1, other}, {u.fixed[b2], fixed, false}});
    replace_beside(w, t.beside[e1], number, n1);
    replace_beside(w, u.beside[b2], other, n2);
    enum gd_status status = GD_OK;
    const uint32_t parts[4] = {number, n1, other, n2};
    for (int i = 0; i < 4 && !status; i++) status = push(w, parts[i], 0);
    return status;
}

static enum gd_status insert(struct work *w, uint32_t point)
{
    uint32_t number = 0;
    int edge = -1;
    enum gd_status status = locate(w, point, &number, &edge);
    if (status) return status;
    const struct triangle *t = &w->triangles[number];
    struct gd__lattice_node p = node_of(w, point);
    for (int i = 0; i < 3; i++) {
        struct gd__lattice_node q = node_of(w, t->corner[i]);
        if (p.x != q.x || p.y != q.y) continue;
        w->same[point] = t->corner[i];
        return GD_OK;
    }
    status = edge < 0 ? split_triangle(w, number, point) : split_edge(w, number, edge, point);
    if (!status) status = legalize(w, point);
    w->last = w->triangle_of[point];
    return status;
}

/* --- constraints ------------------------------------------------------------------------------ */

/* Finds the triangle at `a` whose edge opposite to `a` the segment from `a` to `b` crosses. Sets
 * *is_edge if (a, b) is an edge: then *edge is the edge (a, b) of *number. */
static enum gd_status find_start(struct work *w, uint32_t a, uint32_t b, uint32_t *number,
                                 int *edge, bool *is_edge)
{
    uint32_t first = w->triangle_of[a], now = first;
    *is_edge = false;
    do {
        const struct triangle *t = &w->triangles[now];
        int i = corner_of(t, a);
        uint32_t p = t->corner[(i + 1) % 3], q = t->corner[(i + 2) % 3];
        if (!gd__pace(w->pace, 1)) return w->pace->status;
        if (p == b || q == b) {
            *number = now;
            *edge = p == b ? (i + 2) % 3 : (i + 1) % 3;
            *is_edge = true;
            return GD_OK;
        }
        if (turn(w, a, b, p) < 0 && turn(w, a, b, q) > 0) {
            *number = now;
            *edge = i;
            return GD_OK;
        }
        now = t->beside[(i + 1) % 3];
    } while (now != first && now != NONE);
    return GD_INVALID_ARGUMENT; /* the segment passes through a point */
}

static void fix_edge(struct work *w, uint32_t number, int edge)
{
    struct triangle *t = &w->triangles[number];
    t->fixed[edge] = true;
    if (t->beside[edge] == NONE) return;
    struct triangle *u = &w->triangles[t->beside[edge]];
    u->fixed[edge_to(u, number)] = true;
}

/* Lists the edges that the segment (a, b) crosses, as pairs of points. The first point of a pair is
 * on the right of the segment. */
static enum gd_status list_crossed(struct work *w, uint32_t a, uint32_t b, uint32_t number,
                                   int edge)
{
    enum gd_status status = GD_OK;
    w->stack_count = 0;
    for (;;) {
        const struct triangle *t = &w->triangles[number];
        uint32_t p = t->corner[(edge + 1) % 3], q = t->corner[(edge + 2) % 3],
                 other = t->beside[edge];
        if (t->fixed[edge] || other == NONE) return GD_INVALID_ARGUMENT;
        if (!gd__pace(w->pace, 1)) return w->pace->status;
        status = push(w, p, (int)q);
        if (status) return status;
        const struct triangle *u = &w->triangles[other];
        uint32_t d = u->corner[edge_to(u, number)];
        if (d == b) return GD_OK;
        int side = turn(w, a, b, d);
        if (side == 0) return GD_INVALID_ARGUMENT;
        /* the segment leaves the neighbour between d and the corner on the other side */
        number = other;
        edge = corner_of(u, side > 0 ? q : p);
    }
}

/* Finds an edge by its end points: the edge (p, q) of *number, in this direction. */
static enum gd_status find_edge(const struct work *w, uint32_t p, uint32_t q, uint32_t *number,
                                int *edge)
{
    uint32_t first = w->triangle_of[p], now = first;
    do {
        const struct triangle *t = &w->triangles[now];
        int i = corner_of(t, p);
        if (t->corner[(i + 1) % 3] == q) {
            *number = now;
            *edge = (i + 2) % 3;
            return GD_OK;
        }
        now = t->beside[(i + 1) % 3];
    } while (now != first && now != NONE);
    return GD_INTERNAL;
}

/* Flips edges until no edge crosses the segment. An edge goes to the end of the queue if its
 * quadrangle is not convex, or if the flipped edge still crosses the segment. */
static enum gd_status flip_crossed(struct work *w, uint32_t a, uint32_t b)
{
    uint64_t left = w->stack_count, rounds = 16 + 4 * left * left;
    for (uint32_t head = 0; head < w->stack_count; head++) {
        uint32_t p = w->stack[head][0], q = w->stack[head][1], number = 0;
        int edge = 0;
        if (!gd__pace(w->pace, 4)) return w->pace->status;
        if (!rounds--) return GD_INTERNAL;
        enum gd_status status = find_edge(w, p, q, &number, &edge);
        if (status) return status;
        const struct triangle *t = &w->triangles[number];
        const struct triangle *u = &w->triangles[t->beside[edge]];
        uint32_t c = t->corner[edge], d = u->corner[edge_to(u, number)];
        if (turn(w, c, p, d) > 0 && turn(w, c, d, q) > 0) {
            flip(w, number, edge);
            bool crosses =
                c != a && c != b && d != a && d != b && turn(w, a, b, c) * turn(w, a, b, d) < 0;
            if (crosses) status = push(w, c, (int)d);
        } else {
            status = push(w, p, (int)q);
        }
        if (status) return status;
    }
    return GD_OK;
}

/* Makes the segment (a, b) an edge of the triangulation, and fixes it. */
static enum gd_status force_edge(struct work *w, uint32_t a, uint32_t b)
{
    uint32_t number = 0;
    int edge = 0;
    bool is_edge;
    enum gd_status status = find_start(w, a, b, &number, &edge, &is_edge);
    if (!status && !is_edge) {
        status = list_crossed(w, a, b, number, edge);
        if (!status) status = flip_crossed(w, a, b);
        if (!status) status = find_start(w, a, b, &number, &edge, &is_edge);
        if (!status && !is_edge) status = GD_INTERNAL;
    }
    if (!status) fix_edge(w, number, edge);
    return status;
}

/* --- inside and outside ----------------------------------------------------------------------- */

enum { UNKNOWN = 2 };

/* Marks the triangles that an odd number of constraints separates from the outside. */
static enum gd_status mark_inside(struct work *w, uint8_t *inside)
{
    memset(inside, UNKNOWN, w->count);
    w->stack_count = 0;
    uint32_t first = w->triangle_of[w->input->count];
    inside[first] = 0;
    enum gd_status status = push(w, first, 0);
    while (w->stack_count && !status) {
        uint32_t number = w->stack[--w->stack_count][0];
        const struct triangle *t = &w->triangles[number];
        if (!gd__pace(w->pace, 1)) return w->pace->status;
        for (int i = 0; i < 3 && !status; i++) {
            if (t->beside[i] == NONE || inside[t->beside[i]] != UNKNOWN) continue;
            inside[t->beside[i]] = inside[number] ^ t->fixed[i];
            status = push(w, t->beside[i], 0);
        }
    }
    return status;
}

static enum gd_status collect(struct work *w, struct gd__triangulation *out)
{
    uint8_t *inside = malloc(w->count);
    uint32_t(*triangles)[3] = malloc(w->count * sizeof *triangles);
    enum gd_status status = inside && triangles ? mark_inside(w, inside) : GD_NO_MEMORY;
    uint32_t count = 0;
    for (uint32_t i = 0; i < w->count && !status; i++)
        if (inside[i] == 1) memcpy(triangles[count++], w->triangles[i].corner, sizeof *triangles);
    free(inside);
    if (status) {
        free(triangles);
        return status;
    }
    *out = (struct gd__triangulation){count, triangles};
    return GD_OK;
}

static enum gd_status work_begin(struct work *w)
{
    size_t points = w->input->count + (size_t)3;
    enum gd_status status = gd_control_afford(
        w->pace->control, points * (2 * sizeof *w->triangles + 2 * sizeof *w->same + 24));
    if (status) return status;
    w->triangles = malloc(2 * points * sizeof *w->triangles);
    w->triangle_of = calloc(points, sizeof *w->triangle_of);
    w->same = malloc(points * sizeof *w->same);
    if (!w->triangles || !w->triangle_of || !w->same) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < points; i++) w->same[i] = i;
    int64_t e = GD__LATTICE_EXTENT;
    w->far[0] = (struct gd__lattice_node){-e, -e};
    w->far[1] = (struct gd__lattice_node){4 * e, -e};
    w->far[2] = (struct gd__lattice_node){-e, 4 * e};
    uint32_t n = w->input->count;
    w->count = 1;
    set_triangle(w, 0, &(struct triangle){{n, n + 1, n + 2}, {NONE, NONE, NONE}, {false}});
    return GD_OK;
}

enum gd_status gd__plane_triangulate(const struct gd__triangulation_input *input,
                                     struct gd__pace *pace, struct gd__triangulation *out)
{
    struct work w = {.input = input, .pace = pace};
    enum gd_status status = work_begin(&w);
    for (uint32_t i = 0; i < input->count && !status; i++) status = insert(&w, i);
    for (uint32_t i = 0; i < input->segment_count && !status; i++) {
        uint32_t a = w.same[input->segments[i][0]], b = w.same[input->segments[i][1]];
        if (a != b) status = force_edge(&w, a, b);
    }
    if (!status) status = collect(&w, out);
    free(w.triangles);
    free(w.triangle_of);
    free(w.same);
    free(w.stack);
    return status;
}
