/* Splits edges and vertices that have too many faces for a surface.
 *
 * DESIGN. The first step decides which faces are joined at each edge (`neighbour`). The two faces
 * of an ordinary edge are joined. If an edge has more than two faces, they are joined in pairs
 * (see below). The corners of a vertex that belong to joined faces form a fan. The fan with
 * the lowest-numbered face keeps the vertex; each further fan gets a copy of the vertex. So edges
 * and vertices are split in one step.
 *
 * This is not always enough. Two pairs of faces at an edge may belong to the same fan at both ends
 * of the edge. Then the edge keeps its two vertices, and all four faces still share it. In this
 * case each pair except the first gets its own copy of the edge's lower end. The copy also replaces
 * this end in the other edges of the pair's faces. */
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/large.h"
#include "mesh/edge_table.h"
#include "mesh/orientation.h"
#include "mesh/union_find.h"
#include "repair/repair.h"

/* --- pairs of faces --------------------------------------------------------------------------- */

/* Decides which faces stay joined at an edge of more than two faces.
 *
 * DESIGN. Where solids touch along an edge, or a wall stands on a plate, a path on the surface of a
 * body should stay on that body. Look along the edge from its lower to its higher vertex, and go
 * round it counter-clockwise. A face that runs forward along the edge has the outside of its body
 * ahead and the inside behind; a backward face has the inside ahead. So the inside of a body
 * extends from a backward face to the next forward face. These two faces bound the same body, and
 * they stay joined. The pairs are found as matching brackets: each forward face takes the nearest
 * free backward face before it.
 *
 * Only faces that run in opposite directions are joined, so no pair makes a surface one-sided.
 * The remaining faces all run in the same direction. Each of them gets a border. */

struct edge_face {
    uint32_t side; /* the face's side at the edge */
    /* true if the face, once oriented consistently, runs along the edge from the lower to the
     * higher vertex */
    bool forward;
    struct gd_vec3 across; /* vector from the edge into the face, of any length except zero */
    /* output: angle about the edge, counter-clockwise as seen against the edge's direction */
    double angle;
    /* output: the side of the face to which this face stays joined, or GD_NONE if the face gets a
       border */
    uint32_t partner;
    uint32_t below; /* scratch */
};

/* Computes the angles of the faces, measured from the first face, in [0, 2 pi). */
static void face_pairing_measure(struct edge_face *edge_face, uint32_t count, struct gd_vec3 along)
{
    struct gd_vec3 axis = gd_vec3_unit(along), first = gd_vec3_unit(edge_face[0].across);
    for (uint32_t i = 0; i < count; i++) {
        struct gd_vec3 across = gd_vec3_unit(edge_face[i].across);
        double sine = gd_vec3_dot(gd_vec3_cross(first, across), axis);
        double cosine =
            gd_vec3_dot(first, across) - gd_vec3_dot(first, axis) * gd_vec3_dot(across, axis);
        double angle = i == 0 ? 0 : atan2(sine, cosine);
        edge_face[i].angle = angle < 0 ? angle + 2 * M_PI : angle;
    }
}

/* Compares faces by angle. Among faces at the same angle, backward faces come first. So a backward
 * and a forward face at the same angle become a pair with no space between them. */
static int face_pairing_compare(const void *x, const void *y)
{
    const struct edge_face *a = x, *b = y;
    if (a->angle != b->angle) return a->angle < b->angle ? -1 : 1;
    if (a->forward != b->forward) return a->forward ? 1 : -1;
    return a->side < b->side ? -1 : a->side > b->side;
}

/* Visits the faces twice, so that faces that still wait at the end are matched with faces at the
 * beginning. */
static void match(struct edge_face *edge_face, uint32_t count)
{
    /* top of the stack of waiting backward faces, which is linked through `below` */
    uint32_t top = GD_NONE;
    for (uint64_t i = 0; i < 2 * (uint64_t)count; i++) {
        struct edge_face *s = &edge_face[i % count];
        if (s->partner != GD_NONE) continue;
        if (!s->forward && i < count) {
            s->below = top;
            top = (uint32_t)i;
        } else if (s->forward && top != GD_NONE) {
            s->partner = edge_face[top].side;
            edge_face[top].partner = s->side;
            top = edge_face[top].below;
        }
    }
}

