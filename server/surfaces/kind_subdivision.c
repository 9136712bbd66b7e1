/* See kind.h: subdivision surfaces. */
#include <stdio.h>
#include <stdlib.h>

#include "proto/mesh.h"
#include "proto/subdivision.h"
#include "proto/decode.h"
#include "server/surfaces/build.h"
#include "server/store/kind.h"
#include "server/surfaces/subdivision_surface.h"

struct server_subdivision *server_subdivision_of(const struct server_surface *surface)
{
    return surface->object;
}

/* --- options ---------------------------------------------------------------------------------- */

static bool read_options(const struct proto_parameters *parameters, const struct server_file *file,
                         char text[SERVER_OPTIONS], struct proto_problem *problem)
{
    struct proto_subdivision_options options;
    if (!proto_subdivision_options_parse(parameters, &options, problem)) return false;
    const struct proto_mesh_options said = {.format = options.format};
    if (file)
        options.format =
            proto_mesh_upload_format(&said, file->bytes, file->size, file->content_type);
    snprintf(text, SERVER_OPTIONS, "format=%s%s%s", gd_format_name(options.format),
             options.has_scheme ? "&scheme=" : "",
             options.has_scheme ? proto_subdivision_schemes[options.scheme] : "");
    return true;
}

/* Of a record, whose options were read before. */
static struct proto_subdivision_options options_of(const struct server_record *record)
{
    struct server_options options;
    struct proto_subdivision_options out = {.format = GD_FORMAT_ANY};
    struct proto_problem problem;
    if (!server_options_split(record->options, &options)) return out;
    const struct proto_parameters parameters = server_options_parameters(&options);
    (void)proto_subdivision_options_parse(&parameters, &out, &problem);
    return out;
}

/* --- building --------------------------------------------------------------------------------- */

/* bytes that reading takes at most for each byte of a file that is no JSON */
#define READ_FACTOR    33
#define READ_SHARE     0.5
#define BYTES_A_CORNER 400 /* that most take while the surface is made */
#define BYTES_A_MAKING ((size_t)1 << 20)
#define GROWTH         4

/* One build under way. */
struct making {
    const struct server_builder *builder;
    const struct server_record *record;
    struct gd_control_mesh control_mesh;
    enum gd_scheme scheme;
    struct server_subdivision *made;
    size_t read_bytes, surface_bytes; /* in SERVER_BUDGET_FLIGHT */
};

static size_t control_mesh_size(const struct gd_control_mesh *mesh)
{
    const struct gd_polygons *polygons = &mesh->polygons;
    size_t first = polygons->first ? polygons->polygon_count + (size_t)1 : 0;
    return polygons->position_count * sizeof *polygons->positions +
           (gd_polygons_corner_count(polygons) + first) * sizeof *polygons->corners +
           mesh->crease_count * sizeof *mesh->creases + mesh->corner_count * sizeof *mesh->corners;
}

/* The status that goes with a problem of reading. */
static enum gd_status status_of(const struct proto_problem *problem)
{
    switch (problem->code) {
    case PROTO_PROBLEM_INSUFFICIENT_MEMORY:
        return GD_NO_MEMORY;
    case PROTO_PROBLEM_DEADLINE_EXCEEDED:
        return GD_DEADLINE;
    case PROTO_PROBLEM_DRAINING:
        return GD_CANCELLED;
    default:
        return GD_SYNTAX;
    }
}

