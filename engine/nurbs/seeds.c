#include "nurbs/seeds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/arena.h"
#include "base/tolerance.h"
#include "gd/field.h"
#include "mesh/union_find.h"
#include "nurbs/tessellation.h"

enum {
    PLACES_LEAST = 96,
    PLACES_MOST = 2048,
    SEEDS_MOST = 64,
    SEEDS_FEW = 12 /* largest number of seeds if only the shortest path is requested */
};

/* Two seeds lead to the same path if their lengths, ends and middles differ by less than this
 * fraction of the length. */
static const double same = 0.02;
/* A seed that is longer than this factor times the shortest seed does not lead to the shortest
 * path. */
static const double margin = 1.08;

/* One of the two curves, sampled on the mesh, with the distance field of its samples. */
struct side {
    const struct gd_domain_curve *curve;
    uint32_t count;
    double *s;             /* parameters of its sample places */
    struct gd_seed *seeds; /* the sample places on the mesh */
    struct gd_field *field;
    double *distance; /* distances at the vertices */
};

struct search {
    const struct gd_tessellation *tessellation;
    struct gd__arena arena;
    struct side side[2];
    struct gd__path_seeds seeds;
    struct gd__pace pace;
    bool all;
};

void gd__path_seeds_free(struct gd__path_seeds *seeds)
{
    for (uint32_t i = 0; i < seeds->count; i++) gd__uv_polyline_free(&seeds->seed[i].polyline);
    free(seeds->seed);
    *seeds = (struct gd__path_seeds){0};
}

/* --- the curves as sources -------------------------------------------------------------------- */

static enum gd_status place_side(struct search *search, struct side *side, struct gd_detail *detail)
{
    const struct gd_tessellation *t = search->tessellation;
    struct gd__pace *pace = &search->pace;
    const struct gd_domain_curve *curve = side->curve;
    static const struct gd__curve_places wanted = {2, PLACES_LEAST, PLACES_MOST, false};
    side->s = gd__curve_places(curve, &wanted, &search->arena, &side->count);
    side->seeds = gd__arena_zeroed(&search->arena, side->count, sizeof *side->seeds);
    enum gd_status status = search->arena.status;
    if (status) return gd_fail_status(detail, status);
    for (uint32_t i = 0; i < side->count && !status && gd__pace(pace, GD__STEP); i++) {
        double uv[2];
        gd_domain_curve_at(curve, side->s[i], uv);
        status = gd_tessellation_point(t, uv[0], uv[1], &side->seeds[i].point, detail);
    }
    if (pace->status) return gd_fail_status(detail, pace->status);
    return status;
}

static enum gd_status measure_side(struct search *search, struct side *side,
                                   struct gd_detail *detail)
{
    const struct gd_tessellation *t = search->tessellation;
    enum gd_status status = place_side(search, side, detail);
    if (status) return status;
    struct gd_field_request request = {.seeds = side->seeds, .seed_count = side->count};
    status = gd_field_build(t->mesh, &request, search->pace.control, &side->field, detail);
    if (status) return status;
    side->distance = gd__arena_take(&search->arena, gd_mesh_summary(t->mesh)->index_count,
                                    sizeof *side->distance);
    if (!side->distance) return gd_fail_status(detail, search->arena.status);
    gd_field_vertex_distances(side->field, side->distance);
    return GD_OK;
}

/* --- trails ----------------------------------------------------------------------------------- */

/* Moves a place by whole periods, such that it is nearest to `before`. At a pole, copies the
 * coordinate along the pole from `before`. */
static void unwind(const struct gd_parametric *surface, const double before[2], double at[2])
{
    for (int k = 0; k < 2; k++) {
        double period = gd__axis_period(surface->axis[k]);
        if (period > 0) at[k] -= round((at[k] - before[k]) / period) * period;
    }
    for (int k = 0; k < 2; k++)
        if (gd__surface_pole(surface, k, at[k])) at[1 - k] = before[1 - k];
}

static enum gd_status add_place(const struct gd_parametric *surface,
                                struct gd__uv_polyline *polyline, double at[2])
{
    if (polyline->count) unwind(surface, polyline->at[polyline->count - 1], at);
    return gd__uv_polyline_add(polyline, at);
}

static enum gd_status add_path(const struct gd_tessellation *t, const struct gd_path *path,
                               bool backwards, struct gd__uv_polyline *polyline)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < path->count && !status; i++) {
        double at[2];
        gd_tessellation_parameters(t, &path->points[backwards ? path->count - 1 - i : i], at);
        status = add_place(t->surface, polyline, at);
    }
    return status;
}

/* Finds the sampled place of the curve that is nearest to a point. Computes the place's parameter,
 * and the shortest path between place and point. */
