#include <stdlib.h>

#include "field/voronoi_parts.h"
#include "mesh/segment.h"

/* The member of each pseudo-source. The caller defines the members of seeds. The path of each
 * vertex is followed back until it meets a pseudo-source with a known member. */

/* --- coinciding seeds ------------------------------------------------------------------------- */

/* A place of a seed: its point, an end of its segment, or the segment as a whole. */
struct place {
    /* `end` is the second end of a segment; NULL for a point */
    const struct gd_point *at, *end;
    double offset;
    uint32_t member;
    uint32_t number; /* number of the seed; GD_NONE means an end of a segment */
};

static int compare_doubles(double a, double b)
{
    return (a > b) - (a < b);
}

static int by_point(const struct gd_point *a, const struct gd_point *b)
{
    if (a->kind != b->kind) return a->kind < b->kind ? -1 : 1;
    if (a->element != b->element) return a->element < b->element ? -1 : 1;
    int order = 0;
    for (int i = 0; i < 3 && !order && a->kind != GD_POINT_VERTEX; i++)
        order = compare_doubles(a->weight[i], b->weight[i]);
    return order;
}

static int by_extent(const struct place *a, const struct place *b)
{
    int order = by_point(a->at, b->at);
    if (order || (!a->end && !b->end)) return order;
    if (!a->end || !b->end) return a->end ? 1 : -1;
    return by_point(a->end, b->end);
}

static int by_claim(const void *a, const void *b)
{
    const struct place *x = a, *y = b;
    int order = by_extent(x, y);
    if (!order) order = compare_doubles(x->offset, y->offset);
    return order ? order : (x->member > y->member) - (x->member < y->member);
}

/* Returns the owner of a place that several seeds share. `places` are sorted. Among the members
 * with the least offset, the owner is the member with the most segments that end at the place; in a
 * tie, the first of them. Therefore a point on another member's curve owns no region. */
static uint32_t member_with_best_claim(const struct place *places, uint32_t count)
{
    uint32_t best = places[0].member, most = 0, ends = 0;
    for (uint32_t i = 0; i < count && places[i].offset == places[0].offset; i++) {
        if (i && places[i].member != places[i - 1].member) ends = 0;
        ends += places[i].number == GD_NONE;
        if (ends <= most) continue;
        most = ends;
        best = places[i].member;
    }
    return best;
}

static void assign_places(struct place *places, uint32_t count, uint32_t *of)
{
    qsort(places, count, sizeof *places, by_claim);
    for (uint32_t first = 0, behind; first < count; first = behind) {
        for (behind = first + 1; behind < count && by_extent(&places[first], &places[behind]) == 0;)
            behind++;
        uint32_t member = member_with_best_claim(places + first, behind - first);
        for (uint32_t i = first; i < behind; i++)
            if (places[i].number != GD_NONE) of[places[i].number] = member;
    }
}

/* Lists a seed's places and returns their number. */
static uint32_t places_of(const struct gd__seed *seed, uint32_t number, uint32_t member,
                          struct place places[3])
{
    places[0] = (struct place){&seed->point, NULL, seed->offset, member, number};
    if (!seed->is_segment) return 1;
    bool ascends = by_point(&seed->point, &seed->end) < 0;
    places[1] = places[0];
    places[1].number = GD_NONE;
    places[2] = places[1];
    places[2].at = &seed->end;
    places[0].at = ascends ? &seed->point : &seed->end;
    places[0].end = ascends ? &seed->end : &seed->point;
    return 3;
}

static enum gd_status assign_seeds(const struct gd_field *field, const uint32_t *member_of_seed,
                                   uint32_t *of)
{
    uint32_t count = field->seed_count, found = 0;
    for (uint32_t i = 0; i < count; i++)
        if (member_of_seed && member_of_seed[i] >= count) return GD_INVALID_ARGUMENT;
    struct place *places = malloc(sizeof *places * 3 * count);
    if (!places) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < count; i++)
        found +=
            places_of(&field->seeds[i], i, member_of_seed ? member_of_seed[i] : i, places + found);
    assign_places(places, found, of);
    free(places);
    return GD_OK;
}

/* --- vertices --------------------------------------------------------------------------------- */

/* Returns the pseudo-source from which the last leg to a vertex comes, without the bit for linear
 * sources. Returns GD_NONE if there is none. */
static uint32_t source_behind(const struct gd_field *field, uint32_t vertex)
{
    uint32_t source = gd__field_source_behind(field, vertex);
    return source == GD_NONE ? GD_NONE : source & ~GD__SOURCE_LINEAR;
}

/* Follows the path from a vertex to a pseudo-source with a known member, then sets that member for
 * all vertices passed. No path bends at a vertex twice, so more steps than vertices are an
 * error. */
static enum gd_status follow_predecessors(const struct gd_field *field, uint32_t vertex,
                                          uint32_t *of)
{
    uint32_t source = vertex, steps_left = field->mesh->vertex_count;
    while (of[source] == GD_NONE) {
        if (!steps_left--) return GD_INTERNAL;
        source = source_behind(field, source);
        if (source == GD_NONE) return GD_INTERNAL;
    }
    uint32_t member = of[source];
    for (source = vertex; of[source] == GD_NONE;) {
        of[source] = member;
        source = source_behind(field, source);
    }
    return GD_OK;
}

