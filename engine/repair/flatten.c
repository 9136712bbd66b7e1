/* Removes faces without area.
 *
 * DESIGN. A face is flat if its height over its longest edge is below GD_TOL_FLAT of that edge.
 * gd__make_sides rejects faces by the same test. Faces are removed in rounds until none is flat:
 *
 *   needle  the shortest edge is below GD_TOL_FLAT of the longest one: its ends are merged, and the
 *           faces at the edge vanish. A round that merges vertices handles no caps, because
 *           connectivity must be rebuilt first. A face that is slightly too wide for a needle may
 *           stay flat after every flip. So after PATIENT_ROUNDS rounds the bound is ten times as
 *           large.
 *   cap     the corner opposite to the longest edge lies on that edge, well between its ends: the
 *           edge is flipped in the quadrilateral with the neighbour. If the longest edge does not
 *           have exactly one neighbour, the cap is removed. The surface stays the same, and the two
 *           short edges become its border.
 *
 * The neighbour of a cap may be a cap too. Caps are processed in order of their longest edge, the
 * longest first. Then the neighbour either is not flat or has the same longest edge, and the flip
 * creates only shorter edges. A cap with the same corners as its neighbour vanishes together with
 * it. Flips may create edges of four faces, or duplicates; the later steps repair these. The work
 * is bounded; gd__make_sides rejects a flat face that is left. */
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/large.h"
#include "mesh/edge_table.h"
#include "repair/repair.h"
#include "mesh/triangle.h"
#include "mesh/union_find.h"

#define MOST_ROUNDS    32
#define PATIENT_ROUNDS 8
#define FLIPS_A_FACE   16
#define STEPS_A_CAP    32

struct flat_face {
    double longest; /* length of its longest edge */
    uint32_t face;
};

struct flattening {
    struct gd__construction *work;
    /* for each side, the side of the neighbouring face, or GD_NONE if there is not exactly one
       neighbour */
    uint32_t *neighbour;
    /* a heap; its top is the face with the longest edge, or in a tie the face with the lowest
       number */
    struct flat_face *heap;
    uint32_t count, capacity;
    uint64_t flips_left;
    /* the ends of a shortest edge are merged if its ratio to the longest edge is below this */
    double needle;
};

/* --- measuring -------------------------------------------------------------------------------- */

static struct gd__triangle flatten_measure(const struct gd__construction *work, uint32_t face,
                                           double *unit)
{
    struct gd_vec3 corner[3], edge[3];
    double largest = 0;
    for (int k = 0; k < 3; k++) corner[k] = gd__input_position(work, work->triangle[face][k]);
    for (int k = 0; k < 3; k++) {
        edge[k] = gd_vec3_sub(corner[(k + 1) % 3], corner[k]);
        largest = fmax(largest, fmax(fmax(fabs(edge[k].x), fabs(edge[k].y)), fabs(edge[k].z)));
    }
    int exponent;
    frexp(largest, &exponent);
    *unit = ldexp(1, exponent < -1000 ? -1000 : exponent);
    for (int k = 0; k < 3; k++) edge[k] = gd_vec3_scale(edge[k], 1 / *unit);
    return gd__triangle_measure(edge[0], edge[1], edge[2]);
}

static bool is_flat(const struct gd__triangle *t)
{
    return !(gd__triangle_flatness(t) >= GD_TOL_FLAT);
}

static uint32_t shortest_edge(const struct gd__triangle *t)
{
    uint32_t k = t->length[1] < t->length[0] ? 1 : 0;
    return t->length[2] < t->length[k] ? 2 : k;
}

static bool is_needle(const struct flattening *flattening, const struct gd__triangle *t)
{
    return t->length[shortest_edge(t)] < flattening->needle * t->length[t->longest];
}

static void note_shift(const struct gd__construction *work, double length)
{
    work->mesh->repair->largest_shift = fmax(work->mesh->repair->largest_shift, length);
}

/* --- the heap --------------------------------------------------------------------------------- */

static bool flatten_precedes(struct flat_face a, struct flat_face b)
{
    return a.longest != b.longest ? a.longest > b.longest : a.face < b.face;
}

static enum gd_status flatten_push(struct flattening *flattening, struct flat_face entry)
{
    enum gd_status status =
        gd__array_extend(&flattening->heap, &flattening->capacity, flattening->count + 1ULL,
                         sizeof *flattening->heap, NULL);
    if (status) return status;
    uint32_t i = flattening->count++;
    for (; i > 0 && flatten_precedes(entry, flattening->heap[(i - 1) / 2]); i = (i - 1) / 2)
        flattening->heap[i] = flattening->heap[(i - 1) / 2];
    flattening->heap[i] = entry;
    return GD_OK;
}

