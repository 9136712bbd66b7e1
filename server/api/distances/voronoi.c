/* Voronoi: the diagram of a set, traced and written by a worker. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "proto/isoline.h"
#include "proto/path.h"
#include "proto/voronoi.h"
#include "server/query/field_query.h"

#define BYTES_AN_EDGE 48 /* of the mesh, while the bisectors are traced */
#define BYTES_A_TRACE ((size_t)1 << 20)
#define LABELS_SHARE  0.1 /* of the work */
#define TRACE_SHARE   0.7
#define PORTION       512 /* elements that are written between two looks at the control */
#define WHAT          "the answer"

struct voronoi {
    struct server_field_query field; /* first */
    double tolerance;
};

static const struct gd_mesh *mesh_of(const struct voronoi *voronoi)
{
    return voronoi->field.query.surface->mesh;
}

static enum gd_status pause_at(struct voronoi *voronoi, const struct gd_control *control,
                               double fraction)
{
    enum gd_status status = server_query_check_draft(&voronoi->field.query);
    return status ? status : gd_control_check(control, fraction);
}

/* --- labels ----------------------------------------------------------------------------------- */

static enum gd_status write_labels(struct voronoi *voronoi, const struct gd_field *field,
                                   uint32_t *labels, const struct gd_control *control)
{
    uint32_t count = gd_mesh_summary(mesh_of(voronoi))->index_count;
    enum gd_status status = gd_voronoi_labels(field, voronoi->field.set->members, labels);
    proto_voronoi_labels_begin(&voronoi->field.query.draft);
    for (uint32_t i = 0; i < count && !status; i++) {
        proto_voronoi_label(&voronoi->field.query.draft, labels[i]);
        if ((i + 1) % PORTION == 0) status = pause_at(voronoi, control, (double)i / count);
    }
    proto_voronoi_list_end(&voronoi->field.query.draft);
    return status;
}

static enum gd_status tell_labels(struct voronoi *voronoi, const struct gd_field *field,
                                  struct server_monitor *part)
{
    const struct gd_control control = server_exchange_control(part);
    size_t bytes = gd_mesh_summary(mesh_of(voronoi))->index_count * sizeof(uint32_t);
    /* and while they are found */
    enum gd_status status = server_query_take(&voronoi->field.query, 2 * bytes);
    if (status) return status;
    uint32_t *labels = malloc(bytes);
    status = labels ? write_labels(voronoi, field, labels, &control) : GD_NO_MEMORY;
    free(labels);
    server_query_give(&voronoi->field.query, 2 * bytes);
    return status;
}

/* --- bisectors -------------------------------------------------------------------------------- */

struct tracing {
    const struct gd_field *field;
    const uint32_t *members; /* by seed */
    double tolerance;
    struct gd_voronoi *out;
};

static enum gd_status trace(void *user, const struct gd_control *control, size_t *kept)
{
    const struct tracing *wanted = user;
    enum gd_status status =
        gd_voronoi_trace(wanted->field, wanted->members, wanted->tolerance, control, wanted->out);
    if (!status) *kept = wanted->out->bytes;
    return status;
}

static enum gd_status trace_bisectors(struct voronoi *voronoi, const struct gd_field *field,
                                      struct server_monitor *part, struct gd_voronoi *out)
{
    struct tracing wanted = {field, voronoi->field.set->members, voronoi->tolerance, out};
    size_t grant = BYTES_A_TRACE + gd_mesh_summary(mesh_of(voronoi))->edges * (size_t)BYTES_AN_EDGE;
    return server_query_call(&voronoi->field.query, part, trace, &wanted, grant);
}

static enum gd_status write_bisector(struct voronoi *voronoi, const struct gd_bisector *bisector,
                                     const struct gd_control *control, double fraction)
{
    enum proto_geometry geometry = voronoi->field.query.options.geometry;
    struct proto_writer *writer = &voronoi->field.query.draft;
    enum gd_status status = GD_OK;
    proto_bisector_begin(writer, bisector);
    if (geometry != PROTO_GEOMETRY_NONE) {
        proto_bisector_points_begin(writer);
        for (uint32_t i = 0; i < bisector->point_count && !status; i++) {
            proto_path_point_encode(writer, mesh_of(voronoi), &bisector->points[i], geometry);
            if ((i + 1) % PORTION == 0) status = pause_at(voronoi, control, fraction);
        }
        proto_voronoi_list_end(writer);
    }
    proto_bisector_end(writer);
    return status ? status : pause_at(voronoi, control, fraction);
}