static enum gd_status nurbs_seeds_reach(const struct side *side, const struct gd_point *point,
                                        double *s, struct gd_path *path)
{
    double distance;
    uint32_t number;
    enum gd_status status = gd_field_nearest(side->field, point, &distance, &number);
    if (status) return status;
    *s = side->s[number];
    return gd_field_path(side->field, point, path);
}

enum gd_status gd__path_seed_attach(const struct gd_domain_curve *const ends[2],
                                    struct gd__path_seed *seed)
{
    const struct gd_parametric *surface = ends[0]->surface;
    struct gd__uv_polyline *polyline = &seed->polyline;
    double at[2];
    if (polyline->count < 2) {
        enum gd_status status = gd__uv_polyline_add(polyline, polyline->at[0]);
        if (status) return status;
    }
    gd_domain_curve_at(ends[0], seed->s[0], at);
    unwind(surface, polyline->at[1], at);
    memcpy(polyline->at[0], at, sizeof at);
    gd_domain_curve_at(ends[1], seed->s[1], at);
    unwind(surface, polyline->at[polyline->count - 2], at);
    memcpy(polyline->at[polyline->count - 1], at, sizeof at);
    /* a path that begins in a pole leaves the pole along a line of constant parameter */
    for (int k = 0; k < 2; k++) {
        uint32_t outside = 0;
        while (outside + 1 < polyline->count &&
               gd__surface_pole(surface, k, polyline->at[outside][k]))
            outside++;
        for (uint32_t i = 0; i < outside; i++)
            polyline->at[i][1 - k] = polyline->at[outside][1 - k];
    }
    gd__uv_polyline_measure(surface, polyline);
    return GD_OK;
}

/* Adds the path through a point of the mesh that consists of the shortest paths from the point to
 * both curves. */
static enum gd_status add_seed(struct search *search, const struct gd_point *point)
{
    struct gd__path_seed seed = {0};
    struct gd_path path[2] = {{0}};
    enum gd_status status = GD_OK;
    for (int k = 0; k < 2 && !status; k++)
        status = nurbs_seeds_reach(&search->side[k], point, &seed.s[k], &path[k]);
    if (!status) status = add_path(search->tessellation, &path[0], true, &seed.polyline);
    if (!status) status = add_path(search->tessellation, &path[1], false, &seed.polyline);
    const struct gd_domain_curve *const ends[2] = {search->side[0].curve, search->side[1].curve};
    if (!status) status = gd__path_seed_attach(ends, &seed);
    seed.length = path[0].length + path[1].length;
    gd_path_free(&path[0]);
    gd_path_free(&path[1]);
    struct gd__path_seeds *seeds = &search->seeds;
    if (!status)
        status =
            gd__array_append(&seeds->seed, &seeds->count, &seeds->capacity, &seed, sizeof seed);
    if (status) gd__uv_polyline_free(&seed.polyline);
    return status;
}

/* --- local minima ----------------------------------------------------------------------------- */

/* The place where the set d1 = d2 crosses an edge of the mesh. */
struct crossing {
    uint32_t a, b; /* vertices, a < b */
    double part;   /* fraction of the edge, from a */
    double sum;    /* d1 + d2 at the crossing, by linear interpolation */
    /* smallest sum at the neighbouring crossings in the edge's faces */
    double least;
    uint32_t others, other[2][2]; /* the edges of these crossings */
};

static bool nurbs_seeds_cross(const struct search *search, uint32_t a, uint32_t b,
                              struct crossing *out)
{
    if (a > b) {
        uint32_t swap = a;
        a = b;
        b = swap;
    }
    const double *d1 = search->side[0].distance, *d2 = search->side[1].distance;
    double at_a = d1[a] - d2[a], at_b = d1[b] - d2[b];
    if ((at_a < 0) == (at_b < 0) || !isfinite(at_a) || !isfinite(at_b)) return false;
    double part = at_a / (at_a - at_b);
    *out = (struct crossing){.a = a,
                             .b = b,
                             .part = part,
                             .sum = (1 - part) * (d1[a] + d2[a]) + part * (d1[b] + d2[b]),
                             .least = INFINITY};
    return true;
}

static int by_edge(const void *x, const void *y)
{
    const struct crossing *p = x, *q = y;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return p->b < q->b ? -1 : p->b > q->b;
}

/* Lists the crossings of all faces. A crossing has one entry for each face of its edge. As `least`,
 * each entry has the sum at the other crossing of its face. If `out` is NULL, only counts the
 * entries. */
