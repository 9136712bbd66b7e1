#include "proto/values/curve.h"

#include <stdio.h>
#include <stdlib.h>

#include "proto/json/decode.h"

void proto_curve_free(struct proto_curve *curve)
{
    proto_points_free(&curve->points);
    free(curve->vertices);
    proto_spline_free(curve->spline);
    free(curve->spline);
    *curve = (struct proto_curve){0};
}

void proto_located_curve_free(struct proto_located_curve *located)
{
    proto_located_points_free(&located->points);
    free(located->vertices);
    proto_located_spline_free(&located->located_spline);
    proto_spline_free(located->spline);
    free(located->spline);
    *located = (struct proto_located_curve){0};
}

/* --- from the request ------------------------------------------------------------------------- */

static bool decode_points(const json_t *value, struct proto_curve *curve,
                          struct proto_problem *problem)
{
    char place[PROTO_POINT_PLACE];
    const json_t *points = json_object_get(value, "points");
    snprintf(place, sizeof place, "%.*s/points", PROTO_POINT_PLACE - 8, curve->place);
    curve->kind = GD_CURVE_POINTS;
    if (json_is_array(points) && json_array_size(points) == 0)
        return proto_problem_refuse(problem, place, "a curve has at least one point");
    return proto_points_decode(&curve->points, points, place, PROTO_CURVE_POINTS, problem) &&
           proto_decode_flag(value, curve->place, "closed", &curve->closed, problem);
}

static bool check_vertices(const json_t *vertices, const char *place, struct proto_problem *problem)
{
    char list[PROTO_PLACE];
    size_t count = json_array_size(vertices); /* 0 if it is not an array */
    proto_place_of_member(list, place, "vertices");
    if (count == 0)
        return proto_problem_refuse(problem, list,
                                    "expected an array of vertex indices, one at least");
    return count <= PROTO_CURVE_VERTICES ||
           proto_problem_exceed(problem, list, PROTO_CURVE_VERTICES,
                                "a curve may have %d vertices at most", PROTO_CURVE_VERTICES);
}

static bool decode_vertices(const json_t *value, struct proto_curve *curve,
                            struct proto_problem *problem)
{
    const json_t *vertices = json_object_get(value, "vertices");
    curve->kind = GD_CURVE_VERTICES;
    if (!check_vertices(vertices, curve->place, problem)) return false;
    curve->vertex_count = (uint32_t)json_array_size(vertices);
    curve->vertices = malloc(curve->vertex_count * sizeof *curve->vertices);
    if (!curve->vertices) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    return proto_decode_indices(value, curve->place, "vertices", curve->vertex_count,
                                &curve->vertices->index, problem) &&
           proto_decode_flag(value, curve->place, "closed", &curve->closed, problem);
}

static bool decode_boundary(const json_t *value, struct proto_curve *curve,
                            struct proto_problem *problem)
{
    curve->kind = GD_CURVE_BOUNDARY;
    curve->closed = true;
    if (json_object_get(value, "closed"))
        return proto_problem_refuse_member(problem, curve->place, "closed",
                                           "a boundary is closed; leave \"closed\" out");
    return proto_decode_index(value, curve->place, "boundary", &curve->boundary, problem);
}

static bool decode_spline(const json_t *value, struct proto_curve *curve,
                          struct proto_problem *problem)
{
    char place[PROTO_POINT_PLACE];
    snprintf(place, sizeof place, "%.*s/spline", PROTO_POINT_PLACE - 8, curve->place);
    if (json_object_get(value, "closed"))
        return proto_problem_refuse_member(problem, curve->place, "closed",
                                           "whether it is closed is said in the spline itself");
    curve->spline = calloc(1, sizeof *curve->spline);
    if (!curve->spline) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    return proto_spline_decode(json_object_get(value, "spline"), place, true, curve->spline,
                               problem);
}

/* A form in which a request gives a curve, and its decode function. */
static const struct form {
    const char *member;
    bool (*decode)(const json_t *value, struct proto_curve *curve, struct proto_problem *problem);
} forms[] = {{"points", decode_points},
             {"vertices", decode_vertices},
             {"boundary", decode_boundary},
             {"spline", decode_spline}};