/* Sorts the faces around an edge and pairs them. `along` is the direction of the edge. O(n log
 * n). */
static void edge_faces_pair(struct edge_face *edge_face, uint32_t count, struct gd_vec3 along)
{
    face_pairing_measure(edge_face, count, along);
    for (uint32_t i = 0; i < count; i++) edge_face[i].partner = GD_NONE;
    qsort(edge_face, count, sizeof *edge_face, face_pairing_compare);
    match(edge_face, count);
}

struct splitting {
    struct gd__construction *work;
    uint32_t face_count, input_vertices;
    /* for each side, the side that it is joined to, or GD_NONE if there is none */
    uint32_t *neighbour;
    /* for each face, true if its orientation is opposite to that of most faces around it */
    uint8_t *flipped;
    /* the faces of one edge; the array has room for the edge with the most faces */
    struct edge_face *edge_face;
    /* for each corner (numbered like the sides), a lower corner of the same fan; a union-find
       forest (union_find.h) */
    uint32_t *fan;
    uint32_t *copy_of; /* for each copy, the input vertex that it copies */
    uint32_t copy_count, capacity;
};

static uint32_t original(const struct splitting *s, uint32_t vertex)
{
    return vertex < s->input_vertices ? vertex : s->copy_of[vertex - s->input_vertices];
}

static struct gd_vec3 split_position(const struct splitting *s, uint32_t vertex)
{
    return gd__input_position(s->work, original(s, vertex));
}

static enum gd_status append_copy(struct splitting *s, uint32_t vertex, uint32_t *copy)
{
    enum gd_status status =
        gd__array_extend(&s->copy_of, &s->capacity, s->copy_count + 1ULL, sizeof *s->copy_of, NULL);
    if (status) return status;
    if (s->copy_count >= GD_NONE - s->input_vertices)
        return gd_fail(s->work->detail, GD_TOO_LARGE,
                       "with the copies that repair makes there are too many vertices");
    *copy = s->input_vertices + s->copy_count;
    s->copy_of[s->copy_count++] = original(s, vertex);
    return GD_OK;
}

static enum gd_status make_table(const struct splitting *s, struct gd__edge_table *table)
{
    return gd__edge_table_create((const uint32_t(*)[3])s->work->triangle, s->face_count,
                                 s->input_vertices + s->copy_count, &s->work->pace, table);
}

/* Joins the faces of edges with two faces. Returns the largest number of faces that an edge has. */
static uint32_t join_pairs(struct splitting *s, const struct gd__edge_table *table)
{
    uint32_t most = 0;
    gd__pace_fill(&s->work->pace, s->neighbour, 3 * (size_t)s->face_count * sizeof *s->neighbour);
    for (struct gd__edge_run run = {0};
         gd__pace(&s->work->pace, 1) && gd__edge_table_next(table, &run);) {
        const struct gd__edge_use *use = table->use + run.begin;
        if (run.count > most) most = run.count;
        if (run.count != 2) continue;
        s->neighbour[use[0].side] = use[1].side;
        s->neighbour[use[1].side] = use[0].side;
    }
    return most;
}

/* --- faces that stay joined at an edge of more than two faces --------------------------------- */

/* Orients the faces before they are paired, because in files with non-manifold edges the faces
 * often have random orientations. Afterwards, the orientation is consistent in each set of faces
 * that are connected by edges of two faces. */
static enum gd_status orient(struct splitting *s)
{
    uint32_t *component = gd__large_array(s->face_count, sizeof *component);
    s->flipped = gd__large_zeroed(s->face_count, sizeof *s->flipped);
    struct gd__orientation orientation = {
        .corner = (const uint32_t(*)[3])s->work->triangle,
        .neighbour = s->neighbour,
        .face_count = s->face_count,
        .seed_count = s->face_count,
        .pace = &s->work->pace,
        .flipped = s->flipped,
        .component = component,
    };
    enum gd_status status = component && s->flipped ? gd__orient_faces(&orientation) : GD_NO_MEMORY;
    free(component);
    return status;
}

