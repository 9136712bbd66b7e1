#include <stdlib.h>

#include "base/array.h"
#include "base/pace.h"
#include "field/circle.h"
#include "window/contest.h"

/* The farthest point. Inside a region with one nearest source the distance has no maximum. On the
 * bisector of two sources inside a face the distance can have a maximum only where the two
 * gradients are opposite. If the sources are two points, or a point and a segment, such a position
 * is a saddle. If the sources are two parallel segments, the position belongs to a ridge of
 * constant distance. This ridge ends at a third source or on the boundary, or is a closed line that
 * crosses edges. Therefore a maximum is a vertex, a point of a boundary edge between two sources, a
 * point of any edge between two segments, or a point between three sources. Vertices are tried
 * first. Then the search visits only faces whose distances may exceed the best distance so far. In
 * each face it uses only the sources that may give such distances. If these are many, it divides
 * the face and its sides into parts with few sources. */

enum {
    STEPS_OF_FACE = GD__PACE_STEPS / 64,
    FEW = 12,       /* number of sources of which all triples are tried */
    CELL_COST = 32, /* cost of a cell, in triples that are tried in this time */
    DEPTH_MOST = 24 /* of cells; a cell of this depth is 2^24 times smaller than its face */
};

struct candidate {
    double most; /* upper bound of the distances in the face */
    uint32_t face;
};

struct search {
    const struct gd_field *field;
    const struct gd_mesh *mesh;
    struct gd__pace pace;
    double best;
    struct gd_point point;
    struct candidate *candidate;
    uint32_t candidate_count, candidate_capacity;
    struct gd__sources sources;
    /* sources of the current face that may exceed the best distance; behind them, those of the
       parts that are being searched */
    uint32_t *rising;
    uint32_t rising_count, rising_capacity;
    /* What the division of the current face or side may still cost. If many sources are equally far
       along a line, dividing does not separate them. The division then ends when it has cost as
       much as trying all triples or pairs, and these are tried. */
    uint64_t work;
};

static void close_search(struct search *search)
{
    free(search->candidate);
    gd__sources_destroy(&search->sources);
    free(search->rising);
}

static void take_farthest_vertex(struct search *search)
{
    search->best = -1;
    for (uint32_t v = 0; v < search->mesh->vertex_count; v++) {
        double distance = search->field->distance[v];
        if (distance >= GD__FAR || distance <= search->best) continue;
        search->best = distance;
        search->point = gd__point_of_vertex(v);
    }
}

/* Replaces the best position by a position of the current face whose exact distance is greater. */
static void offer_place(struct search *search, struct gd__local at)
{
    struct gd_point point =
        gd__face_frame_point(search->mesh, search->sources.face, &search->sources.frame, at);
    struct gd__leg_key way;
    (void)gd__pace(&search->pace, search->sources.count);
    gd__field_leg_key(search->field, &point, &way);
    if (way.kind == GD__LEG_NONE || way.distance <= search->best) return;
    search->best = way.distance;
    search->point = point;
}

/* --- candidate faces -------------------------------------------------------------------------- */

static int by_most(const void *a, const void *b)
{
    const struct candidate *x = a, *y = b;
    if (x->most != y->most) return x->most > y->most ? -1 : 1;
    return (x->face > y->face) - (x->face < y->face);
}

static enum gd_status find_candidates(struct search *search)
{
    enum gd_status status = GD_OK;
    for (uint32_t face = 0; face < search->mesh->face_count && !status; face++) {
        struct candidate found = {gd__field_face_levels(search->field, face).most, face};
        if (found.most > search->best && found.most < GD__FAR)
            status = gd__array_append(&search->candidate, &search->candidate_count,
                                      &search->candidate_capacity, &found, sizeof found);
    }
    if (search->candidate_count)
        qsort(search->candidate, search->candidate_count, sizeof *search->candidate, by_most);
    return status;
}

/* --- candidate sources ------------------------------------------------------------------------ */

/* Sets *out to true if a source may give a distance beyond the best distance at some point of the
 * face. The straight line from the source to that point either enters the face beyond the best
 * distance, or reaches the best distance inside the face. The slack covers two cases: all points of
 * an edge are at the best distance from a segment source, or the best point is a seed at a
 * vertex. */
