/* Shortest paths: searches a path on the mesh, and replaces it by a geodesic of the surface. */
#include "gd/limit_shortest.h"

#include <math.h>
#include <stdlib.h>

#include "base/tolerance.h"
#include "gd/limit_place.h"
#include "gd/locate.h"
#include "gd/query.h"
#include "subdiv/domain.h"
#include "subdiv/surface.h"

void gd_limit_shortest_free(struct gd_limit_shortest *shortest)
{
    if (!shortest) return;
    free(shortest->steps);
    *shortest = (struct gd_limit_shortest){0};
}

/* One search with its results. */
struct search {
    const struct gd_limit_mesh *fine;
    const struct gd_control *control;
    struct gd_detail *detail;
    struct gd_limit_point ends[2];
    struct gd_pair_answer pair; /* on the mesh */
    struct gd_limit_point *places;
    struct gd_limit_jet *jets;
    uint32_t count; /* number of places and jets */
};

static void search_free(struct search *search)
{
    gd_pair_answer_free(&search->pair);
    free(search->places);
    free(search->jets);
}

/* --- on the mesh ------------------------------------------------------------------------------ */

static enum gd_status search_mesh(struct search *search)
{
    struct gd_point points[2];
    enum gd_status status = GD_OK;
    for (int i = 0; i < 2 && !status; i++)
        status = gd_limit_place_check(gd_limit_mesh_surface(search->fine), &search->ends[i],
                                      search->detail);
    for (int i = 0; i < 2 && !status; i++)
        status = gd_limit_mesh_point(search->fine, &search->ends[i], &points[i], search->detail);
    if (status) return status;
    return gd_pair_solve(
        gd_limit_mesh_mesh(search->fine),
        &(struct gd_pair_request){.from = &points[0], .to = &points[1], .output = GD_PAIR_PATH},
        search->control, &search->pair, search->detail);
}

/* Computes the place at the middle of a straight part of the path. If the mesh intersects itself,
 * the result may lie on another part of the surface. The length is equally good then. */
static enum gd_status place_between(const struct search *search, const struct gd_point *a,
                                    const struct gd_point *b, struct gd_limit_point *out)
{
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(search->fine);
    struct gd_vec3 sum = gd_vec3_add(gd_point_position(mesh, a), gd_point_position(mesh, b));
    struct gd_point middle;
    enum gd_status status =
        gd_locate_nearest(mesh, gd_vec3_scale(sum, 0.5), -1, &middle, search->detail);
    if (!status) *out = gd_limit_mesh_place(search->fine, &middle);
    return status;
}

/* Computes the places of the path's points and of the middles of its parts. The first and the last
 * place are those of the request. */
static enum gd_status place_path(struct search *search)
{
    const struct gd_path *path = &search->pair.path;
    struct gd_limit_point *places = search->places;
    enum gd_status status = GD_OK;
    for (uint32_t i = 1; i < path->count && !status; i++) {
        status = place_between(search, &path->points[i - 1], &path->points[i], &places[2 * i - 1]);
        places[2 * i] = gd_limit_mesh_place(search->fine, &path->points[i]);
    }
    places[0] = search->ends[0];
    places[search->count - 1] = search->ends[1];
    return status;
}

/* Returns true if the place lies on an infinitely sharp crease, where the surface has a normal for
 * each side of the crease. */
static bool is_on_crease(const struct gd_subdivision *surface, const struct gd_limit_point *place)
{
    const struct gd__net *base = &surface->base;
    struct gd__face_place local = gd__face_place_of(surface, place);
    for (uint32_t k = 0; k < base->arity; k++) {
        uint32_t side = base->arity * local.face + k;
        if (base->sharpness[side] == INFINITY && base->twin[side] != GD_NONE &&
            fabs(gd__line_at(base->arity, k, local.s, local.t)) <= GD_TOL_PLACE)
            return true;
    }
    return false;
}

/* Allocates and computes the path's places, and evaluates the surface at them. Removes the normals
 * on creases: such a normal is right for only one of the two parts of the path. */
static enum gd_status lift(struct search *search)
{
    uint32_t count = search->pair.path.count < 2 ? 3 : 2 * search->pair.path.count - 1;
    size_t bytes = count * (sizeof *search->places + sizeof *search->jets);
    enum gd_status status = gd_control_afford(search->control, bytes);
    if (status) return status;
    search->count = count;
    search->places = malloc(count * sizeof *search->places);
    search->jets = malloc(count * sizeof *search->jets);
    if (!search->places || !search->jets) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < count; i++) search->places[i] = search->ends[0];
    status = place_path(search);
    if (status) return status;
    const struct gd_subdivision *surface = gd_limit_mesh_surface(search->fine);
    status = gd_limit_evaluate_many(surface, &(struct gd_limit_places){search->places, count},
                                    search->control, search->jets, search->detail);
    for (uint32_t i = 0; i < count && !status; i++)
        if (is_on_crease(surface, &search->places[i])) search->jets[i].normal.x = NAN;
    return status;
}

/* --- on the surface --------------------------------------------------------------------------- */

/* Returns the length of a cubic curve over a chord, up to the fourth order. a and b are the curve's
 * slopes against the chord at its ends. */
static double arc(double chord, double a, double b)
{
    return chord * (1 + (2 * a * a - a * b + 2 * b * b) / 30);
}

/* Returns the slope of the surface against a chord, computed from the normal, or 0 if there is no
 * normal. */
