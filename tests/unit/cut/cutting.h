/* Helpers of the tests of engine/cut. They make a cut, build its pieces by the ordinary builder,
 * and check the properties of every cut. */
#pragma once

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/cut.h"
#include "gd/locate.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* A cut and its pieces as meshes. */
struct cutting {
    struct gd_cut cut;
    struct gd_mesh **pieces;
};

static inline void cutting_free(struct cutting *cutting)
{
    for (uint32_t i = 0; i < cutting->cut.piece_count; i++) gd_mesh_release(cutting->pieces[i]);
    free(cutting->pieces);
    gd_cut_free(&cutting->cut);
}

/* Cuts the mesh and builds the pieces, or fails the test. */
static inline struct cutting cutting_along(const struct gd_mesh *mesh, const struct gd_curve *curve)
{
    struct cutting cutting;
    struct gd_detail detail = {0};
    const struct gd_cut_request request = {.curve = curve};
    check_ok(gd_cut_along(mesh, &request, NULL, &cutting.cut, &detail), &detail);
    cutting.pieces = calloc(cutting.cut.piece_count, sizeof *cutting.pieces);
    for (uint32_t i = 0; i < cutting.cut.piece_count; i++)
        cutting.pieces[i] = test_mesh(&cutting.cut.pieces[i].polygons);
    return cutting;
}

/* Returns the curve through the points. Shortest paths join consecutive points. */
static inline struct gd_curve curve_through(const struct gd_mesh *mesh,
                                            const struct gd_point *points, uint32_t count,
                                            bool closed)
{
    const struct gd_curve_request request = {
        .kind = GD_CURVE_POINTS, .closed = closed, .count = count, .points = points};
    struct gd_curve curve;
    struct gd_detail detail = {0};
    check_ok(gd_curve_resolve(mesh, &request, NULL, &curve, &detail), &detail);
    return curve;
}

static inline struct cutting cutting_through(const struct gd_mesh *mesh,
                                             const struct gd_point *points, uint32_t count,
                                             bool closed)
{
    struct gd_curve curve = curve_through(mesh, points, count, closed);
    struct cutting cutting = cutting_along(mesh, &curve);
    gd_curve_free(&curve);
    return cutting;
}

static inline struct gd_point vertex_of(const struct gd_mesh *mesh, uint32_t index)
{
    struct gd_point point;
    check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){index}, &point, NULL), NULL);
    return point;
}

/* Returns the point of the surface that is nearest to a position in space. */
static inline struct gd_point point_at(const struct gd_mesh *mesh, double x, double y, double z)
{
    struct gd_point point;
    check_ok(gd_locate_nearest(mesh, (struct gd_vec3){x, y, z}, 1e-9, &point, NULL), NULL);
    return point;
}