static enum gd_status is_rising(struct search *search, uint32_t i, bool *out)
{
    const struct gd__source *source = &search->sources.source[i];
    *out = source->farthest >=
           search->best - gd__envelope_slack(search->best, search->sources.frame.size);
    if (*out || source->nearest >= search->best) return GD_OK;
    enum gd_status status = gd__circle_arcs(&search->sources, i, search->best);
    *out = search->sources.spans.count > 0;
    return status;
}

static enum gd_status find_rising(struct search *search, uint32_t face)
{
    enum gd_status status = gd__sources_gather(search->field, face, GD__FAR, &search->sources);
    search->rising_count = 0;
    for (uint32_t i = 0; i < search->sources.count && !status; i++) {
        bool rises;
        status = is_rising(search, i, &rises);
        if (!status) status = gd__pace_step(&search->pace, 2 * search->sources.count);
        if (!status && rises)
            status = gd__array_append(&search->rising, &search->rising_count,
                                      &search->rising_capacity, &i, sizeof i);
    }
    return status;
}

/* --- points between three sources ------------------------------------------------------------- */

/* A plane in the space of (position, distance): the points q with normal . q = value. */
struct plane {
    struct gd_vec3 normal;
    double value;
};

/* Returns the plane that contains all (p, r) where a source and `first`, a point at the origin,
 * give the same distance. r is this distance minus the sigma of `first`, so |p| = r. For a point
 * source at a, whose sigma is greater by k, |p - a| = r - k, so a p - k r = (a^2 - k^2) / 2. The
 * distance of a linear source is itself a plane. */
static struct plane plane_between(const struct gd__source *first, const struct gd__source *source)
{
    if (source->linear)
        return (struct plane){{source->gradient.x, source->gradient.y, -1},
                              first->sigma - gd__source_distance(source, first->at)};
    struct gd__local a = {source->at.x - first->at.x, source->at.y - first->at.y};
    double k = source->sigma - first->sigma;
    return (struct plane){{a.x, a.y, -k}, 0.5 * (gd__local_dot(a, a) - k * k)};
}

/* Returns the intersection of three planes; not finite if there is none. */
static struct gd_vec3 meet_planes(const struct plane *a, const struct plane *b,
                                  const struct plane *c)
{
    struct gd_vec3 bc = gd_vec3_cross(b->normal, c->normal),
                   ca = gd_vec3_cross(c->normal, a->normal),
                   ab = gd_vec3_cross(a->normal, b->normal);
    struct gd_vec3 sum =
        gd_vec3_along(gd_vec3_along(gd_vec3_scale(bc, a->value), b->value, ca), c->value, ab);
    return gd_vec3_scale(sum, 1 / gd_vec3_dot(a->normal, bc));
}

/* Returns the bilinear form of the cone: horizontal dot product minus product of heights.
 * cone_form(q, q) is 0 on the cone |p| = r. */
static double cone_form(struct gd_vec3 a, struct gd_vec3 b)
{
    return a.x * b.x + a.y * b.y - a.z * b.z;
}

/* Intersects the line of two planes, u + t w, with the cone |p| = |r|, which is a quadratic in t.
 * Returns the number of intersections. */
static int meet_cone(const struct plane *a, const struct plane *b, struct gd_vec3 point[2])
{
    struct gd_vec3 w = gd_vec3_cross(a->normal, b->normal);
    struct plane across = {w, 0};
    struct gd_vec3 u = meet_planes(a, b, &across);
    double q2 = cone_form(w, w), q1 = cone_form(u, w), q0 = cone_form(u, u),
           discriminant = q1 * q1 - q2 * q0;
    if (!(discriminant >= 0)) return 0;
    double z = -(q1 + copysign(sqrt(discriminant), q1)), root[2] = {q0 / z, z / q2};
    int count = 0;
    for (int i = 0; i < 2; i++)
        if (isfinite(root[i])) point[count++] = gd_vec3_along(u, root[i], w);
    return count;
}

/* Returns true if a solution r is a distance, that is, not on the other half of the cone. */
static bool is_distance(const struct gd__source *first, const struct gd__source *source, double r)
{
    return source->linear || r >= source->sigma - first->sigma;
}

