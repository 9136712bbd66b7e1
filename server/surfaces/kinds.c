/* The kinds of surfaces: see kind.h. Each kind reads the file and then builds the object, in steps.
 * A step takes memory from the budget before it runs. If this memory was too little, the step runs
 * again with more memory. */
#include "server/surfaces/kinds.h"

#include <stdio.h>
#include <stdlib.h>

#include "gd/io.h"
#include "proto/json/decode.h"
#include "proto/values/mesh.h"
#include "proto/queries/subdivision.h"
#include "server/store/kind.h"
#include "server/surfaces/derived.h"

/* A weak symbol, because a test replaces it by its own table. */
__attribute__((weak)) const struct server_kind *const server_kinds[] = {
    &server_kind_mesh, &server_kind_nurbs, &server_kind_subdivision, NULL};

/* --- steps of a build ------------------------------------------------------------------------- */

#define GROWTH 4 /* factor by which the memory grows when a step is repeated */

struct build {
    const struct server_builder *builder;
    bool is_refused; /* true if the problem is set */
    struct gd_detail detail;
    bool is_read;
    double begun, share; /* the current step is the part [begun, begun + share] of the progress */
    size_t held;         /* bytes of SERVER_BUDGET_FLIGHT */
    struct proto_mesh_options mesh_options;
    struct gd_mended skipped; /* elements of the file that the reader of a mesh skipped */
    struct proto_subdivision_options subdivision_options;
    struct gd_control_mesh file; /* contents of the file; for a mesh, its polygons */
    enum gd_scheme scheme;
    void *object; /* NULL means that there is none yet */
};

/* A step. Sets `*kept` to the bytes that its result holds. */
typedef enum gd_status step(struct build *build, const struct gd_control *control, size_t *kept);

static bool build_progress(void *user, double fraction)
{
    const struct build *build = user;
    const struct gd_control *whole = &build->builder->control;
    return !whole->progress || whole->progress(whole->user, build->begun + build->share * fraction);
}

/* Runs a step with a budget of `cost` bytes. The step that reads the file has no limit, because its
 * `cost` is an upper bound. */
static enum gd_status step_run(struct build *build, step *run, size_t cost)
{
    const struct server_builder *builder = build->builder;
    const struct gd_control control = {.budget_bytes = build->is_read ? cost : 0,
                                       .deadline_ns = builder->control.deadline_ns,
                                       .progress = build_progress,
                                       .user = build,
                                       .executor = builder->control.executor};
    size_t kept = 0;
    enum gd_status status = server_build_take(builder, cost);
    build->is_refused = status != GD_OK;
    if (status) return status;
    status = run(build, &control, &kept);
    server_budget_adjust(builder->budget, SERVER_BUDGET_FLIGHT, cost, kept);
    build->held += kept;
    return status;
}

/* Runs a step, and repeats it with more memory while memory was too little and more is
 * available. */
static enum gd_status step_run_growing(struct build *build, step *run, size_t cost)
{
    enum gd_status status = step_run(build, run, cost);
    while (status == GD_BUDGET && !build->is_refused) status = step_run(build, run, cost *= GROWTH);
    return status;
}

/* Runs the step that reads the file, and frees the file, so that the next step can reuse its
 * memory. `share` is the step's fraction of the progress. */
static enum gd_status build_read(struct build *build, step *run, size_t cost, double share)
{
    void **file = build->builder->file;
    build->share = share;
    enum gd_status status = step_run(build, run, cost);
    if (file) {
        free(*file);
        *file = NULL;
    }
    build->is_read = true;
    build->begun = share;
    build->share = 1 - share;
    return status;
}

static enum gd_status object_create(struct build *build, size_t size)
{
    enum gd_status status = server_build_take(build->builder, size);
    build->is_refused = status != GD_OK;
    if (status) return status;
    build->held = size;
    build->object = calloc(1, size);
    return build->object ? GD_OK : GD_NO_MEMORY;
}

static size_t file_size(const struct gd_control_mesh *file)
{
    const struct gd_polygons *polygons = &file->polygons;
    size_t first = polygons->first ? polygons->polygon_count + (size_t)1 : 0;
    return polygons->position_count * sizeof *polygons->positions +
           (gd_polygons_corner_count(polygons) + first) * sizeof *polygons->corners +
           file->crease_count * sizeof *file->creases + file->corner_count * sizeof *file->corners;
}