static uint32_t flatten_pop(struct flattening *flattening)
{
    struct flat_face *heap = flattening->heap, top = heap[0], last = heap[--flattening->count];
    uint32_t i = 0;
    for (uint32_t child = 1; child < flattening->count; child = 2 * i + 1) {
        if (child + 1 < flattening->count && flatten_precedes(heap[child + 1], heap[child]))
            child++;
        if (!flatten_precedes(heap[child], last)) break;
        heap[i] = heap[child];
        i = child;
    }
    heap[i] = last;
    return top.face;
}

/* Adds the face to the heap if it is flat. */
static enum gd_status consider(struct flattening *flattening, uint32_t face)
{
    double unit;
    struct gd__triangle t = flatten_measure(flattening->work, face, &unit);
    if (!is_flat(&t)) return GD_OK;
    return flatten_push(flattening, (struct flat_face){t.length[t.longest] * unit, face});
}

/* --- needles ---------------------------------------------------------------------------------- */

static bool merge_ends(struct flattening *flattening, uint32_t face)
{
    struct gd__construction *work = flattening->work;
    double unit;
    struct gd__triangle t = flatten_measure(work, face, &unit);
    if (!is_needle(flattening, &t)) return false;
    uint32_t k = shortest_edge(&t);
    uint32_t a = gd__union_find_root(work->representative, work->triangle[face][k]);
    uint32_t b =
        gd__union_find_root(work->representative, work->triangle[face][gd__next_corner(k)]);
    if (a == b) return true;
    gd__union_find_join(work->representative, a, b);
    gd_mended_add(&work->mesh->repair->vertices_merged, a < b ? b : a, a < b ? a : b);
    note_shift(work, t.length[k] * unit);
    return true;
}

static void drop(struct gd__construction *work, uint32_t face)
{
    gd_mended_add(&work->mesh->repair->degenerate_faces, gd__index_of_triangle(work, face), 0);
    work->triangle[face][0] = GD_NONE;
}

/* Replaces the corners of all faces by their representatives. Removes the faces that lose a
 * corner. */
static void rename_corners(struct gd__construction *work)
{
    GD__PACED (&work->pace, f, work->mesh->face_count) {
        uint32_t *corner = work->triangle[f];
        for (int k = 0; k < 3; k++)
            corner[k] = gd__union_find_root(work->representative, corner[k]);
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
            drop(work, f);
    }
}

/* Merges the ends of the needles among the flat faces. Returns true if there were any. */
static bool merge_needles(struct flattening *flattening)
{
    bool merged = false;
    GD__PACED (&flattening->work->pace, i, flattening->count)
        merged |= merge_ends(flattening, flattening->heap[i].face);
    if (merged) rename_corners(flattening->work);
    return merged;
}

/* --- caps ------------------------------------------------------------------------------------- */

static void link(uint32_t *neighbour, uint32_t a, uint32_t b)
{
    if (a != GD_NONE) neighbour[a] = b;
    if (b != GD_NONE) neighbour[b] = a;
}

static void drop_cap(struct flattening *flattening, uint32_t face)
{
    for (uint32_t side = 3 * face; side < 3 * face + 3; side++)
        link(flattening->neighbour, flattening->neighbour[side], GD_NONE);
    drop(flattening->work, face);
}

/* An edge u-v that will be flipped, and its two faces. b is the apex of the cap. The other face has
 * the corners u, v, d in this order. */
struct quadrilateral {
    uint32_t cap, other; /* faces */
    uint32_t u, v, b, d; /* vertices */
    /* the sides of the neighbouring faces at the four outer edges */
    uint32_t over_ub, over_bv, over_vd, over_du;
};

static struct quadrilateral around(const struct flattening *flattening, uint32_t side)
{
    uint32_t across = flattening->neighbour[side], j = across % 3, k = side % 3;
    struct quadrilateral q = {.cap = side / 3, .other = across / 3};
    const uint32_t *cap = flattening->work->triangle[q.cap],
                   *other = flattening->work->triangle[q.other];
    const uint32_t *cap_neighbour = flattening->neighbour + 3 * (size_t)q.cap;
    const uint32_t *other_neighbour = flattening->neighbour + 3 * (size_t)q.other;
    q.u = other[j];
    q.v = other[gd__next_corner(j)];
    q.d = other[gd__previous_corner(j)];
    q.b = cap[gd__previous_corner(k)];
    /* true if both faces run along the edge from u to v, because the file orients them
       differently */
    bool alike = cap[k] == q.u;
    q.over_ub = cap_neighbour[alike ? gd__previous_corner(k) : gd__next_corner(k)];
    q.over_bv = cap_neighbour[alike ? gd__next_corner(k) : gd__previous_corner(k)];
    q.over_vd = other_neighbour[gd__next_corner(j)];
    q.over_du = other_neighbour[gd__previous_corner(j)];
    return q;
}

/* Removes two faces that have the same corners, and makes the faces across their outer edges
 * neighbours. */