/* Computes the positions equally far from three sources. The first source is a point, or all are
 * linear. Returns the number of positions. */
static int places_between(const struct gd__source *const s[3], struct gd__local place[2])
{
    struct gd_vec3 point[2];
    int count = 1, kept = 0;
    const struct gd__source origin = {0};
    const struct gd__source *first = s[0]->linear ? &origin : s[0];
    struct plane planes[3];
    for (int i = 0; i < 3; i++) planes[i] = plane_between(first, s[i]);
    if (s[0]->linear)
        point[0] = meet_planes(&planes[0], &planes[1], &planes[2]);
    else
        count = meet_cone(&planes[1], &planes[2], point);
    for (int i = 0; i < count; i++) {
        if (is_distance(first, s[0], point[i].z) && is_distance(first, s[1], point[i].z) &&
            is_distance(first, s[2], point[i].z))
            place[kept++] = (struct gd__local){first->at.x + point[i].x, first->at.y + point[i].y};
    }
    return kept;
}

/* The disc around a part of the face that is searched. */
struct disc {
    struct gd__local centre;
    double radius;
};

static const struct disc everything = {.radius = INFINITY};

static bool disc_has(const struct disc *disc, struct gd__local place)
{
    return hypot(place.x - disc->centre.x, place.y - disc->centre.y) <= disc->radius;
}

static void search_between(struct search *search, const struct disc *disc, uint32_t i, uint32_t k,
                           uint32_t l)
{
    const struct gd__source *all = search->sources.source, *s[3] = {&all[i], &all[k], &all[l]};
    const struct gd__face_frame *frame = &search->sources.frame;
    struct gd__local place[2];
    int point = s[0]->linear ? s[1]->linear ? 2 : 1 : 0; /* the first point source, if any */
    s[0] = s[point];
    s[point] = &all[i];
    int count = places_between(s, place);
    for (int p = 0; p < count; p++)
        if (gd__source_distance(s[0], place[p]) > search->best && disc_has(disc, place[p]) &&
            gd__face_frame_has(frame, place[p], GD_TOL_CHECK * frame->size))
            offer_place(search, place[p]);
}

/* Sources of a part of the face: `count` items of `rising` from `first` on. */
struct list {
    uint32_t first, count;
};

/* Tries all triples of a list. */
static void search_triples(struct search *search, const struct disc *disc, const struct list *list)
{
    const uint32_t *source = search->rising + list->first, count = list->count;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = i + 1; k < count && gd__pace(&search->pace, 2 * (count - k)); k++)
            for (uint32_t l = k + 1; l < count; l++)
                search_between(search, disc, source[i], source[k], source[l]);
}

/* Appends to `rising` the sources of a list that may give a distance beyond the best one in the
 * disc. Sets *out to them. Returns false if there are none, or if no work is left. Between two
 * points of a face the distance changes by at most the distance of the points, and so does the
 * distance from one source. */
static bool narrow(struct search *search, const struct disc *disc, const struct list *list,
                   struct list *out)
{
    const struct gd__sources *sources = &search->sources;
    struct gd__leg_key way;
    *out = (struct list){search->rising_count, 0};
    uint64_t cost = CELL_COST + list->count;
    search->work = search->work > cost ? search->work - cost : 0;
    if (!search->work) return false;
    if (!gd__pace(&search->pace, 8 + sources->count)) return false;
    struct gd_point point =
        gd__face_frame_point(search->mesh, sources->face, &sources->frame, disc->centre);
    gd__field_leg_key(search->field, &point, &way);
    if (way.kind == GD__LEG_NONE) return false; /* the whole face is unreached */
    double slack = gd__envelope_slack(way.distance + disc->radius, sources->frame.size),
           away = 2 * disc->radius + slack;
    if (way.distance + disc->radius + slack < search->best) return false;
    double least = fmax(way.distance - away, search->best - disc->radius - slack);
    for (uint32_t i = 0; i < list->count && gd__pace(&search->pace, 1); i++) {
        uint32_t source = search->rising[list->first + i];
        double distance = gd__source_distance(&sources->source[source], disc->centre);
        if (distance < least || distance > way.distance + away) continue;
        search->pace.status = gd__array_append(&search->rising, &search->rising_count,
                                               &search->rising_capacity, &source, sizeof source);
    }
    out->count = search->rising_count - out->first;
    return !search->pace.status && out->count > 1;
}

