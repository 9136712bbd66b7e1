/* The kinds of surfaces: see kind.h. Each reads the file, then builds the object, in steps. A step
 * takes memory from the budget before it is used, and runs again with more if that was too
 * little. */
#include "server/surfaces/kinds.h"

#include <stdio.h>
#include <stdlib.h>

#include "gd/io.h"
#include "proto/json/decode.h"
#include "proto/values/mesh.h"
#include "proto/queries/subdivision.h"
#include "server/store/kind.h"

/* Weak: a test has a table of its own. */
__attribute__((weak)) const struct server_kind *const server_kinds[] = {
    &server_kind_mesh, &server_kind_nurbs, &server_kind_subdivision, NULL};

/* --- steps of a build ------------------------------------------------------------------------- */

#define GROWTH 4 /* of the memory of a step that is repeated */

struct build {
    const struct server_builder *builder;
    const struct server_record *record;
    const void *bytes; /* the file */
    struct proto_problem *problem;
    bool is_refused; /* the problem is set */
    struct gd_detail detail;
    const struct step *step; /* under way */
    size_t held;             /* bytes of SERVER_BUDGET_FLIGHT */
};

struct step {
    /* Sets `*kept` to the bytes that the result holds. */
    enum gd_status (*run)(struct build *build, const struct gd_control *control, size_t *kept);
    double begun, share; /* it is the part [begun, begun + share] of the work */
    bool is_bounded;     /* `run` may need more than its cost, and stops there */
};

static bool build_progress(void *user, double fraction)
{
    const struct build *build = user;
    const struct gd_control *whole = &build->builder->control;
    const struct step *step = build->step;
    return !whole->progress || whole->progress(whole->user, step->begun + step->share * fraction);
}

/* Runs a step in `cost` bytes. */
static enum gd_status step_run(struct build *build, const struct step *step, size_t cost)
{
    const struct server_builder *builder = build->builder;
    const struct gd_control control = {.budget_bytes = step->is_bounded ? cost : 0,
                                       .deadline_ns = builder->control.deadline_ns,
                                       .progress = build_progress,
                                       .user = build};
    size_t kept = 0;
    enum gd_status status = server_build_take(builder, build->record, cost, build->problem);
    build->is_refused = status != GD_OK;
    if (status) return status;
    build->step = step;
    status = step->run(build, &control, &kept);
    server_budget_adjust(builder->budget, SERVER_BUDGET_FLIGHT, cost, kept);
    build->held += kept;
    return status;
}

/* Repeats a step with more memory while that was too little and more can be had. */
static enum gd_status step_run_growing(struct build *build, const struct step *step, size_t cost)
{
    enum gd_status status = step_run(build, step, cost);
    while (status == GD_BUDGET && !build->is_refused)
        status = step_run(build, step, cost *= GROWTH);
    return status;
}

/* Leaves the bytes of the object in SERVER_BUDGET_FLIGHT, if there is one, and gives the rest
 * back. */
static enum gd_status build_end(struct build *build, enum gd_status status, size_t object_size)
{
    server_budget_give(build->builder->budget, SERVER_BUDGET_FLIGHT,
                       build->held - (status ? 0 : object_size));
    return status && !build->is_refused ? server_build_refuse(build->builder, build->record, status,
                                                              &build->detail, build->problem)
                                        : status;
}

/* Allocates an object of `size` bytes, all zero, and takes them from the budget; or NULL. */
static void *object_create(struct build *build, size_t size, enum gd_status *status)
{
    void *object = calloc(1, size);
    *status = object ? server_build_take(build->builder, build->record, size, build->problem)
                     : GD_NO_MEMORY;
    build->is_refused = *status == GD_BUDGET;
    if (!*status) build->held = size;
    return object;
}