static void close_pocket(struct flattening *flattening, const struct quadrilateral *q)
{
    link(flattening->neighbour, q->over_ub, q->over_du);
    link(flattening->neighbour, q->over_bv, q->over_vd);
    drop(flattening->work, q->cap);
    drop(flattening->work, q->other);
}

/* Flips the edge. The cap is replaced by the new face at u, the other face by the new face at v.
 * Both have the orientation that `other` had. */
static void flatten_flip(struct flattening *flattening, const struct quadrilateral *q)
{
    struct gd__construction *work = flattening->work;
    uint32_t first = 3 * q->cap, second = 3 * q->other;
    memcpy(work->triangle[q->cap], (uint32_t[3]){q->u, q->b, q->d}, sizeof *work->triangle);
    memcpy(work->triangle[q->other], (uint32_t[3]){q->b, q->v, q->d}, sizeof *work->triangle);
    link(flattening->neighbour, first, q->over_ub);
    link(flattening->neighbour, first + 2, q->over_du);
    link(flattening->neighbour, second, q->over_bv);
    link(flattening->neighbour, second + 1, q->over_vd);
    link(flattening->neighbour, first + 1, second + 2);
    gd_mended_add(&work->mesh->repair->edges_flipped, gd__index_of_triangle(work, q->cap),
                  gd__index_of_triangle(work, q->other));
}

static enum gd_status mend_cap(struct flattening *flattening, uint32_t face)
{
    double unit;
    struct gd__triangle t = flatten_measure(flattening->work, face, &unit);
    /* an earlier flip has repaired the face, or the next round handles it */
    if (!is_flat(&t) || is_needle(flattening, &t)) return GD_OK;
    uint32_t side = 3 * face + t.longest;
    note_shift(flattening->work, t.double_area / t.length[t.longest] * unit);
    if (flattening->neighbour[side] == GD_NONE) {
        drop_cap(flattening, face);
        return GD_OK;
    }
    struct quadrilateral q = around(flattening, side);
    if (q.b == q.d) {
        close_pocket(flattening, &q);
        return GD_OK;
    }
    flattening->flips_left--;
    flatten_flip(flattening, &q);
    enum gd_status status = consider(flattening, q.cap);
    return status ? status : consider(flattening, q.other);
}

static enum gd_status find_neighbours(struct flattening *flattening)
{
    struct gd__construction *work = flattening->work;
    struct gd__edge_table table;
    enum gd_status status =
        gd__edge_table_create((const uint32_t(*)[3])work->triangle, work->mesh->face_count,
                              work->input->position_count, &work->pace, &table);
    if (status) return status;
    gd__pace_fill(&work->pace, flattening->neighbour,
                  3 * (size_t)work->mesh->face_count * sizeof *flattening->neighbour);
    for (struct gd__edge_run run = {0};
         gd__pace(&work->pace, 1) && gd__edge_table_next(&table, &run);) {
        if (run.count == 2)
            link(flattening->neighbour, table.use[run.begin].side, table.use[run.begin + 1].side);
    }
    gd__edge_table_free(&table);
    return work->pace.status;
}

static enum gd_status mend_caps(struct flattening *flattening)
{
    enum gd_status status = find_neighbours(flattening);
    flattening->flips_left = FLIPS_A_FACE * (uint64_t)flattening->count;
    while (!status && flattening->count && flattening->flips_left) {
        uint32_t face = flatten_pop(flattening);
        if (flattening->work->triangle[face][0] != GD_NONE) status = mend_cap(flattening, face);
        if (!status && !gd__pace(&flattening->work->pace, STEPS_A_CAP))
            status = flattening->work->pace.status;
    }
    return status;
}

/* --- rounds ----------------------------------------------------------------------------------- */

static enum gd_status find_flat_faces(struct flattening *flattening)
{
    enum gd_status status = GD_OK;
    flattening->count = 0;
    GD__PACED (&flattening->work->pace, f, flattening->work->mesh->face_count) {
        if (!status) status = consider(flattening, f);
    }
    return status ? status : flattening->work->pace.status;
}

enum gd_status gd__flatten_faces(struct gd__construction *work)
{
    struct flattening flattening = {.work = work};
    enum gd_status status = GD_OK;
    for (int round = 0; !status && round < MOST_ROUNDS; round++) {
        flattening.needle = round < PATIENT_ROUNDS ? GD_TOL_FLAT : 10 * GD_TOL_FLAT;
        status = find_flat_faces(&flattening);
        if (status || flattening.count == 0) break;
        if (!flattening.neighbour)
            flattening.neighbour =
                gd__large_array(3 * (size_t)work->mesh->face_count, sizeof *flattening.neighbour);
        if (!flattening.neighbour) status = GD_NO_MEMORY;
        if (!status && !merge_needles(&flattening)) status = mend_caps(&flattening);
        if (!status) status = gd__compact_triangles(work);
    }
    free(flattening.neighbour);
    free(flattening.heap);
    return status;
}
