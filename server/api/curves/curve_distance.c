/* Curve distance: from the field of one curve how far another one is; for the Hausdorff distance
 * then the other way round. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "proto/curve_distance.h"
#include "server/query/field_query.h"
#include "server/query/set_resolve.h"
#include "server/http/reply.h"

#define SETS_SHARE 0.2 /* of the work, to put the curves on the mesh */
#define WHAT       "the curves"

enum { A, B };

struct curves {
    struct server_field_query field; /* first */
    struct proto_curve_distance wanted;
    struct proto_located_set *set[2];
    struct gd_curve curve[2];
    int source;                        /* the curve of whose field the turn is */
    struct gd_curve_distance found[2]; /* by the field's curve */
};

/* --- the curves ------------------------------------------------------------------------------- */

/* A curve again from its seeds: points, and behind each its segment but for the last of an open
 * one. */
static bool curve_of(const struct proto_located_set *set, struct gd_curve *out)
{
    struct gd_curve curve = {.count = (set->seed_count + 1) / 2,
                             .closed = set->seed_count % 2 == 0};
    curve.points = malloc(curve.count * sizeof *curve.points);
    for (uint32_t i = 0; i < curve.count && curve.points; i++)
        curve.points[i] = set->seeds[2 * i].point;
    *out = curve;
    return curve.points;
}

static bool resolve(struct curves *curves, int which, struct proto_problem *problem)
{
    struct server_query *query = &curves->field.query;
    struct server_monitor part =
        server_query_monitor(query, which * SETS_SHARE / 2, SETS_SHARE / 2);
    const struct proto_set *set = which == A ? &curves->wanted.a : &curves->wanted.b;
    if (!server_set_resolve(query, &part, set, &curves->set[which], problem)) return false;
    return curve_of(curves->set[which], &curves->curve[which]) ||
           proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
}

static bool prepare(struct server_field_query *query, struct proto_problem *problem)
{
    struct curves *curves = (struct curves *)query;
    if (!resolve(curves, A, problem) || !resolve(curves, B, problem)) return false;
    proto_curve_distance_free(&curves->wanted);
    server_field_query_of_located(query, curves->set[A], 0);
    return true;
}

/* --- the answer ------------------------------------------------------------------------------- */

static enum server_query_turn answer(struct server_field_query *query, const struct gd_field *field,
                                     struct server_monitor *part, struct proto_problem *problem)
{
    struct curves *curves = (struct curves *)query;
    const struct gd_control control = server_exchange_control(part);
    int source = curves->source;
    const struct gd_curve *of = &curves->curve[source], *other = &curves->curve[!source];
    enum gd_status status =
        curves->wanted.hausdorff
            ? gd_curve_farthest(field, of, other, &control, &curves->found[source])
            : gd_curve_distance(field, of, other, &control, &curves->found[source]);
    if (status) return server_query_fail(&query->query, status, WHAT, problem);
    if (!curves->wanted.hausdorff || source == B) return SERVER_QUERY_DONE;
    curves->source = B;
    server_field_query_of_located(query, curves->set[B], 0);
    return SERVER_QUERY_AGAIN;
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct curves *curves = (struct curves *)query;
    curves->field.prepare = prepare;
    curves->field.answer = answer;
    return proto_curve_distance_decode(document, &curves->wanted, problem);
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct curves *curves = (const struct curves *)query;
    if (curves->wanted.hausdorff)
        proto_hausdorff_encode(writer, query->surface->mesh, &curves->found[B], &curves->found[A],
                               &query->options);
    else
        proto_curve_distance_encode(writer, query->surface->mesh, &curves->found[A],
                                    &query->options);
}

static void release(struct server_query *query)
{
    struct curves *curves = (struct curves *)query;
    for (int i = 0; i < 2; i++) {
        gd_curve_distance_free(&curves->found[i]);
        gd_curve_free(&curves->curve[i]);
        free(curves->set[i]);
    }
    proto_curve_distance_free(&curves->wanted);
    server_field_query_release(query);
}

const struct server_query_kind server_query_curve_distance = {.name = "curve-distance",
                                                              .size = sizeof(struct curves),
                                                              .fields = proto_curve_distance_fields,
                                                              .decode = decode,
                                                              .glance = server_field_query_glance,
                                                              .join = server_field_query_join,
                                                              .solve = server_field_query_solve,
                                                              .encode = encode,
                                                              .release = release};

void server_handle_curve_distance(struct server_exchange *exchange)
{
    server_query_handle(exchange, &server_query_curve_distance);
}