static double subdiv_shortest_slope_at(const struct gd_limit_jet *jet, struct gd_vec3 way,
                                       double chord)
{
    return isnan(jet->normal.x) ? 0 : -gd_vec3_dot(jet->normal, way) / chord;
}

/* Returns the length of a curve on the surface between two jets. The curve is straight if it is
 * seen along the normal. */
static double arc_between(const struct gd_limit_jet *from, const struct gd_limit_jet *to)
{
    struct gd_vec3 way = gd_vec3_sub(to->position, from->position);
    double chord = gd_vec3_length(way);
    if (!(chord > 0)) return 0;
    double a = subdiv_shortest_slope_at(from, way, chord),
           b = subdiv_shortest_slope_at(to, way, chord);
    /* if only one end has a normal, the curve counts as an arc of a circle */
    if (isnan(from->normal.x)) a = -b;
    if (isnan(to->normal.x)) b = -a;
    return arc(chord, a, b);
}

/* Returns the length of a curve through three points, by extrapolation: if chords are halved, the
 * error decreases to a quarter. The extrapolation includes bends within the surface, for instance
 * at a boundary, which normals do not show. Without the normals at both ends, the three arcs differ
 * in accuracy and cannot be extrapolated. */
static double arc_by_way(const struct gd_limit_jet *jets)
{
    double halves = arc_between(&jets[0], &jets[1]) + arc_between(&jets[1], &jets[2]);
    if (isnan(jets[0].normal.x) || isnan(jets[2].normal.x)) return halves;
    return halves + (halves - arc_between(&jets[0], &jets[2])) / 3;
}

/* Returns the distance along the surface between an end of the path on the mesh and its place. */
static double shift_of_end(const struct search *search, bool is_last)
{
    const struct gd_path *path = &search->pair.path;
    const struct gd_limit_jet *jet = &search->jets[is_last ? search->count - 1 : 0];
    struct gd_vec3 end = gd_point_position(gd_limit_mesh_mesh(search->fine),
                                           &path->points[is_last ? path->count - 1 : 0]),
                   shift = gd_vec3_sub(end, jet->position);
    if (!isnan(jet->normal.x))
        shift = gd_vec3_sub(shift, gd_vec3_scale(jet->normal, gd_vec3_dot(shift, jet->normal)));
    return gd_vec3_length(shift);
}

static enum gd_status answer_lifted(const struct search *search, struct gd_limit_shortest *out)
{
    struct gd_limit_shortest made = {.mesh_distance = search->pair.distance,
                                     .step_count = search->count / 2 + 1};
    made.steps = malloc(made.step_count * sizeof *made.steps);
    if (!made.steps) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < made.step_count; i++) {
        if (i) made.distance += arc_by_way(&search->jets[2 * i - 2]);
        made.steps[i] = (struct gd_limit_step){search->places[2 * i], search->jets[2 * i].position,
                                               made.distance};
    }
    made.error_estimate = fabs(made.distance - made.mesh_distance) + shift_of_end(search, false) +
                          shift_of_end(search, true);
    *out = made;
    return GD_OK;
}

/* Replaces the projected path by the geodesic, unless the geodesic is longer by more than the known
 * error. */
static void prefer_geodesic(const struct search *search, struct gd_limit_geodesic *found,
                            struct gd_limit_shortest *out)
{
    struct gd_limit_path *path = &found->path;
    if (!found->converged || !(path->length <= out->distance + out->error_estimate)) {
        gd_limit_path_free(path);
        return;
    }
    free(out->steps);
    out->distance = path->length;
    out->error_estimate = found->error_estimate;
    out->relaxed = true;
    out->steps = path->steps;
    out->step_count = path->step_count;
    out->steps[path->step_count - 1].place = search->ends[1];
}

static enum gd_status subdiv_shortest_relax(const struct search *search,
                                            struct gd_limit_shortest *out)
{
    struct gd_limit_geodesic found;
    if (!(out->distance > 0)) return GD_OK;
    enum gd_status status = gd_limit_relax(gd_limit_mesh_surface(search->fine),
                                           &(struct gd_limit_places){search->places, search->count},
                                           search->control, &found, search->detail);
    /* the ends are too near to each other to define a direction, the start has no tangent plane, or
       tracing failed */
    if (status == GD_INVALID_ARGUMENT || status == GD_INTERNAL) return GD_OK;
    if (!status) prefer_geodesic(search, &found, out);
    return status;
}

static enum gd_status subdiv_shortest_find(struct search *search, struct gd_limit_shortest *out)
{
    enum gd_status status = search_mesh(search);
    if (!status && isinf(search->pair.distance)) {
        *out = (struct gd_limit_shortest){.distance = INFINITY, .mesh_distance = INFINITY};
        return GD_OK;
    }
    struct gd_limit_shortest made = {0};
    if (!status) status = lift(search);
    if (!status) status = answer_lifted(search, &made);
    if (!status) status = subdiv_shortest_relax(search, &made);
    if (status)
        gd_limit_shortest_free(&made);
    else
        *out = made;
    return status;
}

enum gd_status gd_limit_shortest_find(const struct gd_limit_mesh *fine,
                                      const struct gd_limit_point ends[2],
                                      const struct gd_control *control,
                                      struct gd_limit_shortest *out, struct gd_detail *detail)
{
    struct search search = {
        .fine = fine, .control = control, .detail = detail, .ends = {ends[0], ends[1]}};
    enum gd_status status = subdiv_shortest_find(&search, out);
    search_free(&search);
    return status;
}