/* Finds the members of all remaining vertices. */
static enum gd_status find_owners(const struct gd_field *field, struct gd__members *members)
{
    enum gd_status status = GD_OK;
    for (uint32_t v = 0; v < field->mesh->vertex_count && !status; v++)
        if (field->distance[v] < GD__FAR && members->of[v] == GD_NONE)
            status = follow_predecessors(field, v, members->of);
    return status;
}

/* --- nudges ----------------------------------------------------------------------------------- */

/* Returns a pseudo-random number in [0, 1) for a member. */
static double nudge_of_member(uint32_t member)
{
    uint64_t hash = (member + UINT64_C(1)) * UINT64_C(0x9e3779b97f4a7c15);
    hash = (hash ^ (hash >> 32)) * UINT64_C(0xd6e8feb86659fd93);
    return (double)(hash >> 11) * 0x1p-53;
}

/* Computes `farthest`, an upper bound of the distances on edges, and the nudges. */
static void find_nudges(const struct gd_field *field, struct gd__members *members)
{
    const struct gd_mesh *mesh = field->mesh;
    for (uint32_t side = 0; side < 2 * mesh->edge_count; side++) {
        double distance = field->distance[mesh->origin[side]];
        if (distance < GD__FAR)
            members->farthest = fmax(members->farthest, distance + mesh->side[side].length);
    }
    for (uint32_t i = 0; i < field->seed_count; i++)
        members->nudge[i] = GD_TOL_TIE * members->farthest * nudge_of_member(i);
}

enum gd_status gd__members_find(const struct gd_field *field, const uint32_t *member_of_seed,
                                struct gd__arena *arena, struct gd__members *out)
{
    uint32_t vertices = field->mesh->vertex_count;
    struct gd__members members = {0};
    members.of = gd__arena_take(arena, (size_t)vertices + field->seed_count, sizeof *members.of);
    members.nudge = gd__arena_take(arena, field->seed_count, sizeof *members.nudge);
    enum gd_status status = arena->status;
    if (!status) status = assign_seeds(field, member_of_seed, members.of + vertices);
    for (uint32_t v = 0; v < vertices && !status; v++) members.of[v] = GD_NONE;
    if (!status) status = find_owners(field, &members);
    if (status) return status;
    find_nudges(field, &members);
    *out = members;
    return GD_OK;
}

enum gd_status gd__members_change(const struct gd_field *field, const uint32_t *owner,
                                  struct gd__members *members)
{
    for (uint32_t v = 0; v < field->mesh->vertex_count; v++)
        members->of[v] = owner[v] == members->of[v] ? GD_NONE : owner[v];
    return find_owners(field, members);
}

/* --- points on segments ----------------------------------------------------------------------- */

/* Returns true if a point seed lies on a segment seed in the same face, and the segment is at least
 * as near there, up to the nudge. */
static bool is_covered(const struct gd_field *field, uint32_t face, const struct gd__seed *point,
                       const struct gd__seed *segment, double slack)
{
    const struct gd_mesh *mesh = field->mesh;
    struct gd__local at = gd__point_local(mesh, face, &point->point);
    struct gd__chord chord = gd__chord(mesh, face, 0, &segment->point, &segment->end);
    double foot = gd__chord_foot(&chord, at), height = fabs(gd__chord_height(&chord, at));
    return foot >= 0 && foot <= chord.length && height <= slack &&
           segment->offset + height <= point->offset + slack;
}

static enum gd_status settle_point(const struct gd_field *field, const struct gd__face_seed *point,
                                   struct gd__members *members, struct gd__pace *pace,
                                   bool *changed)
{
    uint32_t *of = members->of + field->mesh->vertex_count;
    struct gd__face_seeds f = gd__field_seeds_in(field, point->face);
    enum gd_status status = GD_OK;
    for (; f.at < f.end && !status; f.at++) {
        const struct gd__seed *segment = &field->seeds[f.at->seed];
        status = gd__pace_step(pace, 2);
        if (!segment->is_segment || of[f.at->seed] == of[point->seed]) continue;
        if (!is_covered(field, point->face, &field->seeds[point->seed], segment,
                        GD_TOL_TIE * members->farthest))
            continue;
        of[point->seed] = of[f.at->seed];
        *changed = true;
        break;
    }
    return status;
}

enum gd_status gd__members_settle(const struct gd_field *field, const struct gd_control *control,
                                  struct gd__members *members)
{
    struct gd__pace pace = {.control = control};
    bool changed = false;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < field->face_seed_count && field->has_segments && !status; i++)
        if (!field->seeds[field->face_seeds[i].seed].is_segment)
            status = settle_point(field, &field->face_seeds[i], members, &pace, &changed);
    if (status || !changed) return status;
    for (uint32_t v = 0; v < field->mesh->vertex_count; v++) members->of[v] = GD_NONE;
    return find_owners(field, members);
}

/* --- labels ----------------------------------------------------------------------------------- */

enum gd_status gd_voronoi_labels(const struct gd_field *field, const uint32_t *member_of_seed,
                                 uint32_t *out)
{
    const struct gd_mesh *mesh = field->mesh;
    struct gd__members members;
    struct gd__arena arena = {0};
    enum gd_status status = gd__members_find(field, member_of_seed, &arena, &members);
    for (uint32_t i = 0; i < mesh->summary.index_count && !status; i++) {
        uint32_t vertex = mesh->vertex_of_index[i];
        bool is_known = vertex != GD_NONE && field->distance[vertex] <= field->reach;
        out[i] = is_known ? members.of[vertex] : UINT32_MAX;
    }
    gd__arena_free(&arena);
    return status;
}