/* The status of a problem that proto has set. */
static enum gd_status read_status(struct build *build)
{
    build->is_refused = true;
    switch (build->problem->code) {
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

/* The options of a record, which were checked before. */
static struct proto_parameters options_of_record(const struct server_record *record,
                                                 struct server_options *options)
{
    (void)server_options_split(record->options, options);
    return server_options_parameters(options);
}

static size_t polygons_size(const struct gd_polygons *polygons)
{
    size_t first = polygons->first ? polygons->polygon_count + (size_t)1 : 0;
    return polygons->position_count * sizeof *polygons->positions +
           (gd_polygons_corner_count(polygons) + first) * sizeof *polygons->corners;
}

/* --- meshes ----------------------------------------------------------------------------------- */

#define MESH_READ_SHARE 0.2 /* of the time, for OBJ */

struct mesh_build {
    struct build base; /* first */
    struct proto_mesh_options options;
    struct gd_polygons polygons;
    struct gd_mesh *mesh;
};

/* Unset options are left out, so that later options do not change the ETags of others. */
static bool mesh_read_options(const struct proto_parameters *parameters,
                              const struct server_file *file, char text[SERVER_OPTIONS],
                              struct proto_problem *problem)
{
    struct proto_mesh_options options;
    if (!proto_mesh_options_parse(parameters, &options, problem)) return false;
    if (file)
        options.format =
            proto_mesh_upload_format(&options, file->bytes, file->size, file->content_type);
    const struct gd_mesh_options *build = &options.build;
    int size = snprintf(text, SERVER_OPTIONS, "format=%s&triangulate=%s%s",
                        gd_format_name(options.format), build->refuse_polygons ? "false" : "true",
                        build->repair_split ? "&repair=split" : "");
    if (build->weld)
        snprintf(text + size, SERVER_OPTIONS - (size_t)size, "&weld=%.17g", build->weld_tolerance);
    return true;
}

static enum gd_status mesh_read_polygons(struct build *base, const struct gd_control *control,
                                         size_t *kept)
{
    struct mesh_build *build = (struct mesh_build *)base;
    const struct gd_read_limits limits = {base->builder->max_faces, .control = control};
    enum gd_status status =
        gd_read_polygons(base->bytes, (size_t)base->record->size, build->options.format, &limits,
                         &build->polygons, &base->detail);
    if (!status) *kept = polygons_size(&build->polygons);
    return status;
}

static enum gd_status mesh_connect(struct build *base, const struct gd_control *control,
                                   size_t *kept)
{
    struct mesh_build *build = (struct mesh_build *)base;
    enum gd_status status = gd_mesh_build(&build->polygons, &build->options.build, control,
                                          &build->mesh, &base->detail);
    if (!status) *kept = gd_mesh_memsize(build->mesh);
    return status;
}

/* A repair copies vertices: nearly always few, at most one a corner. So the mesh is built once more
 * with the memory of the latter, or all that can be had. */
static enum gd_status mesh_connect_growing(struct mesh_build *build)
{
    static const struct step step = {mesh_connect, MESH_READ_SHARE, 1 - MESH_READ_SHARE, true};
    uint64_t positions = build->polygons.position_count;
    uint64_t triangles =
        gd_polygons_corner_count(&build->polygons) - UINT64_C(2) * build->polygons.polygon_count;
    size_t cost = gd_mesh_build_cost(triangles, positions);
    enum gd_status status = step_run(&build->base, &step, cost);
    if (status != GD_BUDGET || build->base.is_refused) return status;
    size_t most = gd_mesh_build_cost(triangles, positions + 3 * triangles);
    size_t available = server_budget_available(build->base.builder->budget);
    if (available < most) most = available;
    return most > cost ? step_run(&build->base, &step, most) : status;
}

/* Appends the remedy, unless the engine named it. */
static void mesh_suggest_split(struct proto_problem *problem)
{
    size_t length = strlen(problem->detail);
    if (!strstr(problem->detail, "repair=split"))
        snprintf(problem->detail + length, sizeof problem->detail - length,
                 "; upload with ?repair=split to separate them");
}

static enum gd_status mesh_build(const struct server_builder *builder,
                                 const struct server_record *record, const void *bytes,
                                 struct server_built *out, struct proto_problem *problem)
{
    static const struct step reading = {mesh_read_polygons, 0, MESH_READ_SHARE, false};
    struct mesh_build build = {
        .base = {.builder = builder, .record = record, .bytes = bytes, .problem = problem},
        .options = {.format = GD_FORMAT_ANY}};
    const struct gd_read_limits limits = {.max_faces = builder->max_faces};
    struct server_options text;
    const struct proto_parameters options = options_of_record(record, &text);
    (void)proto_mesh_options_parse(&options, &build.options, problem);
    enum gd_status status =
        step_run(&build.base, &reading,
                 gd_read_cost(bytes, (size_t)record->size, build.options.format, &limits));
    if (!status) status = mesh_connect_growing(&build);
    gd_polygons_free(&build.polygons);
    *out = (struct server_built){build.mesh, status ? 0 : gd_mesh_memsize(build.mesh)};
    status = build_end(&build.base, status, out->size);
    if (status == GD_NON_MANIFOLD_EDGE || status == GD_NON_MANIFOLD_VERTEX)
        mesh_suggest_split(problem);
    return status;
}

static void mesh_release(void *object)
{
    gd_mesh_release(object);
}

static void mesh_describe(struct proto_writer *writer, const struct server_surface *surface)
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
    .read_options = mesh_read_options,
    .build = mesh_build,
    .release = mesh_release,
    .describe = mesh_describe,
    .shorten = proto_mesh_shorten,
};

/* --- NURBS ------------------------------------------------------------------------------------ */

#define NURBS_READ_SHARE   0.2
#define TESSELLATION_BYTES ((size_t)8 << 20) /* that most take while they are built */

struct nurbs_build {
    struct build base; /* first */
    struct server_nurbs *nurbs;
};

static bool nurbs_read_options(const struct proto_parameters *parameters,
                               const struct server_file *file, char text[SERVER_OPTIONS],
                               struct proto_problem *problem)
{
    struct proto_nurbs_options options;
    (void)file;
    if (!proto_nurbs_options_parse(parameters, &options, problem)) return false;
    snprintf(text, SERVER_OPTIONS, "format=json%s%s", options.has_convention ? "&convention=" : "",
             options.has_convention ? proto_nurbs_conventions[options.convention] : "");
    return true;
}

static enum gd_status nurbs_read(struct build *base, const struct gd_control *control, size_t *kept)
{
    struct server_nurbs *nurbs = ((struct nurbs_build *)base)->nurbs;
    struct proto_nurbs_options options = {0};
    struct server_options text;
    const struct proto_parameters parameters = options_of_record(base->record, &text);
    (void)proto_nurbs_options_parse(&parameters, &options, base->problem);
    options.control = control;
    if (!proto_nurbs_read(base->bytes, (size_t)base->record->size, &options, &nurbs->surface,
                          &nurbs->form, base->problem))
        return read_status(base);
    *kept = gd_parametric_memsize(nurbs->surface);
    return GD_OK;
}

static enum gd_status nurbs_tessellate(struct build *base, const struct gd_control *control,
                                       size_t *kept)
{
    struct server_nurbs *nurbs = ((struct nurbs_build *)base)->nurbs;
    enum gd_status status =
        gd_tessellation_build(nurbs->surface, NULL, control, &nurbs->tessellation, &nurbs->detail);
    if (!status) *kept = gd_tessellation_memsize(nurbs->tessellation);
    return status;
}

static void nurbs_release(void *object)
{
    struct server_nurbs *nurbs = object;
    if (!nurbs) return;
    gd_tessellation_release(nurbs->tessellation);
    gd_parametric_release(nurbs->surface);
    free(nurbs);
}

/* A surface without tessellation (flat somewhere, or too large) is kept: it can be evaluated, and
 * operations that need the tessellation say why there is none. */
static enum gd_status nurbs_build(const struct server_builder *builder,
                                  const struct server_record *record, const void *bytes,
                                  struct server_built *out, struct proto_problem *problem)
{
    static const struct step reading = {nurbs_read, 0, NURBS_READ_SHARE, false},
                             tessellation = {nurbs_tessellate, NURBS_READ_SHARE,
                                             1 - NURBS_READ_SHARE, true};
    struct nurbs_build build = {
        .base = {.builder = builder, .record = record, .bytes = bytes, .problem = problem}};
    enum gd_status status;
    build.nurbs = object_create(&build.base, sizeof *build.nurbs, &status);
    if (!status)
        status = step_run(&build.base, &reading,
                          proto_decode_cost(bytes, (size_t)record->size, &builder->control));
    if (!status) {
        status = step_run_growing(&build.base, &tessellation, TESSELLATION_BYTES);
        build.base.detail = build.nurbs->detail;
        bool is_lasting = status != GD_NO_MEMORY && status != GD_BUDGET && status != GD_CANCELLED &&
                          status != GD_DEADLINE;
        if (is_lasting) {
            build.nurbs->refusal = status;
            status = GD_OK;
        }
    }
    if (status) nurbs_release(build.nurbs);
    *out = (struct server_built){build.nurbs, build.base.held};
    return build_end(&build.base, status, out->size);
}

static void nurbs_describe(struct proto_writer *writer, const struct server_surface *surface)
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
    .read_options = nurbs_read_options,
    .build = nurbs_build,
    .release = nurbs_release,
    .describe = nurbs_describe,
};