/* Returns the disc of a triangle, which is slightly larger than the triangle. */
static struct disc disc_around(const struct gd__local corner[3])
{
    struct disc disc = {{(corner[0].x + corner[1].x + corner[2].x) / 3,
                         (corner[0].y + corner[1].y + corner[2].y) / 3},
                        0};
    for (int k = 0; k < 3; k++)
        disc.radius =
            fmax(disc.radius, hypot(corner[k].x - disc.centre.x, corner[k].y - disc.centre.y));
    disc.radius *= 1.001;
    return disc;
}

/* Searches a triangle of the face. If it has many sources, it is divided into four triangles, each
 * of which has fewer. */
static void search_cell(struct search *search, const struct gd__local corner[3],
                        const struct list *list, int depth)
{
    struct disc disc = disc_around(corner);
    struct gd__local side[3];
    struct list kept;
    for (int k = 0; k < 3; k++) {
        const struct gd__local *a = &corner[k], *b = &corner[(k + 1) % 3];
        side[k] = (struct gd__local){0.5 * (a->x + b->x), 0.5 * (a->y + b->y)};
    }
    if (!narrow(search, &disc, list, &kept)) {
        /* nothing to search */
    } else if (kept.count <= FEW || depth == DEPTH_MOST) {
        search_triples(search, &disc, &kept);
    } else {
        for (int k = 0; k < 3; k++)
            search_cell(search, (const struct gd__local[]){corner[k], side[k], side[(k + 2) % 3]},
                        &kept, depth + 1);
        search_cell(search, side, &kept, depth + 1);
    }
    search->rising_count = kept.first;
}

static void search_inside(struct search *search)
{
    const struct list all = {0, search->rising_count};
    search->work = (uint64_t)all.count * all.count * all.count / 6;
    if (all.count > FEW) search_cell(search, search->sources.frame.corner, &all, 0);
    if (all.count <= FEW || !search->work) search_triples(search, &everything, &all);
}

/* --- along edges ------------------------------------------------------------------------------ */

/* Returns a source as a window of side k. The window always has y >= 0, because distances along the
 * side do not depend on which side of the line the source lies. */
static struct gd__window window_of(const struct gd__face_frame *frame, int k,
                                   const struct gd__source *source)
{
    struct gd__local corner = frame->corner[k],
                     from = {source->at.x - corner.x, source->at.y - corner.y},
                     towards = {-source->gradient.x, -source->gradient.y},
                     image = source->linear ? towards : from;
    return (struct gd__window){.b1 = frame->length[k],
                               .x = gd__local_dot(frame->along[k], image),
                               .y = fabs(gd__local_cross(frame->along[k], image)),
                               .sigma = source->linear ? gd__source_distance(source, corner)
                                                       : source->sigma,
                               .source = source->linear ? GD__SOURCE_LINEAR : 0};
}

/* A part of side `k` of the face, by distances from its corner k. */
struct stretch {
    int k;
    bool is_boundary;
    double from, to;
};

static void search_pair_along(struct search *search, const struct stretch *part,
                              const struct disc *disc, const struct gd__source *const s[2])
{
    const struct gd__face_frame *frame = &search->sources.frame;
    int k = part->k;
    struct gd__window a = window_of(frame, k, s[0]), b = window_of(frame, k, s[1]);
    struct gd__contest_result verdict = gd__contest(&a, &b, 0, frame->length[k]);
    for (int i = 0; i < verdict.switches; i++) {
        struct gd__local place = gd__face_frame_place(frame, k, verdict.at[i], 0);
        if (gd__window_distance(&a, verdict.at[i]) > search->best && disc_has(disc, place))
            offer_place(search, place);
    }
}

/* Tries all pairs of a list. */
static void search_pairs(struct search *search, const struct stretch *part, const struct disc *disc,
                         const struct list *list)
{
    const uint32_t *source = search->rising + list->first;
    for (uint32_t i = 0; i < list->count && gd__pace(&search->pace, 4 * list->count); i++)
        for (uint32_t j = i + 1; j < list->count; j++) {
            const struct gd__source *all = search->sources.source,
                                    *s[2] = {&all[source[i]], &all[source[j]]};
            if (part->is_boundary || (s[0]->linear && s[1]->linear))
                search_pair_along(search, part, disc, s);
        }
}

