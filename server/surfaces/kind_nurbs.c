/* See kind.h: NURBS and other parametric surfaces. A surface that has no tessellation is kept all
 * the same: it can be evaluated, and the operations that need one say why there is none. */
#include <stdio.h>
#include <stdlib.h>

#include "proto/decode.h"
#include "server/surfaces/build.h"
#include "server/store/kind.h"
#include "server/surfaces/nurbs_surface.h"

const struct server_nurbs *server_nurbs_of(const struct server_surface *surface)
{
    return surface->object;
}

/* --- options ---------------------------------------------------------------------------------- */

static bool read_options(const struct proto_parameters *parameters, const struct server_file *file,
                         char text[SERVER_OPTIONS], struct proto_problem *problem)
{
    struct proto_nurbs_options options;
    (void)file;
    if (!proto_nurbs_options_parse(parameters, &options, problem)) return false;
    snprintf(text, SERVER_OPTIONS, "format=json%s%s", options.has_convention ? "&convention=" : "",
             options.has_convention ? proto_nurbs_conventions[options.convention] : "");
    return true;
}

/* Of a record, whose options were read before. */
static struct proto_nurbs_options options_of(const struct server_record *record)
{
    struct server_options options;
    struct proto_nurbs_options out = {0};
    struct proto_problem problem;
    if (!server_options_split(record->options, &options)) return out;
    const struct proto_parameters parameters = server_options_parameters(&options);
    (void)proto_nurbs_options_parse(&parameters, &out, &problem);
    return out;
}

/* --- building --------------------------------------------------------------------------------- */

#define READ_SHARE         0.2
#define TESSELLATION_BYTES ((size_t)8 << 20) /* that most take while they are built */
#define GROWTH             4

/* One build under way. */
struct making {
    const struct server_builder *builder;
    const struct server_record *record;
    struct server_nurbs *nurbs;
    size_t surface_bytes, tessellation_bytes; /* in SERVER_BUDGET_FLIGHT */
};

/* The status that goes with a problem of reading. */
static enum gd_status status_of(const struct proto_problem *problem)
{
    switch (problem->code) {
    case PROTO_PROBLEM_INSUFFICIENT_MEMORY:
        return GD_NO_MEMORY;
    case PROTO_PROBLEM_DEADLINE_EXCEEDED:
        return GD_DEADLINE;
    default:
        return GD_SYNTAX;
    }
}

static enum gd_status read_surface(struct making *making, const void *bytes,
                                   struct proto_problem *problem)
{
    const struct server_builder *builder = making->builder;
    struct server_build_part part = {builder, 0, READ_SHARE};
    const struct gd_control control = server_build_control(&part, 0);
    struct proto_nurbs_options options = options_of(making->record);
    struct server_nurbs *nurbs = making->nurbs;
    size_t size = (size_t)making->record->size, cost = proto_decode_cost(bytes, size);
    enum gd_status status = server_build_take(builder, making->record, cost, problem);
    if (status) return status;
    options.control = &control;
    bool ok = proto_nurbs_read(bytes, size, &options, &nurbs->surface, &nurbs->form, problem);
    making->surface_bytes = ok ? gd_parametric_memsize(nurbs->surface) : 0;
    server_budget_adjust(builder->budget, SERVER_BUDGET_FLIGHT, cost, making->surface_bytes);
    return ok ? GD_OK : status_of(problem);
}

static enum gd_status tessellate_within(struct making *making, size_t cost)
{
    struct server_build_part part = {making->builder, READ_SHARE, 1 - READ_SHARE};
    const struct gd_control control = server_build_control(&part, cost);
    struct server_nurbs *nurbs = making->nurbs;
    enum gd_status status =
        gd_tessellation_build(nurbs->surface, NULL, &control, &nurbs->tessellation, &nurbs->detail);
    making->tessellation_bytes = status ? 0 : gd_tessellation_memsize(nurbs->tessellation);
    server_budget_adjust(making->builder->budget, SERVER_BUDGET_FLIGHT, cost,
                         making->tessellation_bytes);
    return status;
}

/* Does the status tell of the surface, and not of what happened to be while it was looked at? */
static bool is_lasting(enum gd_status status)
{
    return status != GD_NO_MEMORY && status != GD_BUDGET && status != GD_CANCELLED &&
           status != GD_DEADLINE;
}

/* With four times as much memory as long as that was too little and more can be had. */
static enum gd_status tessellate(struct making *making, struct proto_problem *problem)
{
    enum gd_status status = GD_BUDGET;
    for (size_t cost = TESSELLATION_BYTES; status == GD_BUDGET; cost *= GROWTH) {
        status = server_build_take(making->builder, making->record, cost, problem);
        if (status) return status;
        status = tessellate_within(making, cost);
    }
    if (status && !is_lasting(status))
        return server_build_refuse(making->builder, making->record, status, &making->nurbs->detail,
                                   problem);
    making->nurbs->refusal = status;
    return GD_OK;
}

static void release(void *object)
{
    struct server_nurbs *nurbs = object;
    gd_tessellation_release(nurbs->tessellation);
    gd_parametric_release(nurbs->surface);
    free(nurbs);
}

static enum gd_status build(const struct server_builder *builder,
                            const struct server_record *record, const void *bytes, void **object,
                            size_t *size, struct proto_problem *problem)
{
    struct making making = {
        .builder = builder, .record = record, .nurbs = calloc(1, sizeof *making.nurbs)};
    if (!making.nurbs) return server_build_refuse(builder, record, GD_NO_MEMORY, NULL, problem);
    enum gd_status status = server_build_take(builder, record, sizeof *making.nurbs, problem);
    size_t own = status ? 0 : sizeof *making.nurbs;
    if (!status) status = read_surface(&making, bytes, problem);
    if (!status) status = tessellate(&making, problem);
    size_t held = own + making.surface_bytes + making.tessellation_bytes;
    if (status) {
        release(making.nurbs);
        server_budget_give(builder->budget, SERVER_BUDGET_FLIGHT, held);
        return status;
    }
    *object = making.nurbs;
    *size = held;
    return GD_OK;
}

/* --- describing ------------------------------------------------------------------------------- */

static void describe(struct proto_writer *writer, const struct server_surface *surface)
{
    const struct server_record *record = surface->record;
    const struct server_nurbs *nurbs = server_nurbs_of(surface);
    const struct gd_tessellation *tessellation = nurbs->tessellation;
    const struct proto_nurbs_description description = {
        .name = record->name,
        .sha256 = record->sha256,
        .created = record->created,
        .etag = record->etag,
        .memory_bytes = surface->bytes,
        .form = nurbs->form,
        .surface = nurbs->surface,
        .seeding_faces =
            tessellation ? gd_mesh_summary(gd_tessellation_mesh(tessellation))->faces : 0,
        .obstacle = tessellation ? NULL : gd_status_name(nurbs->refusal),
    };
    proto_nurbs_encode(writer, &description);
}

const struct server_kind server_kind_nurbs = {
    .word = "nurbs",
    .plural = "nurbs",
    .noun = "NURBS surface",
    .read_options = read_options,
    .build = build,
    .release = release,
    .describe = describe,
};
