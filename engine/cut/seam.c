#include "cut/seam.h"

#include <stdlib.h>

/* --- pieces ----------------------------------------------------------------------------------- */

static int by_parameter(const void *a, const void *b, void *user)
{
    const struct gd__nodes *nodes = user;
    int64_t p = gd__node(nodes, *(const uint32_t *)a)->site.u,
            q = gd__node(nodes, *(const uint32_t *)b)->site.u;
    return (p > q) - (p < q);
}

static void number_pieces(struct gd__seam *seam)
{
    const struct gd__nodes *nodes = seam->nodes;
    uint32_t used = 0;
    for (uint32_t e = 0; e < nodes->mesh->edge_count; e++) {
        uint32_t begin = used;
        seam->first[e] = e + begin;
        for (uint32_t n = nodes->of_edge[e]; n != GD_NONE; n = gd__node(nodes, n)->next)
            seam->edge_node[used++] = n;
        if (used - begin > 1)
            qsort_r(seam->edge_node + begin, used - begin, sizeof *seam->edge_node, by_parameter,
                    (void *)nodes);
        for (uint32_t i = begin; i < used; i++)
            seam->place[seam->edge_node[i] - nodes->mesh->vertex_count] = 1 + i - begin;
    }
    seam->first[nodes->mesh->edge_count] = nodes->mesh->edge_count + used;
}

/* Returns the position of a node among the nodes of an edge: 0 for the origin of side 0, then 1, 2,
 * … along the edge. */
static uint32_t place_on_edge(const struct gd__seam *seam, uint32_t edge, uint32_t node)
{
    const struct gd_mesh *mesh = seam->nodes->mesh;
    if (node >= mesh->vertex_count) return seam->place[node - mesh->vertex_count];
    return node == mesh->origin[2 * edge] ? 0 : seam->first[edge + 1] - seam->first[edge];
}

uint32_t gd__seam_piece(const struct gd__seam *seam, uint32_t edge, uint32_t a, uint32_t b)
{
    uint32_t p = place_on_edge(seam, edge, a), q = place_on_edge(seam, edge, b);
    return seam->first[edge] + (p < q ? p : q);
}

/* --- parts that cut --------------------------------------------------------------------------- */

static bool is_on_boundary(const struct gd_mesh *mesh, uint32_t edge)
{
    return gd__side_is_boundary(mesh, 2 * edge) || gd__side_is_boundary(mesh, 2 * edge + 1);
}

static void seam_mark(struct gd__seam *seam, const struct gd__arrangement *arrangement)
{
    const struct gd_mesh *mesh = seam->nodes->mesh;
    for (uint32_t i = 0; i < arrangement->run_count; i++) {
        const struct gd__run *run = &arrangement->runs[i];
        if (is_on_boundary(mesh, run->edge)) continue;
        uint32_t p = place_on_edge(seam, run->edge, run->a),
                 q = place_on_edge(seam, run->edge, run->b);
        for (uint32_t k = p < q ? p : q; k < (p < q ? q : p); k++)
            seam->is_cut[seam->first[run->edge] + k] = 1;
    }
    for (uint32_t face = 0; face < mesh->face_count; face++)
        for (uint32_t s = arrangement->of_face[face]; s != GD_NONE;
             s = arrangement->segments[s].next)
            seam->is_cutting[s] = 1;
}

/* --- dead ends -------------------------------------------------------------------------------- */

/* The parts of the seam that meet at a node. `degree` is the number of these parts, and `parts` is
 * the exclusive or of their numbers. So if only one part is left, `parts` is its number. Pieces of
 * edges are numbered first, then segments. */
struct meeting {
    uint32_t degree, parts;
};

/* added to the degree of boundary nodes, which are never dead ends */
#define BOUNDARY_DEGREE (UINT32_C(1) << 30)

struct pruning {
    struct gd__seam *seam;
    const struct gd__arrangement *arrangement;
    struct meeting *meetings; /* per node */
    uint32_t *edge_of_part;   /* per piece */
    uint32_t pieces;
};

/* Returns the address of the flag that is true if a part belongs to the seam. */
static uint8_t *flag_of(const struct pruning *pruning, uint32_t part)
{
    return part < pruning->pieces ? &pruning->seam->is_cut[part]
                                  : &pruning->seam->is_cutting[part - pruning->pieces];
}

