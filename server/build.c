/* See build.h. */
#include "server/build.h"

#include "gd/io.h"

#define READ_FACTOR 8 /* bytes that reading takes at most for each byte of the file */

#define READ_SHARE 0.2 /* of the whole work, as measured with OBJ text of 1.3M faces */

/* One build under way. */
struct build {
    const struct server_builder *builder;
    struct server_record *record;
    struct gd_polygons polygons;
    struct gd_mesh *mesh;
    size_t polygon_bytes, mesh_bytes; /* in SERVER_BUDGET_FLIGHT */
};

/* A part of the whole work, as the builder's control is told. */
struct part {
    const struct gd_control *whole;
    double begun, share;
};

static bool on_progress(void *user, double fraction)
{
    const struct part *part = user;
    const struct gd_control *whole = part->whole;
    return !whole->progress || whole->progress(whole->user, part->begun + part->share * fraction);
}

static struct gd_control control_of(struct part *part, size_t budget_bytes)
{
    return (struct gd_control){
        .budget_bytes = budget_bytes, .deadline_ns = part->whole->deadline_ns, .progress = on_progress, .user = part};
}

static enum gd_status refuse(const struct build *build, enum gd_status status, const struct gd_detail *detail,
                             struct proto_problem *problem)
{
    proto_problem_from_status(problem, status, detail);
    if (status == GD_TOO_LARGE) proto_problem_limit(problem, build->builder->max_faces);
    if (status == GD_BUDGET) server_budget_refuse(build->builder->budget, "the mesh", 0, problem);
    return status;
}

static bool take(const struct build *build, size_t bytes, struct proto_problem *problem)
{
    struct server_budget *budget = build->builder->budget;
    if (server_budget_take(budget, SERVER_BUDGET_FLIGHT, bytes)) return true;
    return server_budget_refuse(budget, "the mesh", bytes, problem);
}

static size_t polygons_size(const struct gd_polygons *polygons)
{
    size_t first = polygons->first ? polygons->polygon_count + (size_t)1 : 0;
    return polygons->position_count * sizeof *polygons->positions +
           (gd_polygons_corner_count(polygons) + first) * sizeof *polygons->corners;
}

static enum gd_status read_polygons(struct build *build, const void *bytes, struct proto_problem *problem)
{
    struct part part = {&build->builder->control, 0, READ_SHARE};
    const struct gd_control control = control_of(&part, 0);
    const struct gd_read_limits limits = {.max_faces = build->builder->max_faces, .control = &control};
    const struct server_record *record = build->record;
    struct gd_detail detail = {0};
    size_t size = (size_t)record->size, cost = size * READ_FACTOR;
    if (!take(build, cost, problem)) return GD_BUDGET;
    enum gd_status status = gd_read_polygons(bytes, size, record->options.format, &limits, &build->polygons, &detail);
    build->polygon_bytes = status ? 0 : polygons_size(&build->polygons);
    server_budget_adjust(build->builder->budget, SERVER_BUDGET_FLIGHT, cost, build->polygon_bytes);
    return status ? refuse(build, status, &detail, problem) : GD_OK;
}

static uint64_t triangle_count(const struct gd_polygons *polygons)
{
    return gd_polygons_corner_count(polygons) - UINT64_C(2) * polygons->polygon_count;
}

/* How many copies of vertices a repair makes shows on the way: nearly always few, but at most one a corner. Then the mesh is
 * built once more, with as much as that may take, or all that can be had. */
static size_t repair_cost(const struct build *build)
{
    uint64_t triangles = triangle_count(&build->polygons);
    size_t most = gd_mesh_build_cost(triangles, build->polygons.position_count + 3 * triangles);
    size_t available = server_budget_available(build->builder->budget);
    return most < available ? most : available;
}

static enum gd_status build_within(struct build *build, size_t cost, struct gd_detail *detail)
{
    struct part part = {&build->builder->control, READ_SHARE, 1 - READ_SHARE};
    const struct gd_control control = control_of(&part, cost);
    enum gd_status status =
        gd_mesh_build(&build->polygons, &build->record->options.build, &control, &build->mesh, detail);
    build->mesh_bytes = status ? 0 : gd_mesh_memsize(build->mesh);
    server_budget_adjust(build->builder->budget, SERVER_BUDGET_FLIGHT, cost, build->mesh_bytes);
    return status;
}

static enum gd_status build_mesh(struct build *build, struct proto_problem *problem)
{
    struct gd_detail detail = {0};
    size_t cost = gd_mesh_build_cost(triangle_count(&build->polygons), build->polygons.position_count);
    if (!take(build, cost, problem)) return GD_BUDGET;
    enum gd_status status = build_within(build, cost, &detail);
    size_t more = status == GD_BUDGET ? repair_cost(build) : 0;
    if (more > cost) {
        if (!take(build, more, problem)) return GD_BUDGET;
        status = build_within(build, more, &detail);
    }
    return status ? refuse(build, status, &detail, problem) : GD_OK;
}

/* Mesh and bytes become the surface's. */
static enum gd_status make_surface(struct build *build, struct server_surface **out, struct proto_problem *problem)
{
    struct server_surface *surface = server_surface_create(build->record, build->mesh, build->mesh_bytes,
                                                           build->builder->budget, build->builder->cache);
    if (!surface) return refuse(build, GD_NO_MEMORY, NULL, problem);
    build->mesh = NULL;
    build->mesh_bytes = 0;
    *out = surface;
    return GD_OK;
}

enum gd_status server_build_surface(const struct server_builder *builder, struct server_record *record,
                                    const void *bytes, struct server_surface **out, struct proto_problem *problem)
{
    struct build build = {.builder = builder, .record = record};
    enum gd_status status = read_polygons(&build, bytes, problem);
    if (!status) status = build_mesh(&build, problem);
    if (!status) status = make_surface(&build, out, problem);
    gd_polygons_free(&build.polygons);
    gd_mesh_release(build.mesh);
    server_budget_give(builder->budget, SERVER_BUDGET_FLIGHT, build.polygon_bytes + build.mesh_bytes);
    return status;
}