static enum gd_status write_bisectors(struct voronoi *voronoi, const struct gd_voronoi *found,
                                      struct server_monitor *part)
{
    const struct gd_control control = server_exchange_control(part);
    enum gd_status status = GD_OK;
    proto_voronoi_bisectors_begin(&voronoi->field.query.draft);
    for (uint32_t i = 0; i < found->bisector_count && !status; i++)
        status = write_bisector(voronoi, &found->bisectors[i], &control,
                                (double)i / found->bisector_count);
    proto_voronoi_list_end(&voronoi->field.query.draft);
    return status;
}

static bool admit(const struct voronoi *voronoi, const struct gd_voronoi *found,
                  struct proto_problem *problem)
{
    uint64_t points = 0;
    for (uint32_t i = 0; i < found->bisector_count; i++) points += found->bisectors[i].point_count;
    if (voronoi->field.query.options.geometry == PROTO_GEOMETRY_NONE ||
        points <= PROTO_VORONOI_POINTS)
        return true;
    proto_problem_set(problem, PROTO_PROBLEM_TOO_LARGE,
                      "the bisectors have %llu points, more than %d; ask for a larger tolerance, "
                      "fewer members, or "
                      "geometry=none",
                      (unsigned long long)points, PROTO_VORONOI_POINTS);
    return proto_problem_limit(problem, PROTO_VORONOI_POINTS);
}

static bool tell_bisectors(struct voronoi *voronoi, const struct gd_field *field,
                           const struct server_monitor *part, struct proto_problem *problem)
{
    struct server_monitor first = server_monitor_portion(part, 0, TRACE_SHARE),
                          second = server_monitor_portion(part, TRACE_SHARE, 1 - TRACE_SHARE);
    struct gd_voronoi found;
    enum gd_status status = trace_bisectors(voronoi, field, &first, &found);
    if (status) {
        server_query_fail(&voronoi->field.query, status, "the diagram", problem);
        return false;
    }
    bool ok = admit(voronoi, &found, problem);
    if (ok) status = write_bisectors(voronoi, &found, &second);
    if (status) server_query_fail(&voronoi->field.query, status, WHAT, problem);
    server_query_give(&voronoi->field.query, found.bytes);
    gd_voronoi_free(&found);
    return ok && !status;
}

/* --- the steps -------------------------------------------------------------------------------- */

static enum server_query_turn answer(struct server_field_query *query, const struct gd_field *field,
                                     struct server_monitor *part, struct proto_problem *problem)
{
    struct voronoi *voronoi = (struct voronoi *)query;
    uint32_t fields = query->query.options.fields;
    struct server_monitor first = server_monitor_portion(part, 0, LABELS_SHARE),
                          second = server_monitor_portion(part, LABELS_SHARE, 1 - LABELS_SHARE);
    enum gd_status status = GD_OK;
    proto_voronoi_begin(&voronoi->field.query.draft);
    if (fields & PROTO_VORONOI_FIELD_LABELS) status = tell_labels(voronoi, field, &first);
    if (status) return server_query_fail(&query->query, status, WHAT, problem);
    if (fields & PROTO_VORONOI_FIELD_BISECTORS && !tell_bisectors(voronoi, field, &second, problem))
        return SERVER_QUERY_FAILED;
    proto_voronoi_end(&voronoi->field.query.draft);
    return server_query_end_draft(&query->query, GD_OK, WHAT, problem);
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct voronoi *voronoi = (struct voronoi *)query;
    struct proto_voronoi wanted;
    if (!proto_voronoi_decode(document, &wanted, problem)) return false;
    /* their polylines are as fine */
    const struct proto_isolines lines = {.tolerance = wanted.tolerance};
    voronoi->tolerance = proto_isolines_tolerance(&lines, query->surface->mesh);
    voronoi->field.answer = answer;
    bool ok = server_field_query_of_set(&voronoi->field, &wanted.set, 0, problem);
    proto_set_free(&wanted.set);
    return ok;
}

static const struct server_query_kind voronoi_kind = {.name = "voronoi",
                                                      .size = sizeof(struct voronoi),
                                                      .fields = proto_voronoi_fields,
                                                      .decode = decode,
                                                      .glance = server_field_query_glance,
                                                      .join = server_field_query_join,
                                                      .solve = server_field_query_solve,
                                                      .release = server_field_query_release};

void server_handle_voronoi(struct server_exchange *exchange)
{
    server_query_handle(exchange, &voronoi_kind);
}