/* Ends a build: leaves the bytes of the object in SERVER_BUDGET_FLIGHT and returns the rest to the
 * budget. */
static enum gd_status build_end(struct build *build, enum gd_status status,
                                struct server_built *out)
{
    const struct server_builder *builder = build->builder;
    *out = (struct server_built){build->object, status ? 0 : build->held - file_size(&build->file)};
    gd_control_mesh_free(&build->file);
    if (status) builder->record->kind->release(build->object);
    server_budget_give(builder->budget, SERVER_BUDGET_FLIGHT, build->held - out->size);
    return status && !build->is_refused ? server_build_refuse(builder, status, &build->detail)
                                        : status;
}

/* Returns the status of a problem that proto has set. */
static enum gd_status read_status(struct build *build)
{
    build->is_refused = true;
    switch (build->builder->problem->code) {
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

static size_t read_cost(const struct server_builder *builder, enum gd_format format)
{
    const struct gd_read_options options = {
        .format = format, .max_faces = builder->max_faces, .control = &builder->control};
    return gd_read_cost(builder->bytes, (size_t)builder->record->size, &options);
}

static size_t json_cost(const struct server_builder *builder)
{
    return proto_decode_cost(builder->bytes, (size_t)builder->record->size, &builder->control);
}

/* --- meshes ----------------------------------------------------------------------------------- */

/* Omits unset options, so that new options do not change the ETags of old meshes. */
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

static enum gd_status mesh_read(struct build *build, const struct gd_control *control, size_t *kept)
{
    const struct server_builder *builder = build->builder;
    bool is_repaired = build->mesh_options.build.repair_split;
    const struct gd_read_options options = {.format = build->mesh_options.format,
                                            .max_faces = builder->max_faces,
                                            .control = control,
                                            .skipped = is_repaired ? &build->skipped : NULL};
    enum gd_status status = gd_read_polygons(builder->bytes, (size_t)builder->record->size,
                                             &options, &build->file.polygons, &build->detail);
    *kept = file_size(&build->file);
    return status;
}

static enum gd_status mesh_connect(struct build *build, const struct gd_control *control,
                                   size_t *kept)
{
    struct gd_mesh *mesh;
    enum gd_status status = gd_mesh_build_consuming(
        &build->file.polygons, &build->mesh_options.build, control, &mesh, &build->detail);
    if (status) return status;
    build->object = mesh;
    *kept = gd_mesh_memsize(mesh);
    return GD_OK;
}

/* Builds the mesh. A repair copies vertices: usually few, at most one for each corner. If memory is
 * too little, the mesh is built again, with memory for the largest number of copies or with all
 * available memory. */
static enum gd_status mesh_connect_growing(struct build *build)
{
    const struct gd_polygons *polygons = &build->file.polygons;
    uint64_t positions = polygons->position_count;
    uint64_t triangles = gd_polygons_corner_count(polygons) - UINT64_C(2) * polygons->polygon_count;
    size_t cost = gd_mesh_build_cost(triangles, positions);
    enum gd_status status = step_run(build, mesh_connect, cost);
    if (status != GD_BUDGET || build->is_refused) return status;
    size_t most = gd_mesh_build_cost(triangles, positions + 3 * triangles);
    size_t available = server_budget_available(build->builder->budget);
    if (available < most) most = available;
    return most > cost ? step_run(build, mesh_connect, most) : status;
}

/* Appends the remedy, unless the engine's sentence or the request already contains it. */
static void mesh_suggest_split(const struct build *build, enum gd_status status)
{
    bool is_joined = status == GD_NON_MANIFOLD_EDGE || status == GD_NON_MANIFOLD_VERTEX,
         is_faulty = status == GD_DEGENERATE_FACE || status == GD_DUPLICATE_FACE;
    struct proto_problem *problem = build->builder->problem;
    size_t length = strlen(problem->detail);
    if ((!is_joined && !is_faulty) || build->mesh_options.build.repair_split ||
        strstr(problem->detail, "repair=split"))
        return;
    snprintf(problem->detail + length, sizeof problem->detail - length, "%s",
             is_joined ? "; upload with ?repair=split to separate them"
                       : ", or upload with ?repair=split");
}

/* Shares the mesh that is built already. */
static enum gd_status mesh_share(const struct server_builder *builder, struct server_built *out)
{
    size_t bytes = gd_mesh_memsize(builder->mesh);
    enum gd_status status = server_build_take(builder, bytes);
    if (!status) *out = (struct server_built){gd_mesh_retain(builder->mesh), bytes};
    return status;
}

static enum gd_status mesh_build(const struct server_builder *builder, struct server_built *out)
{
    /* a mesh with too many faces is built from its file, which reports the limit as a problem */
    if (builder->mesh && gd_mesh_summary(builder->mesh)->faces <= builder->max_faces)
        return mesh_share(builder, out);
    struct build build = {.builder = builder, .mesh_options.format = GD_FORMAT_ANY};
    struct server_options text;
    /* can't fail, because the options were checked at the upload */
    (void)server_options_split(builder->record->options, &text);
    (void)proto_mesh_options_parse(&text.parameters, &build.mesh_options, builder->problem);
    build.mesh_options.build.lines_skipped = &build.skipped;
    size_t cost = read_cost(builder, build.mesh_options.format);
    enum gd_status status = build_read(&build, mesh_read, cost, 0.2);
    if (!status) status = mesh_connect_growing(&build);
    status = build_end(&build, status, out);
    mesh_suggest_split(&build, status);
    return status;
}

static void mesh_release(void *object)
{
    gd_mesh_release(object);
}

static void mesh_describe(struct proto_writer *writer, const struct server_surface *surface)
{
    const struct server_record *record = surface->record;
    const struct server_derived *derived = server_derived_of(surface);
    struct proto_mesh_description description = {
        .name = record->name,
        .sha256 = record->sha256,
        .created = record->created,
        .etag = record->etag,
        .fields_cached = server_mesh_cache_count(surface->fields),
        .memory_bytes = surface->bytes,
        .mesh = surface->mesh,
    };
    if (derived) {
        description.derived.mesh = derived->mesh;
        description.derived.etag = derived->etag;
        description.derived.largest_distance = derived->largest_distance;
        description.derived.operations = derived->operations;
    }
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

#define TESSELLATION_BYTES ((size_t)8 << 20) /* suffices for most builds */
#define TRIMS_BYTES        ((size_t)8 << 20) /* most bytes for checking trimming loops */

static bool nurbs_read_options(const struct proto_parameters *parameters,
                               const struct server_file *file, char text[SERVER_OPTIONS],
                               struct proto_problem *problem)
{
    struct proto_nurbs_options options;
    (void)file;
    if (!proto_nurbs_options_parse(parameters, &options, problem)) return false;
    snprintf(text, SERVER_OPTIONS, "format=json%s%s", options.has_convention ? "&convention=" : "",
             options.has_convention ? proto_convention_words[options.convention] : "");
    return true;
}

static enum gd_status nurbs_read(struct build *build, const struct gd_control *control,
                                 size_t *kept)
{
    const struct server_builder *builder = build->builder;
    struct server_nurbs *nurbs = build->object;
    struct proto_nurbs_options options = {0};
    struct server_options text;
    (void)server_options_split(builder->record->options, &text);
    (void)proto_nurbs_options_parse(&text.parameters, &options, builder->problem);
    options.control = control;
    if (!proto_nurbs_read(builder->bytes, (size_t)builder->record->size, &options, &nurbs->surface,
                          &nurbs->form, builder->problem))
        return read_status(build);
    *kept = gd_parametric_memsize(nurbs->surface);
    return GD_OK;
}

/* Returns the cost of reading. The samples of trimming loops are not bounded by the file's size. */
static size_t nurbs_read_cost(const struct server_builder *builder)
{
    static const char member[] = "\"trims\"";
    size_t size = (size_t)builder->record->size; /* 0 means that the bytes may be NULL */
    bool is_trimmed = size && memmem(builder->bytes, size, member, sizeof member - 1);
    return json_cost(builder) + (is_trimmed ? TRIMS_BYTES : 0);
}

static enum gd_status nurbs_tessellate(struct build *build, const struct gd_control *control,
                                       size_t *kept)
{
    struct server_nurbs *nurbs = build->object;
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

/* Builds a NURBS surface. A surface that can't be tessellated (because it is flat somewhere, or too
 * large) is accepted, because it can be evaluated. Operations that need the tessellation report why
 * there is none. */
static enum gd_status nurbs_build(const struct server_builder *builder, struct server_built *out)
{
    struct build build = {.builder = builder};
    enum gd_status status = object_create(&build, sizeof(struct server_nurbs));
    if (!status) status = build_read(&build, nurbs_read, nurbs_read_cost(builder), 0.2);
    if (!status) {
        struct server_nurbs *nurbs = build.object;
        status = step_run_growing(&build, nurbs_tessellate, TESSELLATION_BYTES);
        build.detail = nurbs->detail;
        bool is_lasting = status != GD_NO_MEMORY && status != GD_BUDGET && status != GD_CANCELLED &&
                          status != GD_DEADLINE;
        if (is_lasting) {
            nurbs->refusal = status;
            status = GD_OK;
        }
    }
    return build_end(&build, status, out);
}

static void nurbs_describe(struct proto_writer *writer, const struct server_surface *surface)
{
    const struct server_record *record = surface->record;
    const struct server_nurbs *nurbs = server_nurbs_of(surface);
    const struct gd_tessellation *tessellation = nurbs->tessellation;
    bool has_outer;
    uint32_t loops = gd_parametric_loops(nurbs->surface, &has_outer);
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
        .trimming_loops = loops,
        .has_outer_loop = has_outer,
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

#define READ_FACTOR     33  /* upper bound of the memory for each byte of a file that is not JSON */
#define BYTES_A_CORNER  400 /* suffices for most builds */
#define BYTES_A_SURFACE ((size_t)1 << 20)

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
             options.has_scheme ? proto_scheme_words[options.scheme] : "");
    return true;
}

/* Returns the memory that reading needs. A glTF file may place a mesh many times, so this cost is
 * not bounded by the file's size. */
static size_t subdivision_read_cost(const struct server_builder *builder, enum gd_format format)
{
    size_t placed = read_cost(builder, format);
    size_t cost =
        format == GD_FORMAT_JSON ? json_cost(builder) : (size_t)builder->record->size * READ_FACTOR;
    return placed > cost ? placed : cost;
}

static enum gd_status subdivision_read(struct build *build, const struct gd_control *control,
                                       size_t *kept)
{
    const struct server_builder *builder = build->builder;
    const struct gd_read_options limits = {.max_faces = builder->max_faces, .control = control};
    if (!proto_subdivision_read(builder->bytes, (size_t)builder->record->size,
                                &build->subdivision_options, &limits, &build->file, &build->scheme,
                                builder->problem))
        return read_status(build);
    *kept = file_size(&build->file);
    return GD_OK;
}

static enum gd_status subdivision_create(struct build *build, const struct gd_control *control,
                                         size_t *kept)
{
    struct gd_subdivision **out = &((struct server_subdivision *)build->object)->surface;
    enum gd_status status =
        gd_subdivision_create(&build->file, build->scheme, control, out, &build->detail);
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
                                        struct server_built *out)
{
    struct build build = {.builder = builder, .subdivision_options.format = GD_FORMAT_ANY};
    struct server_options text;
    (void)server_options_split(builder->record->options, &text);
    (void)proto_subdivision_options_parse(&text.parameters, &build.subdivision_options,
                                          builder->problem);
    enum gd_status status = object_create(&build, sizeof(struct server_subdivision));
    size_t cost = subdivision_read_cost(builder, build.subdivision_options.format);
    if (!status) status = build_read(&build, subdivision_read, cost, 0.5);
    if (!status) {
        size_t corners = gd_polygons_corner_count(&build.file.polygons);
        cost = BYTES_A_SURFACE + corners * BYTES_A_CORNER;
        status = step_run_growing(&build, subdivision_create, cost);
        if (status && !build.is_refused) {
            proto_subdivision_refuse(status, &build.detail, builder->problem);
            build.is_refused = true;
        }
    }
    return build_end(&build, status, out);
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
        .summary = gd_subdivision_summary(server_subdivision_of(surface)->surface),
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