static inline struct gd_mesh *sample_mesh(const char *name, const double values[SAMPLE_PARAMETERS])
{
    struct gd_polygons polygons;
    check_ok(sample_find(name)->generate(values, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

/* --- borders ---------------------------------------------------------------------------------- */

/* Identifies a vertex. Its copies in several pieces have the same `parent` and the same
 * position. */
struct place {
    uint32_t parent;
    double position[3];
};

struct border { /* a side without a neighbouring face in its piece */
    struct place from, to;
    bool is_turned; /* `from` and `to` were exchanged, so that the smaller index comes first */
};

struct borders {
    struct border *items;
    uint32_t count;
};

static inline int by_place(const void *a, const void *b)
{
    const struct place *p = a, *q = b;
    if (p->parent != q->parent) return p->parent < q->parent ? -1 : 1;
    for (int axis = 0; axis < 3; axis++)
        if (p->position[axis] != q->position[axis])
            return p->position[axis] < q->position[axis] ? -1 : 1;
    return 0;
}

static inline int by_ends(const void *a, const void *b)
{
    const struct border *p = a, *q = b;
    int from = by_place(&p->from, &q->from), to = by_place(&p->to, &q->to);
    return from ? from : to ? to : p->is_turned - q->is_turned;
}

struct directed {
    uint32_t low, high;
    bool is_turned;
};

static inline int by_vertices(const void *a, const void *b)
{
    const struct directed *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    return p->high != q->high ? (p->high < q->high ? -1 : 1) : 0;
}

static inline struct place place_of(const struct gd_cut_piece *piece, uint32_t vertex)
{
    struct place place = {.parent = piece->vertex_map[vertex]};
    memcpy(place.position, piece->polygons.positions[vertex], sizeof place.position);
    return place;
}

static inline void add_border(struct borders *borders, const struct gd_cut_piece *piece,
                              const struct directed *side)
{
    struct border border = {place_of(piece, side->low), place_of(piece, side->high),
                            side->is_turned};
    if (by_place(&border.from, &border.to) > 0) {
        struct place from = border.from;
        border.from = border.to;
        border.to = from;
        border.is_turned = !border.is_turned;
    }
    borders->items[borders->count++] = border;
}

static inline void add_borders(struct borders *borders, const struct gd_cut_piece *piece)
{
    uint32_t count = 3 * piece->face_count;
    const uint32_t *corner = piece->polygons.corners;
    struct directed *sides = malloc(count * sizeof *sides);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t a = corner[i], b = corner[i % 3 == 2 ? i - 2 : i + 1];
        sides[i] = (struct directed){a < b ? a : b, a < b ? b : a, a > b};
    }
    qsort(sides, count, sizeof *sides, by_vertices);
    for (uint32_t i = 0; i < count; i++) {
        bool is_inner = i + 1 < count && by_vertices(&sides[i], &sides[i + 1]) == 0;
        if (is_inner)
            i++;
        else
            add_border(borders, piece, &sides[i]);
    }
    free(sides);
}

static inline struct borders borders_of(const struct gd_cut *cut)
{
    struct borders borders = {0};
    size_t most = 0;
    for (uint32_t i = 0; i < cut->piece_count; i++) most += 3 * (size_t)cut->pieces[i].face_count;
    borders.items = malloc(most * sizeof *borders.items);
    for (uint32_t i = 0; i < cut->piece_count; i++) add_borders(&borders, &cut->pieces[i]);
    qsort(borders.items, borders.count, sizeof *borders.items, by_ends);
    return borders;
}

static inline double length_of(const struct border *border)
{
    const double *p = border->from.position, *q = border->to.position;
    return gd_vec3_distance((struct gd_vec3){p[0], p[1], p[2]}, (struct gd_vec3){q[0], q[1], q[2]});
}

static inline uint32_t distinct(struct place *places, uint32_t count)
{
    uint32_t kept = 0;
    qsort(places, count, sizeof *places, by_place);
    for (uint32_t i = 0; i < count; i++)
        if (kept == 0 || by_place(&places[kept - 1], &places[i])) places[kept++] = places[i];
    return kept;
}

/* --- what holds for every cut ----------------------------------------------------------------- */

struct seam {
    /* number of pairs of borders; number of ends of these borders, without ends on the mesh's
       boundary */
    uint32_t edges, vertices;
    double rest; /* total length of borders without a twin */
};

/* Counts pairs of twins: borders that run between the same places in opposite directions. Each
 * border has at most one twin. */
static inline struct seam seam_of(const struct gd_cut *cut)
{
    struct borders borders = borders_of(cut);
    struct place *ends = malloc(2 * (size_t)borders.count * sizeof *ends + 1),
                 *rims = malloc(2 * (size_t)borders.count * sizeof *rims + 1);
    uint32_t end_count = 0, rim_count = 0;
    struct seam seam = {0};
    for (uint32_t i = 0; i < borders.count; i++) {
        struct border *b = &borders.items[i];
        bool is_pair = i + 1 < borders.count && !by_place(&b[0].from, &b[1].from) &&
                       !by_place(&b[0].to, &b[1].to);
        if (is_pair) {
            assert_true(b[0].is_turned != b[1].is_turned);
            seam.edges++;
            ends[end_count++] = b->from;
            ends[end_count++] = b->to;
            i++;
        } else {
            seam.rest += length_of(b);
            rims[rim_count++] = b->from;
            rims[rim_count++] = b->to;
        }
    }
    end_count = distinct(ends, end_count);
    rim_count = distinct(rims, rim_count);
    for (uint32_t i = 0; i < end_count; i++)
        seam.vertices += !rim_count || !bsearch(&ends[i], rims, rim_count, sizeof *rims, by_place);
    free(ends);
    free(rims);
    free(borders.items);
    return seam;
}

static inline void check_maps(const struct gd_mesh *mesh, const struct gd_cut_piece *piece)
{
    uint32_t count = piece->polygons.position_count, last = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t parent = piece->vertex_map[i];
        /* vertices of the parent come first, in order; new vertices have GD_NONE, which is the
         * largest number */
        if (i) assert_true(parent >= last);
        last = parent;
        if (parent == GD_NONE) continue;
        struct gd_vec3 there = gd_mesh_position(mesh, (struct gd_vertex){parent});
        const double position[3] = {there.x, there.y, there.z};
        assert_memory_equal(position, piece->polygons.positions[i], sizeof position);
    }
    for (uint32_t i = 0; i < piece->face_count; i++) {
        assert_true(gd_mesh_has_face(mesh, (struct gd_face){piece->face_map[i]}));
        if (i) assert_true(piece->face_map[i] >= piece->face_map[i - 1]);
    }
}

/* Checks that
 * - the areas of the pieces sum to the mesh's area, and so do the areas of the meshes built from
 *   them (with a relative error of at most `relative`);
 * - each piece is one component without flipped faces;
 * - the maps lead to vertices of the parent at the same positions, and to its faces;
 * - each border of a piece lies on the mesh's boundary or has a twin that runs the opposite way;
 * - the pieces' Euler characteristics sum to the value for a cut along the graph of the twins. */
static inline void check_cutting(const struct gd_mesh *mesh, const struct cutting *cutting,
                                 double relative)
{
    const struct gd_mesh_summary *whole = gd_mesh_summary(mesh);
    double area = 0, built = 0, boundary = 0;
    int64_t characteristic = 0;
    for (uint32_t i = 0; i < cutting->cut.piece_count; i++) {
        const struct gd_mesh_summary *part = gd_mesh_summary(cutting->pieces[i]);
        assert_int_equal(part->components, 1);
        assert_int_equal(part->flipped_faces + part->unreferenced_vertices, 0);
        assert_int_equal(part->faces, cutting->cut.pieces[i].face_count);
        area += cutting->cut.pieces[i].area;
        built += part->area;
        characteristic += part->euler_characteristic;
        check_maps(mesh, &cutting->cut.pieces[i]);
    }
    for (uint32_t i = 0; i < whole->boundaries; i++) boundary += gd_mesh_boundary(mesh, i).length;
    check_close(area, whole->area, 1e-12);
    check_close(built, whole->area, relative);
    struct seam seam = seam_of(&cutting->cut);
    check_close(seam.rest, boundary, relative);
    assert_int_equal(characteristic,
                     whole->euler_characteristic + (int64_t)seam.edges - (int64_t)seam.vertices);
    assert_int_equal(cutting->cut.separates, cutting->cut.piece_count > whole->components);
}