#define FORMS (sizeof forms / sizeof *forms)

/* Returns the form of the value, which must be unique; else NULL with the problem. */
static const struct form *find_form(const json_t *value, const char *pointer,
                                    struct proto_problem *problem)
{
    static const char *const members[] = {"points", "vertices", "boundary",
                                          "spline", "closed",   NULL};
    const struct form *found = NULL;
    size_t count = 0;
    if (!proto_decode_object(value, pointer, members, problem)) return NULL;
    for (size_t i = 0; i < FORMS; i++) {
        if (!json_object_get(value, forms[i].member)) continue;
        found = &forms[i];
        count++;
    }
    if (count == 1) return found;
    proto_problem_refuse(
        problem, pointer,
        "a curve has exactly one of \"points\", \"vertices\", \"boundary\" and \"spline\"");
    return NULL;
}

bool proto_curve_decode(const json_t *value, const char *pointer, struct proto_curve *out,
                        struct proto_problem *problem)
{
    struct proto_curve curve = {0};
    const struct form *form = find_form(value, pointer, problem);
    if (!form) return false;
    snprintf(curve.place, sizeof curve.place, "%s", pointer);
    if (!form->decode(value, &curve, problem)) {
        proto_curve_free(&curve);
        return false;
    }
    *out = curve;
    return true;
}

/* --- on the mesh ------------------------------------------------------------------------------ */

static bool locate_spline(const struct gd_mesh *mesh, struct proto_curve *curve,
                          struct proto_located_curve *out, struct proto_problem *problem)
{
    struct proto_located_curve located = {0};
    if (!proto_spline_locate(mesh, curve->spline, &located.located_spline, problem)) return false;
    snprintf(located.place, sizeof located.place, "%s", curve->spline->place);
    located.spline = curve->spline;
    curve->spline = NULL;
    *out = located;
    return true;
}

bool proto_curve_locate(const struct gd_mesh *mesh, struct proto_curve *curve,
                        struct proto_located_curve *out, struct proto_problem *problem)
{
    struct proto_located_curve located = {
        .request = {.kind = curve->kind, .closed = curve->closed, .boundary = curve->boundary}};
    if (curve->spline) return locate_spline(mesh, curve, out, problem);
    if (curve->kind == GD_CURVE_POINTS &&
        !proto_points_locate(mesh, &curve->points, &located.points, problem))
        return false;
    snprintf(located.place, sizeof located.place, "%s", curve->place);
    located.vertices = curve->vertices;
    located.request.points = located.points.points;
    located.request.vertices = located.vertices;
    located.request.count =
        curve->kind == GD_CURVE_POINTS ? located.points.count : curve->vertex_count;
    curve->vertices = NULL;
    curve->vertex_count = 0;
    *out = located;
    return true;
}

void proto_located_curve_return(struct proto_located_curve *located, struct proto_curve *curve)
{
    curve->vertices = located->vertices;
    curve->spline = located->spline;
    if (located->vertices) curve->vertex_count = located->request.count;
    located->vertices = NULL;
    located->spline = NULL;
    proto_located_curve_free(located);
}

enum gd_status proto_curve_resolve(const struct gd_mesh *mesh,
                                   const struct proto_located_curve *located,
                                   const struct gd_landmarks *landmarks,
                                   const struct gd_control *control, struct gd_curve *out,
                                   struct gd_detail *detail)
{
    if (!located->spline) {
        struct gd_curve_request request = located->request;
        request.landmarks = landmarks;
        return gd_curve_resolve(mesh, &request, control, out, detail);
    }
    struct gd_spline_request request = located->located_spline.request;
    request.landmarks = landmarks;
    request.sampling = &located->located_spline.sampling;
    return gd_spline_curve(mesh, &request, control, out, detail);
}

bool proto_curve_fail(const struct proto_located_curve *located, enum gd_status status,
                      struct gd_detail *detail, struct proto_problem *problem)
{
    if (located->spline) return proto_spline_fail(located->place, status, detail, problem);
    proto_problem_from_status(problem, status, detail);
    if (detail->text[0]) proto_problem_at(problem, located->place);
    return false;
}