/* Searches a part of a side. If it has many sources, it is halved. */
static void search_stretch(struct search *search, const struct stretch *part,
                           const struct list *list, int depth)
{
    double middle = 0.5 * (part->from + part->to);
    struct disc disc = {gd__face_frame_place(&search->sources.frame, part->k, middle, 0),
                        1.001 * (middle - part->from)};
    struct stretch half[2] = {*part, *part};
    struct list kept;
    half[0].to = half[1].from = middle;
    if (!narrow(search, &disc, list, &kept)) {
        /* nothing to search */
    } else if (kept.count <= FEW || depth == DEPTH_MOST) {
        search_pairs(search, part, &disc, &kept);
    } else {
        search_stretch(search, &half[0], &kept, depth + 1);
        search_stretch(search, &half[1], &kept, depth + 1);
    }
    search->rising_count = kept.first;
}

static void search_along(struct search *search, int k, bool is_boundary)
{
    const struct list all = {0, search->rising_count};
    const struct stretch side = {k, is_boundary, 0, search->sources.frame.length[k]};
    if (!is_boundary && !search->field->has_segments) return;
    search->work = (uint64_t)all.count * all.count / 2;
    if (all.count > FEW) search_stretch(search, &side, &all, 0);
    if (all.count <= FEW || !search->work) search_pairs(search, &side, &everything, &all);
}

static enum gd_status search_face(struct search *search, uint32_t face)
{
    enum gd_status status = find_rising(search, face);
    if (status || !search->rising_count) return status;
    for (int k = 0; k < 3; k++)
        search_along(search, k,
                     gd__side_is_boundary(search->mesh, search->mesh->face_side[face][k] ^ 1));
    search_inside(search);
    return search->pace.status;
}

/* Returns true if the field has a distance for every seed at a vertex. For every other seed, its
 * face's corner 0 must have a distance. */
static bool is_heard_of_all_seeds(const struct gd_field *field)
{
    const struct gd_mesh *mesh = field->mesh;
    for (uint32_t i = 0; i < field->face_seed_count; i++)
        if (field->distance[mesh->origin[mesh->face_side[field->face_seeds[i].face][0]]] >= GD__FAR)
            return false;
    for (uint32_t i = 0; i < field->seed_count; i++) {
        const struct gd_point *point = &field->seeds[i].point;
        if (point->kind == GD_POINT_VERTEX && field->distance[point->element] >= GD__FAR)
            return false;
    }
    return true;
}

/* Returns true if all points with a path to a seed are within the field's reach. If the field
 * reaches only some corners of a face, points of that face may be beyond the reach. */
static bool is_within_reach(const struct search *search)
{
    const struct gd_field *field = search->field;
    const struct gd_mesh *mesh = field->mesh;
    if (field->reach >= GD__FAR) return true;
    for (uint32_t face = 0; face < mesh->face_count; face++) {
        double most = gd__field_face_levels(field, face).most;
        if (most > field->reach && most < GD__FAR) return false;
    }
    return is_heard_of_all_seeds(field);
}

enum gd_status gd_field_farthest(const struct gd_field *field, const struct gd_control *control,
                                 struct gd_point *point, double *distance)
{
    struct search search = {.field = field, .mesh = field->mesh, .pace = {.control = control}};
    if (!is_within_reach(&search)) return GD_BEYOND_REACH;
    take_farthest_vertex(&search);
    enum gd_status status = gd_control_check(control, 0);
    if (!status) status = find_candidates(&search);
    for (uint32_t i = 0;
         i < search.candidate_count && !status && search.candidate[i].most > search.best; i++) {
        search.pace.fraction = (double)i / search.candidate_count;
        status = gd__pace_step(&search.pace, STEPS_OF_FACE);
        if (!status) status = search_face(&search, search.candidate[i].face);
    }
    close_search(&search);
    if (status) return status;
    *point = search.point;
    *distance = search.best * field->mesh->unit;
    return GD_OK;
}