/* --- subdivision surfaces --------------------------------------------------------------------- */

#define SUBDIVISION_READ_SHARE 0.5
#define READ_FACTOR            33  /* bytes that reading takes at most for each byte of no JSON */
#define BYTES_A_CORNER         400 /* that most take while the surface is built */
#define BYTES_A_SURFACE        ((size_t)1 << 20)

struct subdivision_build {
    struct build base; /* first */
    struct proto_subdivision_options options;
    struct gd_control_mesh control_mesh;
    enum gd_scheme scheme;
    struct server_subdivision *subdivision;
};

static bool subdivision_read_options(const struct proto_parameters *parameters,
                                     const struct server_file *file, char text[SERVER_OPTIONS],
                                     struct proto_problem *problem)
{
    struct proto_subdivision_options options;
    if (!proto_subdivision_options_parse(parameters, &options, problem)) return false;
    const struct proto_mesh_options requested = {.format = options.format};
    if (file)
        options.format =
            proto_mesh_upload_format(&requested, file->bytes, file->size, file->content_type);
    snprintf(text, SERVER_OPTIONS, "format=%s%s%s", gd_format_name(options.format),
             options.has_scheme ? "&scheme=" : "",
             options.has_scheme ? proto_subdivision_schemes[options.scheme] : "");
    return true;
}