static enum gd_status read_file(struct making *making, const void *bytes,
                                struct proto_problem *problem)
{
    const struct server_builder *builder = making->builder;
    struct server_build_part part = {builder, 0, READ_SHARE};
    const struct gd_control control = server_build_control(&part, 0);
    const struct gd_read_limits limits = {.max_faces = builder->max_faces, .control = &control};
    const struct proto_subdivision_options options = options_of(making->record);
    size_t size = (size_t)making->record->size;
    size_t cost =
        options.format == GD_FORMAT_JSON ? proto_decode_cost(bytes, size) : size * READ_FACTOR;
    /* of glTF, which may place a mesh many times */
    size_t placed = gd_read_cost(bytes, size, options.format, &limits);
    if (placed > cost) cost = placed;
    enum gd_status status = server_build_take(builder, making->record, cost, problem);
    if (status) return status;
    bool ok = proto_subdivision_read(bytes, size, &options, &limits, &making->control_mesh,
                                     &making->scheme, problem);
    making->read_bytes = ok ? control_mesh_size(&making->control_mesh) : 0;
    server_budget_adjust(builder->budget, SERVER_BUDGET_FLIGHT, cost, making->read_bytes);
    return ok ? GD_OK : status_of(problem);
}

static enum gd_status create_within(struct making *making, size_t cost, struct gd_detail *detail)
{
    struct server_build_part part = {making->builder, READ_SHARE, 1 - READ_SHARE};
    const struct gd_control control = server_build_control(&part, cost);
    enum gd_status status = gd_subdivision_create(&making->control_mesh, making->scheme, &control,
                                                  &making->made->surface, detail);
    making->surface_bytes = status ? 0 : gd_subdivision_memsize(making->made->surface);
    server_budget_adjust(making->builder->budget, SERVER_BUDGET_FLIGHT, cost,
                         making->surface_bytes);
    return status;
}

/* With four times as much memory as long as that was too little and more can be had. */
static enum gd_status create_surface(struct making *making, struct proto_problem *problem)
{
    struct gd_detail detail = {0};
    size_t corners = gd_polygons_corner_count(&making->control_mesh.polygons);
    enum gd_status status = GD_BUDGET;
    for (size_t cost = BYTES_A_MAKING + corners * BYTES_A_CORNER; status == GD_BUDGET;
         cost *= GROWTH) {
        status = server_build_take(making->builder, making->record, cost, problem);
        if (status) return status;
        status = create_within(making, cost, &detail);
    }
    if (status) proto_subdivision_refuse(status, &detail, problem);
    return status;
}

static void release(void *object)
{
    struct server_subdivision *subdivision = object;
    server_discretization_slot_close(&subdivision->slot);
    gd_subdivision_release(subdivision->surface);
    free(subdivision);
}

static enum gd_status build(const struct server_builder *builder,
                            const struct server_record *record, const void *bytes, void **object,
                            size_t *size, struct proto_problem *problem)
{
    struct making making = {
        .builder = builder, .record = record, .made = calloc(1, sizeof *making.made)};
    if (!making.made) return server_build_refuse(builder, record, GD_NO_MEMORY, NULL, problem);
    enum gd_status status = server_build_take(builder, record, sizeof *making.made, problem);
    size_t own = status ? 0 : sizeof *making.made;
    if (!status) status = read_file(&making, bytes, problem);
    if (!status) status = create_surface(&making, problem);
    gd_control_mesh_free(&making.control_mesh);
    server_budget_give(builder->budget, SERVER_BUDGET_FLIGHT, making.read_bytes);
    size_t held = own + making.surface_bytes;
    if (status) {
        release(making.made);
        server_budget_give(builder->budget, SERVER_BUDGET_FLIGHT, held);
        return status;
    }
    *object = making.made;
    *size = held;
    return GD_OK;
}

/* --- describing ------------------------------------------------------------------------------- */

static void describe(struct proto_writer *writer, const struct server_surface *surface)
{
    const struct server_record *record = surface->record;
    const struct proto_subdivision_description description = {
        .name = record->name,
        .sha256 = record->sha256,
        .created = record->created,
        .etag = record->etag,
        .memory_bytes = surface->bytes,
        .surface = server_subdivision_of(surface)->surface,
    };
    proto_subdivision_encode(writer, &description);
}

const struct server_kind server_kind_subdivision = {
    .word = "subdivision",
    .plural = "subdivisions",
    .noun = "subdivision surface",
    .read_options = read_options,
    .build = build,
    .release = release,
    .describe = describe,
};
