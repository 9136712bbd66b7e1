/* See kind.h: meshes, whose memory is taken for the polygons while they are read, and for the mesh
 * while it is built. */
#include <stdio.h>

#include "gd/io.h"
#include "server/surfaces/build.h"
#include "server/store/kind.h"

/* --- options ---------------------------------------------------------------------------------- */

/* What is not asked for is not named, so that options that are added leave the tags of others as
 * they were. */
static void write_options(const struct proto_mesh_options *options, char text[SERVER_OPTIONS])
{
    const struct gd_mesh_options *build = &options->build;
    int size = snprintf(text, SERVER_OPTIONS, "format=%s&triangulate=%s%s",
                        gd_format_name(options->format), build->refuse_polygons ? "false" : "true",
                        build->repair_split ? "&repair=split" : "");
    if (build->weld)
        snprintf(text + size, SERVER_OPTIONS - (size_t)size, "&weld=%.17g", build->weld_tolerance);
}

static bool read_options(const struct proto_parameters *parameters, const struct server_file *file,
                         char text[SERVER_OPTIONS], struct proto_problem *problem)
{
    struct proto_mesh_options options;
    if (!proto_mesh_options_parse(parameters, &options, problem)) return false;
    if (file)
        options.format =
            proto_mesh_upload_format(&options, file->bytes, file->size, file->content_type);
    write_options(&options, text);
    return true;
}

/* Of a record, whose options were read before. */
static struct proto_mesh_options options_of(const struct server_record *record)
{
    struct server_options options;
    struct proto_mesh_options out = {.format = GD_FORMAT_ANY};
    struct proto_problem problem;
    if (!server_options_split(record->options, &options)) return out;
    const struct proto_parameters parameters = server_options_parameters(&options);
    (void)proto_mesh_options_parse(&parameters, &out, &problem);
    return out;
}

/* --- building --------------------------------------------------------------------------------- */

#define READ_SHARE 0.2 /* of the whole work, as measured with OBJ text of 1.3M faces */

/* One build under way. */
struct making {
    const struct server_builder *builder;
    const struct server_record *record;
    struct proto_mesh_options options;
    struct gd_polygons polygons;
    struct gd_mesh *mesh;
    size_t polygon_bytes, mesh_bytes; /* in SERVER_BUDGET_FLIGHT */
};

static size_t polygons_size(const struct gd_polygons *polygons)
{
    size_t first = polygons->first ? polygons->polygon_count + (size_t)1 : 0;
    return polygons->position_count * sizeof *polygons->positions +
           (gd_polygons_corner_count(polygons) + first) * sizeof *polygons->corners;
}

static enum gd_status read_polygons(struct making *making, const void *bytes,
                                    struct proto_problem *problem)
{
    const struct server_builder *builder = making->builder;
    struct server_build_part part = {builder, 0, READ_SHARE};
    const struct gd_control control = server_build_control(&part, 0);
    const struct gd_read_limits limits = {.max_faces = builder->max_faces, .control = &control};
    struct gd_detail detail = {0};
    size_t size = (size_t)making->record->size;
    size_t cost = gd_read_cost(bytes, size, making->options.format, &limits);
    enum gd_status status = server_build_take(builder, making->record, cost, problem);
    if (status) return status;
    status =
        gd_read_polygons(bytes, size, making->options.format, &limits, &making->polygons, &detail);
    making->polygon_bytes = status ? 0 : polygons_size(&making->polygons);
    server_budget_adjust(builder->budget, SERVER_BUDGET_FLIGHT, cost, making->polygon_bytes);
    return status ? server_build_refuse(builder, making->record, status, &detail, problem) : GD_OK;
}

static uint64_t triangle_count(const struct gd_polygons *polygons)
{
    return gd_polygons_corner_count(polygons) - UINT64_C(2) * polygons->polygon_count;
}

/* How many copies of vertices a repair makes shows on the way: nearly always few, but at most one a
 * corner. Then the mesh is built once more, with as much as that may take, or all that can be had.
 */
static size_t repair_cost(const struct making *making)
{
    uint64_t triangles = triangle_count(&making->polygons);
    size_t most = gd_mesh_build_cost(triangles, making->polygons.position_count + 3 * triangles);
    size_t available = server_budget_available(making->builder->budget);
    return most < available ? most : available;
}

static enum gd_status build_within(struct making *making, size_t cost, struct gd_detail *detail)
{
    struct server_build_part part = {making->builder, READ_SHARE, 1 - READ_SHARE};
    const struct gd_control control = server_build_control(&part, cost);
    enum gd_status status =
        gd_mesh_build(&making->polygons, &making->options.build, &control, &making->mesh, detail);
    making->mesh_bytes = status ? 0 : gd_mesh_memsize(making->mesh);
    server_budget_adjust(making->builder->budget, SERVER_BUDGET_FLIGHT, cost, making->mesh_bytes);
    return status;
}

static enum gd_status build_mesh(struct making *making, struct proto_problem *problem)
{
    struct gd_detail detail = {0};
    size_t cost =
        gd_mesh_build_cost(triangle_count(&making->polygons), making->polygons.position_count);
    enum gd_status status = server_build_take(making->builder, making->record, cost, problem);
    if (status) return status;
    status = build_within(making, cost, &detail);
    size_t more = status == GD_BUDGET ? repair_cost(making) : 0;
    if (more > cost) {
        status = server_build_take(making->builder, making->record, more, problem);
        if (status) return status;
        status = build_within(making, more, &detail);
    }
    return status ? server_build_refuse(making->builder, making->record, status, &detail, problem)
                  : GD_OK;
}

static enum gd_status build(const struct server_builder *builder,
                            const struct server_record *record, const void *bytes, void **object,
                            size_t *size, struct proto_problem *problem)
{
    struct making making = {.builder = builder, .record = record, .options = options_of(record)};
    enum gd_status status = read_polygons(&making, bytes, problem);
    if (!status) status = build_mesh(&making, problem);
    gd_polygons_free(&making.polygons);
    server_budget_give(builder->budget, SERVER_BUDGET_FLIGHT, making.polygon_bytes);
    if (status) return status;
    *object = making.mesh;
    *size = making.mesh_bytes;
    return GD_OK;
}

static void release(void *object)
{
    gd_mesh_release(object);
}

/* --- describing ------------------------------------------------------------------------------- */

static void describe(struct proto_writer *writer, const struct server_surface *surface)
{
    const struct server_record *record = surface->record;
    const struct proto_mesh_description description = {
        .name = record->name,
        .sha256 = record->sha256,
        .created = record->created,
        .etag = record->etag,
        .fields_cached = server_mesh_cache_count(surface->fields),
        .memory_bytes = surface->bytes,
        .mesh = surface->mesh,
    };
    proto_mesh_encode(writer, &description);
}

const struct server_kind server_kind_mesh = {
    .word = "mesh",
    .plural = "meshes",
    .noun = "mesh",
    .read_options = read_options,
    .build = build,
    .release = release,
    .describe = describe,
    .shorten = proto_mesh_shorten,
};
