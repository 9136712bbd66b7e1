/* Answers queries for the distance between two curves. The distance is computed from the field of
 * one curve; the Hausdorff distance also needs the field of the other curve. */
#include "server/query/handlers.h"

#include <math.h>
#include <stdlib.h>

#include "proto/queries/curves.h"
#include "server/query/query.h"

#define SETS_SHARE 0.2 /* fraction of the query's progress for locating the curves */

enum { A, B };

struct curves_query {
    struct server_query query; /* must be the first member */
    struct proto_curve_distance wanted;
    struct proto_located_set *set[2];
    struct gd_curve curve[2];
    int source;                        /* the curve whose field is being used */
    struct gd_curve_distance found[2]; /* entry i: the result from the field of curve i */
};

static bool curves_decode(struct server_query *query, const json_t *document)
{
    return proto_curve_distance_decode(document, &((struct curves_query *)query)->wanted,
                                       query->problem);
}

/* Converts the seeds of a set to a curve. Each point is followed by its segment, except the last
 * point of an open curve. */
static bool curve_of_set(const struct proto_located_set *set, struct gd_curve *out)
{
    struct gd_curve curve = {.count = (set->seed_count + 1) / 2,
                             .closed = set->seed_count % 2 == 0};
    curve.points = malloc(curve.count * sizeof *curve.points);
    for (uint32_t i = 0; i < curve.count && curve.points; i++)
        curve.points[i] = set->seeds[2 * i].point;
    *out = curve;
    return curve.points;
}

static bool curves_prepare(struct server_query *query)
{
    struct curves_query *curves = (struct curves_query *)query;
    const struct proto_set *wanted[] = {&curves->wanted.a, &curves->wanted.b};
    for (int i = A; i <= B; i++) {
        struct server_monitor part =
            server_query_monitor(query, i * SETS_SHARE / 2, SETS_SHARE / 2);
        if (!server_query_locate_set(query, &part, wanted[i], &curves->set[i])) return false;
        if (!curve_of_set(curves->set[i], &curves->curve[i]))
            return proto_problem_from_status(query->problem, GD_NO_MEMORY, NULL);
    }
    proto_curve_distance_free(&curves->wanted);
    server_field_query_of_located(query, curves->set[A], 0);
    if (curves->wanted.hausdorff) query->field.next = curves->set[B];
    return true;
}

static enum server_query_turn curves_answer(struct server_query *query,
                                            const struct gd_field *field)
{
    struct curves_query *curves = (struct curves_query *)query;
    struct server_monitor monitor = server_query_monitor(query, 0, 1);
    const struct gd_control control = server_exchange_control(&monitor);
    int source = curves->source;
    const struct gd_curve *of = &curves->curve[source], *other = &curves->curve[!source];
    enum gd_status status =
        curves->wanted.hausdorff
            ? gd_curve_farthest(field, of, other, &control, &curves->found[source])
            : gd_curve_distance(field, of, other, &control, &curves->found[source]);
    if (status || !curves->wanted.hausdorff || source == B)
        return server_query_end_draft(query, status, "the curves");
    curves->source = B;
    query->field.next = NULL;
    server_field_query_of_located(query, curves->set[B], 0);
    return SERVER_QUERY_AGAIN;
}

static void curves_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct curves_query *curves = (const struct curves_query *)query;
    if (curves->wanted.hausdorff)
        proto_hausdorff_encode(writer, query->surface->mesh, &curves->found[B], &curves->found[A],
                               &query->options);
    else
        proto_curve_distance_encode(writer, query->surface->mesh, &curves->found[A],
                                    &query->options);
}

/* Lists the arrays of the answer. They have no line if there is no path. */
static bool curves_list_arrays(struct server_query *query)
{
    const struct curves_query *curves = (const struct curves_query *)query;
    const struct gd_curve_distance *found = curves->found, *told = &found[A];
    if (curves->wanted.hausdorff && found[B].distance > found[A].distance) told = &found[B];
    const struct gd_point *points = isfinite(told->distance) ? told->path.points : NULL;
    if (!server_query_list_line(query, points, told->path.count)) return false;
    server_arrays_add_numbers(&query->arrays, "distance", 0, 1, &told->distance);
    return true;
}

static void curves_release(struct server_query *query)
{
    struct curves_query *curves = (struct curves_query *)query;
    for (int i = A; i <= B; i++) {
        gd_curve_distance_free(&curves->found[i]);
        gd_curve_free(&curves->curve[i]);
        free(curves->set[i]);
    }
    proto_curve_distance_free(&curves->wanted);
}

const struct server_query_kind server_query_curve_distance = {.name = "curve-distance",
                                                              .size = sizeof(struct curves_query),
                                                              .decode = curves_decode,
                                                              .prepare = curves_prepare,
                                                              .answer = curves_answer,
                                                              .encode = curves_encode,
                                                              .list_arrays = curves_list_arrays,
                                                              .release = curves_release};