/* glTF may place a mesh many times. */
static size_t subdivision_read_cost(const struct subdivision_build *build)
{
    const struct gd_read_limits limits = {.max_faces = build->base.builder->max_faces};
    size_t size = (size_t)build->base.record->size;
    size_t placed = gd_read_cost(build->base.bytes, size, build->options.format, &limits);
    size_t cost = build->options.format == GD_FORMAT_JSON
                      ? proto_decode_cost(build->base.bytes, size, &build->base.builder->control)
                      : size * READ_FACTOR;
    return placed > cost ? placed : cost;
}

static enum gd_status subdivision_read(struct build *base, const struct gd_control *control,
                                       size_t *kept)
{
    struct subdivision_build *build = (struct subdivision_build *)base;
    const struct gd_read_limits limits = {base->builder->max_faces, .control = control};
    struct gd_control_mesh *mesh = &build->control_mesh;
    if (!proto_subdivision_read(base->bytes, (size_t)base->record->size, &build->options, &limits,
                                mesh, &build->scheme, base->problem))
        return read_status(base);
    *kept = polygons_size(&mesh->polygons) + mesh->crease_count * sizeof *mesh->creases +
            mesh->corner_count * sizeof *mesh->corners;
    return GD_OK;
}

static enum gd_status subdivision_create(struct build *base, const struct gd_control *control,
                                         size_t *kept)
{
    struct subdivision_build *build = (struct subdivision_build *)base;
    struct gd_subdivision **out = &build->subdivision->surface;
    enum gd_status status =
        gd_subdivision_create(&build->control_mesh, build->scheme, control, out, &base->detail);
    if (!status) *kept = gd_subdivision_memsize(*out);
    return status;
}

static void subdivision_release(void *object)
{
    struct server_subdivision *subdivision = object;
    if (!subdivision) return;
    server_discretization_slot_close(&subdivision->slot);
    gd_subdivision_release(subdivision->surface);
    free(subdivision);
}

static enum gd_status subdivision_build(const struct server_builder *builder,
                                        const struct server_record *record, const void *bytes,
                                        struct server_built *out, struct proto_problem *problem)
{
    static const struct step reading = {subdivision_read, 0, SUBDIVISION_READ_SHARE, false},
                             creation = {subdivision_create, SUBDIVISION_READ_SHARE,
                                         1 - SUBDIVISION_READ_SHARE, true};
    struct subdivision_build build = {
        .base = {.builder = builder, .record = record, .bytes = bytes, .problem = problem},
        .options = {.format = GD_FORMAT_ANY}};
    struct server_options text;
    const struct proto_parameters options = options_of_record(record, &text);
    enum gd_status status;
    (void)proto_subdivision_options_parse(&options, &build.options, problem);
    build.subdivision = object_create(&build.base, sizeof *build.subdivision, &status);
    if (!status) status = step_run(&build.base, &reading, subdivision_read_cost(&build));
    if (!status) {
        size_t corners = gd_polygons_corner_count(&build.control_mesh.polygons);
        status =
            step_run_growing(&build.base, &creation, BYTES_A_SURFACE + corners * BYTES_A_CORNER);
        if (status && !build.base.is_refused) {
            proto_subdivision_refuse(status, &build.base.detail, problem);
            build.base.is_refused = true;
        }
    }
    gd_control_mesh_free(&build.control_mesh);
    size_t size = sizeof *build.subdivision;
    if (!status) size += gd_subdivision_memsize(build.subdivision->surface);
    if (status) subdivision_release(build.subdivision);
    *out = (struct server_built){build.subdivision, size};
    return build_end(&build.base, status, size);
}

static void subdivision_describe(struct proto_writer *writer, const struct server_surface *surface)
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
    .read_options = subdivision_read_options,
    .build = subdivision_build,
    .release = subdivision_release,
    .describe = subdivision_describe,
};