/* Fills s->edge_face with the faces of an edge, sorted around it and paired. */
static void pair_edge_faces(struct splitting *s, const struct gd__edge_table *table,
                            const struct gd__edge_run *run)
{
    struct gd_vec3 low = split_position(s, run->low);
    for (uint32_t i = 0; i < run->count; i++) {
        uint32_t side = table->use[run->begin + i].side;
        const uint32_t *corner = s->work->triangle[side / 3];
        bool forward = original(s, corner[side % 3]) == original(s, run->low);
        s->edge_face[i] = (struct edge_face){
            .side = side,
            .forward = forward != (bool)s->flipped[side / 3],
            .across = gd_vec3_sub(split_position(s, corner[gd__previous_corner(side % 3)]), low),
        };
    }
    edge_faces_pair(s->edge_face, run->count, gd_vec3_sub(split_position(s, run->high), low));
}

static enum gd_status pair_crowded(struct splitting *s, const struct gd__edge_table *table,
                                   uint32_t most)
{
    s->edge_face = malloc(most * sizeof *s->edge_face);
    enum gd_status status = s->edge_face ? orient(s) : GD_NO_MEMORY;
    for (struct gd__edge_run run = {0};
         !status && gd__pace(&s->work->pace, 1) && gd__edge_table_next(table, &run);) {
        if (run.count <= 2) continue;
        gd_mended_add(&s->work->mesh->repair->edges_split, run.low, run.high);
        pair_edge_faces(s, table, &run);
        for (uint32_t i = 0; i < run.count; i++)
            s->neighbour[s->edge_face[i].side] = s->edge_face[i].partner;
    }
    return status;
}

/* --- a vertex for each fan -------------------------------------------------------------------- */

static void join_fans(struct splitting *s)
{
    GD__PACED (&s->work->pace, c, 3 * s->face_count) s->fan[c] = c;
    GD__PACED (&s->work->pace, a, 3 * s->face_count) {
        uint32_t b = s->neighbour[a];
        if (b == GD_NONE || b < a) continue;
        uint32_t a_end = a - a % 3 + gd__next_corner(a % 3),
                 b_end = b - b % 3 + gd__next_corner(b % 3);
        bool alike = s->work->triangle[a / 3][a % 3] == s->work->triangle[b / 3][b % 3];
        gd__union_find_join(s->fan, a, alike ? b : b_end);
        gd__union_find_join(s->fan, a_end, alike ? b_end : b);
    }
}

/* Assigns vertices to fans. Visits the corners in the order of the faces. The first corner of a fan
 * gets the vertex or a copy of it, and the other corners of the fan get the same. */
static enum gd_status separate_fans(struct splitting *s)
{
    size_t vertices = (size_t)s->input_vertices + s->copy_count;
    uint8_t *taken = gd__large_zeroed(vertices, sizeof *taken);
    enum gd_status status = taken ? GD_OK : GD_NO_MEMORY;
    if (!status) join_fans(s);
    for (uint32_t c = 0; !status && c < 3 * s->face_count && gd__pace(&s->work->pace, 1); c++) {
        uint32_t *vertex = &s->work->triangle[c / 3][c % 3], first = gd__union_find_root(s->fan, c);
        if (first < c)
            *vertex = s->work->triangle[first / 3][first % 3];
        else if (taken[*vertex])
            status = append_copy(s, *vertex, vertex);
        else
            taken[*vertex] = 1;
    }
    free(taken);
    return status ? status : s->work->pace.status;
}

/* --- pairs whose fans are connected ----------------------------------------------------------- */

static uint32_t *find_corner(const struct splitting *s, uint32_t side, uint32_t vertex)
{
    uint32_t *corner = s->work->triangle[side / 3];
    return corner[0] == vertex   ? corner
           : corner[1] == vertex ? corner + 1
           : corner[2] == vertex ? corner + 2
                                 : NULL;
}