static void ends_of(const struct pruning *pruning, uint32_t part, uint32_t ends[2])
{
    const struct gd__seam *seam = pruning->seam;
    if (part >= pruning->pieces) {
        const struct gd__segment *segment = &pruning->arrangement->segments[part - pruning->pieces];
        ends[0] = segment->a;
        ends[1] = segment->b;
        return;
    }
    uint32_t edge = pruning->edge_of_part[part], place = part - seam->first[edge];
    const uint32_t *node = seam->edge_node + (seam->first[edge] - edge);
    ends[0] = place == 0 ? seam->nodes->mesh->origin[2 * edge] : node[place - 1];
    ends[1] =
        part + 1 == seam->first[edge + 1] ? seam->nodes->mesh->origin[2 * edge + 1] : node[place];
}

static void seam_mark_boundary(struct pruning *pruning)
{
    const struct gd__nodes *nodes = pruning->seam->nodes;
    const struct gd_mesh *mesh = nodes->mesh;
    for (uint32_t e = 0; e < mesh->edge_count; e++) {
        for (uint32_t p = pruning->seam->first[e]; p < pruning->seam->first[e + 1]; p++)
            pruning->edge_of_part[p] = e;
        if (!is_on_boundary(mesh, e)) continue;
        for (uint32_t n = nodes->of_edge[e]; n != GD_NONE; n = gd__node(nodes, n)->next)
            pruning->meetings[n].degree = BOUNDARY_DEGREE;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        if (mesh->vertex_kind[v] == GD_VERTEX_BOUNDARY)
            pruning->meetings[v].degree = BOUNDARY_DEGREE;
}

static void change(struct pruning *pruning, uint32_t part, uint32_t by, uint32_t ends[2])
{
    ends_of(pruning, part, ends);
    for (int i = 0; i < 2; i++) {
        pruning->meetings[ends[i]].degree += by;
        pruning->meetings[ends[i]].parts ^= part;
    }
}

/* Removes the dead end at a node, and then all dead ends that arise from this removal. */
static void take_off(struct pruning *pruning, uint32_t node)
{
    while (pruning->meetings[node].degree == 1) {
        uint32_t part = pruning->meetings[node].parts, ends[2];
        *flag_of(pruning, part) = 0;
        change(pruning, part, UINT32_MAX, ends);
        node = ends[0] == node ? ends[1] : ends[0];
    }
}

static void seam_prune(struct pruning *pruning)
{
    struct gd__seam *seam = pruning->seam;
    uint32_t parts = pruning->pieces + pruning->arrangement->segment_count, ends[2];
    uint32_t nodes = seam->nodes->mesh->vertex_count + seam->nodes->count;
    seam_mark_boundary(pruning);
    for (uint32_t part = 0; part < parts; part++)
        if (*flag_of(pruning, part)) change(pruning, part, 1, ends);
    for (uint32_t node = 0; node < nodes; node++) take_off(pruning, node);
    for (uint32_t part = 0; part < parts; part++) seam->cuts += *flag_of(pruning, part);
}

/* --- result ----------------------------------------------------------------------------------- */

enum gd_status gd__seam_make(const struct gd__arrangement *arrangement, struct gd__arena *arena,
                             struct gd__seam *out)
{
    const struct gd__nodes *nodes = &arrangement->nodes;
    struct pruning pruning = {.seam = out, .arrangement = arrangement};
    size_t edges = nodes->mesh->edge_count, pieces = edges + nodes->count;
    *out = (struct gd__seam){.nodes = nodes};
    out->first = gd__arena_take(arena, edges + 1, sizeof *out->first);
    out->edge_node = gd__arena_take(arena, nodes->count, sizeof *out->edge_node);
    out->place = gd__arena_take(arena, nodes->count, sizeof *out->place);
    out->is_cut = gd__arena_zeroed(arena, pieces, 1);
    out->is_cutting = gd__arena_zeroed(arena, arrangement->segment_count, 1);
    pruning.meetings = gd__arena_zeroed(arena, (size_t)nodes->mesh->vertex_count + nodes->count,
                                        sizeof *pruning.meetings);
    pruning.edge_of_part = gd__arena_take(arena, pieces, sizeof *pruning.edge_of_part);
    if (arena->status) return arena->status;
    number_pieces(out);
    pruning.pieces = out->first[edges];
    seam_mark(out, arrangement);
    seam_prune(&pruning);
    return GD_OK;
}