static uint32_t list_crossings(struct search *search, struct crossing *out)
{
    const struct gd_polygons *polygons = &search->tessellation->polygons;
    uint32_t count = 0;
    for (uint32_t face = 0; face < polygons->polygon_count && gd__pace(&search->pace, GD__STEP);
         face++) {
        const uint32_t *corner = polygons->corners + 3 * (size_t)face;
        struct crossing found[3];
        int in_face = 0;
        for (int k = 0; k < 3; k++)
            in_face += nurbs_seeds_cross(search, corner[k], corner[(k + 1) % 3], &found[in_face]);
        if (in_face != 2) continue;
        for (int k = 0; k < 2; k++) {
            found[k].least = found[1 - k].sum;
            found[k].others = 1;
            found[k].other[0][0] = found[1 - k].a;
            found[k].other[0][1] = found[1 - k].b;
        }
        if (out) memcpy(out + count, found, 2 * sizeof *out);
        count += 2;
    }
    return count;
}

static enum gd_status add_crossing(struct search *search, const struct crossing *crossing,
                                   struct gd_detail *detail)
{
    struct gd_point point;
    enum gd_status status = gd_point_on_edge(search->tessellation->mesh,
                                             (struct gd_vertex[]){{crossing->a}, {crossing->b}},
                                             crossing->part, &point, detail);
    return status ? status : add_seed(search, &point);
}

/* Joins the two entries of each crossing that is not on the boundary. Returns the number of
 * crossings. */
static uint32_t join_entries(struct crossing *list, uint32_t count)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (kept && by_edge(&list[kept - 1], &list[i]) == 0) {
            struct crossing *first = &list[kept - 1];
            first->least = fmin(first->least, list[i].least);
            memcpy(first->other[first->others++], list[i].other[0], sizeof *first->other);
        } else {
            list[kept++] = list[i];
        }
    }
    return kept;
}

/* --- plateaus --------------------------------------------------------------------------------- */

/* A plateau is a connected set of crossings with equal sums, through which equally long paths pass.
 * Usually it is a single crossing. */
struct plateau {
    uint32_t members;
    bool is_least; /* true if no neighbouring crossing has a smaller sum */
};

static bool is_level(double a, double b)
{
    return fabs(a - b) <= GD_TOL_FAMILY * a;
}

static void find_plateaus(const struct crossing *list, uint32_t count, uint32_t *parent,
                          struct plateau *plateaus)
{
    gd__union_find_init(parent, count);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < list[i].others; k++) {
            const struct crossing key = {.a = list[i].other[k][0], .b = list[i].other[k][1]};
            const struct crossing *other = bsearch(&key, list, count, sizeof *list, by_edge);
            if (is_level(list[i].sum, other->sum))
                gd__union_find_join(parent, i, (uint32_t)(other - list));
        }
    }
    for (uint32_t i = 0; i < count; i++) plateaus[i] = (struct plateau){0, true};
    for (uint32_t i = 0; i < count; i++) {
        struct plateau *plateau = &plateaus[gd__union_find_root(parent, i)];
        plateau->members++;
        if (list[i].least < list[i].sum && !is_level(list[i].sum, list[i].least))
            plateau->is_least = false;
    }
}

/* For each plateau that is a local minimum, adds a seed through its middle crossing, in the order
 * of the edges. */
static enum gd_status add_plateaus(struct search *search, const struct crossing *list,
                                   uint32_t count, struct gd_detail *detail)
{
    uint32_t *parent = gd__arena_take(&search->arena, count, sizeof *parent),
             *seen = gd__arena_zeroed(&search->arena, count, sizeof *seen);
    struct plateau *plateaus = gd__arena_take(&search->arena, count, sizeof *plateaus);
    enum gd_status status = search->arena.status;
    if (!status) find_plateaus(list, count, parent, plateaus);
    for (uint32_t i = 0; i < count && !status; i++) {
        uint32_t root = gd__union_find_root(parent, i);
        if (seen[root]++ == plateaus[root].members / 2 && plateaus[root].is_least &&
            search->seeds.count < SEEDS_MOST)
            status = add_crossing(search, &list[i], detail);
    }
    return search->arena.status ? gd_fail_status(detail, status) : status;
}

static enum gd_status add_middles(struct search *search, double shortest, struct gd_detail *detail)
{
    struct crossing *list =
        gd__arena_take(&search->arena, list_crossings(search, NULL), sizeof *list);
    if (!list) return gd_fail_status(detail, search->arena.status);
    uint32_t count = list_crossings(search, list);
    qsort(list, count, sizeof *list, by_edge);
    enum gd_status status = search->pace.status;
    if (!status) count = join_entries(list, count);
    if (!status && search->all) status = add_plateaus(search, list, count, detail);
    for (uint32_t i = 0; i < count && !status && !search->all; i++)
        if (list[i].sum <= fmin(list[i].least, margin * shortest) &&
            search->seeds.count < SEEDS_MOST)
            status = add_crossing(search, &list[i], detail);
    return status;
}

/* Computes the distances of a curve's places from the other curve. Sets *shortest to the smallest
 * one. */
