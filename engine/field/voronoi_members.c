#include <stdlib.h>

#include "field/voronoi_parts.h"

/* Whose the pseudo-sources are: each vertex's way back to its seed is followed once, as far as one whose member is known. */

/* --- members that coincide ------------------------------------------------------------------------------------------------ */

struct place {
    const struct gd__seed *seed;
    uint32_t member;
};

static int compare(double a, double b)
{
    return (a > b) - (a < b);
}

static int by_point(const struct gd_point *a, const struct gd_point *b)
{
    if (a->kind != b->kind) return a->kind < b->kind ? -1 : 1;
    if (a->element != b->element) return a->element < b->element ? -1 : 1;
    int order = 0;
    for (int i = 0; i < 3 && !order && a->kind != GD_POINT_VERTEX; i++) order = compare(a->weight[i], b->weight[i]);
    return order;
}

static int by_place(const void *a, const void *b)
{
    const struct place *x = a, *y = b;
    int order = by_point(&x->seed->point, &y->seed->point);
    if (!order) order = compare(x->seed->offset, y->seed->offset);
    return order ? order : (x->member > y->member) - (x->member < y->member);
}

/* Of members at one place the one of least offset stands for all. */
static enum gd_status stand_in(const struct gd_field *field, uint32_t *of)
{
    uint32_t count = field->seed_count;
    struct place *places = malloc(sizeof *places * count);
    if (!places) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < count; i++) places[i] = (struct place){&field->seeds[i], i};
    qsort(places, count, sizeof *places, by_place);
    for (uint32_t i = 0; i < count; i++) {
        bool same = i > 0 && by_point(&places[i - 1].seed->point, &places[i].seed->point) == 0;
        of[places[i].member] = same ? of[places[i - 1].member] : places[i].member;
    }
    free(places);
    return GD_OK;
}

/* --- vertices -------------------------------------------------------------------------------------------------------------- */

/* From a vertex to a pseudo-source whose member is known, and once more to tell all on the way. No path bends at a vertex twice. */
static enum gd_status follow(const struct gd_field *field, uint32_t vertex, uint32_t *of)
{
    uint32_t source = vertex, steps_left = field->mesh->vertex_count;
    while (of[source] == GD_NONE) {
        if (!steps_left--) return GD_INTERNAL;
        source = gd__field_source_behind(field, source);
        if (source == GD_NONE) return GD_INTERNAL;
    }
    uint32_t member = of[source];
    for (source = vertex; of[source] == GD_NONE;) {
        of[source] = member;
        source = gd__field_source_behind(field, source);
    }
    return GD_OK;
}

/* Of all vertices whose member is not known. */
static enum gd_status find_owners(const struct gd_field *field, uint32_t *of)
{
    uint32_t vertices = field->mesh->vertex_count;
    enum gd_status status = GD_OK;
    for (uint32_t v = 0; v < vertices && !status; v++)
        if (field->distance[v] < GD__FAR && of[v] == GD_NONE) status = follow(field, v, of);
    return status;
}

/* --- nudges ---------------------------------------------------------------------------------------------------------------- */

/* Differs from member to member without rule, in [0, 1). */
static double scatter(uint32_t member)
{
    uint64_t hash = (member + UINT64_C(1)) * UINT64_C(0x9e3779b97f4a7c15);
    hash = (hash ^ (hash >> 32)) * UINT64_C(0xd6e8feb86659fd93);
    return (double)(hash >> 11) * 0x1p-53;
}

/* No point of an edge is farther than `farthest`. */
static void find_nudges(const struct gd_field *field, struct gd__members *members)
{
    const struct gd_mesh *mesh = field->mesh;
    for (uint32_t side = 0; side < 2 * mesh->edge_count; side++) {
        double distance = field->distance[mesh->origin[side]];
        if (distance < GD__FAR) members->farthest = fmax(members->farthest, distance + mesh->side[side].length);
    }
    for (uint32_t i = 0; i < field->seed_count; i++) members->nudge[i] = GD_TOL_TIE * members->farthest * scatter(i);
}

enum gd_status gd__members_find(const struct gd_field *field, struct gd__members *out)
{
    size_t sources = (size_t)field->mesh->vertex_count + field->seed_count;
    struct gd__members members = {.of = malloc(sizeof *members.of * sources),
                                  .nudge = malloc(sizeof *members.nudge * field->seed_count)};
    enum gd_status status =
        members.of && members.nudge ? stand_in(field, members.of + field->mesh->vertex_count) : GD_NO_MEMORY;
    for (uint32_t v = 0; v < field->mesh->vertex_count && !status; v++) members.of[v] = GD_NONE;
    if (!status) status = find_owners(field, members.of);
    if (status) {
        gd__members_destroy(&members);
        return status;
    }
    find_nudges(field, &members);
    *out = members;
    return GD_OK;
}

enum gd_status gd__members_change(const struct gd_field *field, const uint32_t *owner, struct gd__members *members)
{
    for (uint32_t v = 0; v < field->mesh->vertex_count; v++)
        members->of[v] = owner[v] == members->of[v] ? GD_NONE : owner[v];
    return find_owners(field, members->of);
}

void gd__members_destroy(struct gd__members *members)
{
    free(members->of);
    free(members->nudge);
    *members = (struct gd__members){0};
}

/* --- labels ---------------------------------------------------------------------------------------------------------------- */

enum gd_status gd_voronoi_labels(const struct gd_field *field, uint32_t *out)
{
    const struct gd_mesh *mesh = field->mesh;
    struct gd__members members;
    enum gd_status status = gd__members_find(field, &members);
    if (status) return status;
    for (uint32_t i = 0; i < mesh->summary.index_count; i++) {
        uint32_t vertex = mesh->vertex_of_index[i];
        bool is_known = vertex != GD_NONE && field->distance[vertex] <= field->reach;
        out[i] = is_known ? members.of[vertex] : UINT32_MAX;
    }
    gd__members_destroy(&members);
    return GD_OK;
}