/* Gives each pair of faces at the edge its own copy of the edge's lower end, except the pair that
 * contains s->edge_face[0]. A face that already got a copy because of another edge no longer
 * belongs to this edge. */
static enum gd_status detach_edge_faces(struct splitting *s, uint32_t low, uint32_t count)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 1; i < count && !status; i++) {
        const struct edge_face *edge_face = &s->edge_face[i];
        if (edge_face->partner == s->edge_face[0].side || edge_face->partner < edge_face->side)
            continue;
        uint32_t *corner = find_corner(s, edge_face->side, low);
        uint32_t *other =
            edge_face->partner != GD_NONE ? find_corner(s, edge_face->partner, low) : NULL;
        uint32_t copy = low;
        if (corner || other) status = append_copy(s, low, &copy);
        if (corner) *corner = copy;
        if (other) *other = copy;
    }
    return status;
}

/* Detaches faces at the edges that still have more than two faces. Sets `*any` to true if there are
 * such edges. */
static enum gd_status detach_crowded(struct splitting *s, bool *any)
{
    struct gd__edge_table table;
    enum gd_status status = make_table(s, &table);
    if (status) return status;
    for (struct gd__edge_run run = {0};
         !status && gd__pace(&s->work->pace, 1) && gd__edge_table_next(&table, &run);) {
        if (run.count <= 2) continue;
        *any = true;
        pair_edge_faces(s, &table, &run);
        status = detach_edge_faces(s, run.low, run.count);
    }
    gd__edge_table_free(&table);
    return status;
}

/* Joins faces, pairs them at edges of more than two faces (only in the first call), and separates
 * the fans. */
static enum gd_status separate(struct splitting *s, bool *crowded)
{
    struct gd__edge_table table;
    enum gd_status status = make_table(s, &table);
    if (status) return status;
    uint32_t most = join_pairs(s, &table);
    *crowded = most > 2;
    if (*crowded && !s->edge_face) status = pair_crowded(s, &table, most);
    gd__edge_table_free(&table);
    return status ? status : separate_fans(s);
}

static enum gd_status split_run(struct splitting *s)
{
    bool crowded = false, detached = false;
    enum gd_status status = separate(s, &crowded);
    if (!status && crowded) status = detach_crowded(s, &detached);
    if (!status && detached) status = separate(s, &crowded);
    return status;
}

/* Moves the copies to the mesh and records the vertices that have copies. */
static enum gd_status keep_copies(struct splitting *s)
{
    struct gd_mesh *mesh = s->work->mesh;
    if (s->copy_count == 0) return GD_OK;
    mesh->copy_of = gd__mesh_array(s->work, s->copy_count, sizeof *mesh->copy_of);
    uint32_t *copies = gd__large_zeroed(s->input_vertices, sizeof *copies);
    if (mesh->copy_of && copies) {
        memcpy(mesh->copy_of, s->copy_of, s->copy_count * sizeof *s->copy_of);
        GD__PACED (&s->work->pace, c, s->copy_count) copies[s->copy_of[c]]++;
        GD__PACED (&s->work->pace, v, s->input_vertices) {
            if (copies[v]) gd_mended_add(&mesh->repair->vertices_split, v, copies[v]);
        }
    }
    s->work->copy_count = mesh->repair->copies = s->copy_count;
    enum gd_status status = mesh->copy_of && copies ? GD_OK : GD_NO_MEMORY;
    free(copies);
    return status;
}

enum gd_status gd__split_faces(struct gd__construction *work)
{
    struct splitting s = {
        .work = work,
        .face_count = work->mesh->face_count,
        .input_vertices = work->input->position_count,
    };
    s.neighbour = gd__large_array(3 * (size_t)s.face_count, sizeof *s.neighbour);
    s.fan = gd__large_array(3 * (size_t)s.face_count, sizeof *s.fan);
    enum gd_status status = s.neighbour && s.fan ? split_run(&s) : GD_NO_MEMORY;
    if (!status) status = keep_copies(&s);
    free(s.neighbour);
    free(s.fan);
    free(s.flipped);
    free(s.edge_face);
    free(s.copy_of);
    return status;
}