static enum gd_status find_ends(struct search *search, int k, double *distance, double *shortest)
{
    const struct side *side = &search->side[k];
    enum gd_status status = GD_OK;
    *shortest = INFINITY;
    for (uint32_t i = 0; i < side->count && !status; i++) {
        if (!gd__pace(&search->pace, GD__STEP)) return search->pace.status;
        status = gd_field_distance(search->side[1 - k].field, &side->seeds[i].point, &distance[i]);
        if (!status) *shortest = fmin(*shortest, distance[i]);
    }
    return status;
}

static enum gd_status add_ends(struct search *search, int k, double *shortest)
{
    const struct side *side = &search->side[k];
    double *distance = gd__arena_take(&search->arena, side->count, sizeof *distance);
    if (!distance) return search->arena.status;
    enum gd_status status = find_ends(search, k, distance, shortest);
    uint32_t n = side->count;
    bool around = side->curve->closed;
    for (uint32_t i = 0; i < n && !status; i++) {
        if (i ? distance[i - 1] < distance[i] : around && distance[n - 1] < distance[i]) continue;
        if (i + 1 < n ? distance[i + 1] <= distance[i]
                      : around && n > 1 && distance[0] <= distance[i])
            continue;
        if ((search->all || distance[i] <= margin * *shortest) && search->seeds.count < SEEDS_MOST)
            status = add_seed(search, &side->seeds[i].point);
    }
    return status;
}

static int by_length(const void *x, const void *y)
{
    const struct gd__path_seed *p = x, *q = y;
    return p->length < q->length ? -1 : p->length > q->length;
}

static struct gd_vec3 polyline_position(const struct gd_parametric *surface,
                                        const struct gd__uv_polyline *polyline, double part)
{
    double at[2];
    gd__uv_polyline_at(
        polyline, gd__uv_polyline_position(polyline, part * polyline->arc[polyline->count - 1], 0),
        at);
    return gd__surface_position(surface, at);
}

static bool is_same(const struct gd_parametric *surface, struct gd__pace *pace,
                    const struct gd__path_seed *a, const struct gd__path_seed *b)
{
    if (fabs(a->length - b->length) > same * a->length) return false;
    for (int i = 0; i <= 4 && gd__pace(pace, GD__STEP); i++)
        if (gd_vec3_distance(polyline_position(surface, &a->polyline, 0.25 * i),
                             polyline_position(surface, &b->polyline, 0.25 * i)) > same * a->length)
            return false;
    return true;
}

/* Sorts the seeds by length, and keeps the shortest seed of each path, at most `most` seeds. */
static enum gd_status sift(const struct gd_parametric *surface, uint32_t most,
                           struct gd__pace *pace, struct gd__path_seeds *seeds)
{
    qsort(seeds->seed, seeds->count, sizeof *seeds->seed, by_length);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < seeds->count; i++) {
        struct gd__path_seed seed = seeds->seed[i];
        bool wanted = kept < most;
        for (uint32_t k = 0; k < kept && wanted; k++)
            wanted = !is_same(surface, pace, &seeds->seed[k], &seed);
        if (wanted)
            seeds->seed[kept++] = seed;
        else
            gd__uv_polyline_free(&seed.polyline);
    }
    seeds->count = kept;
    return pace->status;
}

enum gd_status gd__path_seeds_find(const struct gd_tessellation *tessellation,
                                   const struct gd_domain_curve *from,
                                   const struct gd_domain_curve *to, bool all,
                                   struct gd__share *share, struct gd__path_seeds *out,
                                   struct gd_detail *detail)
{
    const struct gd_control own = gd__share_control(share, 0);
    struct search search = {.tessellation = tessellation,
                            .arena.budget.control = &own,
                            .side = {{.curve = from}, {.curve = to}},
                            .pace = {.control = &own},
                            .all = all};
    enum gd_status status = GD_OK;
    double shortest = INFINITY;
    for (int k = 0; k < 2 && !status; k++) {
        status = measure_side(&search, &search.side[k], detail);
        share->done++;
    }
    for (int k = 1; k >= 0 && !status; k--) status = add_ends(&search, k, &shortest);
    if (!status) status = add_middles(&search, shortest, detail);
    if (!status && !search.seeds.count)
        status = gd_fail(detail, GD_INTERNAL, "no path was found on the tessellation");
    for (int k = 0; k < 2; k++) gd_field_release(search.side[k].field);
    gd__arena_free(&search.arena);
    if (!status)
        status =
            sift(tessellation->surface, all ? SEEDS_MOST : SEEDS_FEW, &search.pace, &search.seeds);
    if (status)
        gd__path_seeds_free(&search.seeds);
    else
        *out = search.seeds;
    return search.pace.status ? gd_fail_status(detail, status) : status;
}
