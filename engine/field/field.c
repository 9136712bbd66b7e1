#include "field/layout.h"

#include <stdlib.h>

#include "partition/run.h"

#define CHECK_PARTS 8
#define CHECK_LEAST 30000 /* edges; a smaller mesh is checked before a second thread starts */

/* --- building --------------------------------------------------------------------------------- */

static enum gd_status check_request(const struct gd_field_request *request,
                                    struct gd_detail *detail)
{
    if (!request->seed_count)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "a field needs at least one source point");
    if (!(request->radius >= 0))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the radius must be zero (no limit) or more");
    return GD_OK;
}

size_t gd__field_bytes(const struct gd_field *field)
{
    const struct gd_mesh *mesh = field->mesh;
    return sizeof *field +
           mesh->vertex_count * (sizeof *field->distance + sizeof *field->predecessor) +
           mesh->edge_count * sizeof *field->newest + field->wedge_bytes +
           field->seed_count * (sizeof *field->seeds + 2 * sizeof *field->face_seeds);
}

/* The context of the check's tasks, each of which checks a part of the edges. */
struct check {
    const struct gd_field *field;
    bool failed[CHECK_PARTS];
};

/* Returns true if the distances of an edge's ends differ by more than the edge's length, within the
 * field's reach. If no edge breaks this law, every vertex is reached. */
static bool breaks_law(const struct gd_field *field, uint32_t side)
{
    const struct gd_mesh *mesh = field->mesh;
    double a = field->distance[mesh->origin[side]], b = field->distance[mesh->origin[side + 1]];
    double nearer = a < b ? a : b, through = nearer + mesh->side[side].length;
    return nearer + fabs(a - b) > through * (1 + GD_TOL_CHECK) && through <= field->reach;
}

static void check_edges(void *context, uint32_t part)
{
    struct check *check = context;
    const struct gd_mesh *mesh = check->field->mesh;
    uint32_t first = (uint32_t)((uint64_t)part * mesh->edge_count / CHECK_PARTS),
             end = (uint32_t)((uint64_t)(part + 1) * mesh->edge_count / CHECK_PARTS);
    for (uint32_t side = 2 * first; side < 2 * end; side += 2)
        if (breaks_law(check->field, side)) check->failed[part] = true;
}

static bool obeys_law(const struct gd_field *field, const struct gd_executor *executor)
{
    struct check check = {.field = field};
    bool failed = false;
    gd_executor_run(field->mesh->edge_count < CHECK_LEAST ? NULL : executor, check_edges, &check,
                    CHECK_PARTS);
    for (int part = 0; part < CHECK_PARTS; part++) failed |= check.failed[part];
    return !failed;
}

/* Lowers the distance of an edge's farther end to that of the path along the edge, if shorter.
 * Applies only to edges shorter than the rounding of the nearer end's distance. */
static bool mend_edge(struct gd_field *field, uint32_t side)
{
    const struct gd_mesh *mesh = field->mesh;
    uint32_t near = mesh->origin[side], far = mesh->origin[side + 1];
    if (field->distance[far] < field->distance[near]) near = far, far = mesh->origin[side];
    if (mesh->side[side].length > GD_TOL_LOST * field->distance[near]) return false;
    field->distance[far] = field->distance[near] + mesh->side[side].length;
    if (field->predecessor)
        field->predecessor[far] = (struct gd__predecessor){.side = GD_NONE, .source = near};
    return true;
}

/* Repairs distances in faces as small as rounding. If windows tie to the last bit, rounding may
 * discard all of them, and vertices keep a distance that is too long, or none. In such small faces
 * paths along edges are equally good. Elsewhere, as around a very thin tube, the field is an error.
 * Distances only decrease, so the loop ends. */
static enum gd_status mend_field(struct gd_field *field)
{
    bool is_mended = true;
    for (uint32_t pass = 0; is_mended && pass < field->mesh->vertex_count; pass++) {
        is_mended = false;
        for (uint32_t side = 0; side < 2 * field->mesh->edge_count; side += 2)
            if (breaks_law(field, side)) is_mended |= mend_edge(field, side);
    }
    return obeys_law(field, NULL) ? GD_OK : GD_INTERNAL;
}

enum gd_status gd__field_take(void *user, struct gd__wavefront *front,
                              const struct gd_executor *executor)
{
    (void)executor;
    struct gd_field *field = user;
    field->statistics =
        (struct gd_field_statistics){.windows_created = front->counts.windows_created,
                                     .windows_propagated = front->counts.windows_propagated,
                                     .wedges = front->wedge_count,
                                     .sides_propagated = front->counts.sides_propagated,
                                     .vertices_emitted = front->counts.vertices_emitted};
    field->reach = front->bound;
    struct gd_workspace *work = front->work;
    if (front->paged) {
        field->distance = front->distance;
        front->paged->distance = NULL;
        return GD_OK;
    }
    field->distance = work->distance;
    field->predecessor = work->predecessor;
    field->newest = work->newest;
    field->wedge_bytes = work->wedges.used;
    field->kept = gd__region_close(&work->wedges);
    field->wedges = field->kept.base;
    work->distance = NULL;
    work->predecessor = NULL;
    work->newest = NULL;
    return GD_OK;
}

enum gd_status gd__field_propagate(struct gd_field *field,
                                   const struct gd__propagation *propagation,
                                   const struct gd_control *control,
                                   const struct gd_executor *executor)
{
    uint64_t start = gd_now_ns();
    struct gd__sink take = {.take = gd__field_take, .user = field};
    enum gd_status status = gd__wavefront_run(field->mesh, propagation, &take, control, executor);
    if (!status && !obeys_law(field, executor)) status = mend_field(field);
    field->bytes = gd__field_bytes(field);
    field->statistics.build_ns = gd_now_ns() - start;
    return status;
}

/* Options of one attempt to build a field. If the check fails, the field is built again with other
 * options, with which rounding discards other windows. */
struct manner {
    bool without_wedges;
    struct gd__variant variant;
};

static enum gd_status propagate_field(struct gd_field *field,
                                      const struct gd_field_request *request,
                                      const struct manner *manner, const struct gd_control *control,
                                      const struct gd_executor *executor)
{
    struct gd__propagation propagation = {
        .seeds = field->seeds,
        .seed_count = field->seed_count,
        .radius = request->radius > 0 ? request->radius / field->mesh->unit : GD__FAR,
        .target = request->target,
        .without_wedges = manner->without_wedges,
        .variant = manner->variant};
    return gd__field_propagate(field, &propagation, control, executor);
}

static enum gd_status build_field(const struct gd_mesh *mesh,
                                  const struct gd_field_request *request,
                                  const struct manner *manner, const struct gd_control *control,
                                  const struct gd_executor *executor, struct gd_field **out,
                                  struct gd_detail *detail)
{
    enum gd_status status = check_request(request, detail);
    if (status) return status;
    struct gd_field *field = gd__field_create(mesh);
    if (!field) return gd_fail_status(detail, GD_NO_MEMORY);
    status = gd__field_take_seeds(field, request, detail);
    if (!status) {
        status = propagate_field(field, request, manner, control, executor);
        if (status) gd_fail_status(detail, status);
    }
    if (status)
        gd_field_release(field);
    else
        *out = field;
    return status;
}

static enum gd_status build_somehow(const struct gd_mesh *mesh,
                                    const struct gd_field_request *request, bool without_wedges,
                                    const struct gd_control *control,
                                    const struct gd_executor *executor, struct gd_field **out,
                                    struct gd_detail *detail)
{
    const struct gd__variant variants[] = {{0},
                                           {0},
                                           {.no_coalescing = true},
                                           {.no_cone = true},
                                           {.no_coalescing = true, .no_filter = true}};
    enum gd_status status = GD_INTERNAL;
    for (size_t i = executor ? 0 : 1;
         i < sizeof variants / sizeof *variants && status == GD_INTERNAL; i++) {
        struct manner manner = {without_wedges, variants[i]};
        status = build_field(mesh, request, &manner, control, i ? NULL : executor, out, detail);
    }
    return status;
}

enum gd_status gd_field_build(const struct gd_mesh *mesh, const struct gd_field_request *request,
                              const struct gd_control *control, struct gd_field **out,
                              struct gd_detail *detail)
{
    const struct gd_executor *executor = control ? control->executor : NULL;
    return build_somehow(mesh, request, false, control, executor, out, detail);
}

enum gd_status gd_field_distances_only(const struct gd_mesh *mesh,
                                       const struct gd_field_request *request,
                                       const struct gd_control *control, double *out,
                                       struct gd_detail *detail)
{
    struct gd_field *field = NULL;
    enum gd_status status = build_somehow(mesh, request, true, control, NULL, &field, detail);
    if (status) return status;
    gd_field_vertex_distances(field, out);
    gd_field_release(field);
    return GD_OK;
}

/* --- life ------------------------------------------------------------------------------------- */

struct gd_field *gd__field_create(const struct gd_mesh *mesh)
{
    struct gd_field *field = calloc(1, sizeof *field);
    if (!field) return NULL;
    atomic_init(&field->references, 1);
    field->mesh = gd_mesh_retain(mesh);
    return field;
}

static void free_arrays(struct gd_field *field)
{
    free(field->distance);
    free(field->predecessor);
    free(field->newest);
    gd__region_release(&field->kept);
    free(field->seeds);
}

struct gd_field *gd_field_retain(const struct gd_field *field)
{
    /* the reference count is the only mutable member */
    struct gd_field *shared = (struct gd_field *)field;
    atomic_fetch_add_explicit(&shared->references, 1, memory_order_relaxed);
    return shared;
}

void gd_field_release(const struct gd_field *field)
{
    struct gd_field *shared = (struct gd_field *)field;
    if (!shared || atomic_fetch_sub_explicit(&shared->references, 1, memory_order_acq_rel) > 1)
        return;
    gd_mesh_release(shared->mesh);
    if (!shared->is_image && !shared->shown) free_arrays(shared);
    if (shared->release_image) shared->release_image(shared->image_user);
    if (!shared->shown) free(shared->face_seeds);
    gd_field_release(shared->shown);
    free(shared);
}

/* Copies all members except the reach and those that own memory. */
static void share_arrays(struct gd_field *to, const struct gd_field *from)
{
    to->shown = gd_field_retain(from);
    to->distance = from->distance;
    to->predecessor = from->predecessor;
    to->newest = from->newest;
    to->wedges = from->wedges;
    to->wedge_bytes = from->wedge_bytes;
    to->seeds = from->seeds;
    to->seed_count = from->seed_count;
    to->has_segments = from->has_segments;
    to->face_seeds = from->face_seeds;
    to->face_seed_count = from->face_seed_count;
    to->bytes = from->bytes;
    to->statistics = from->statistics;
}

enum gd_status gd_field_within(const struct gd_field *field, double radius, struct gd_field **out)
{
    if (!(radius > 0)) return GD_INVALID_ARGUMENT;
    double reach = radius / field->mesh->unit;
    if (reach >= field->reach) {
        *out = gd_field_retain(field);
        return GD_OK;
    }
    struct gd_field *view = gd__field_create(field->mesh);
    if (!view) return GD_NO_MEMORY;
    share_arrays(view, field);
    view->reach = reach;
    *out = view;
    return GD_OK;
}

size_t gd_field_memsize(const struct gd_field *field)
{
    return field->bytes;
}

const struct gd_mesh *gd_field_mesh(const struct gd_field *field)
{
    return field->mesh;
}

const struct gd_field_statistics *gd_field_statistics(const struct gd_field *field)
{
    return &field->statistics;
}

bool gd_field_single_seed(const struct gd_field *field, struct gd_point *out)
{
    if (field->seed_count != 1 || field->seeds[0].offset != 0 || field->seeds[0].is_segment)
        return false;
    *out = field->seeds[0].point;
    return true;
}

/* --- distances -------------------------------------------------------------------------------- */

double gd_field_reach(const struct gd_field *field)
{
    return field->reach < GD__FAR ? field->reach * field->mesh->unit : INFINITY;
}

enum gd_status gd_field_distance(const struct gd_field *field, const struct gd_point *point,
                                 double *out)
{
    struct gd__leg_key way;
    gd__field_leg_key(field, point, &way);
    if (way.distance > field->reach) return GD_BEYOND_REACH;
    *out = way.kind == GD__LEG_NONE ? INFINITY : way.distance * field->mesh->unit;
    return GD_OK;
}

void gd_field_vertex_distances(const struct gd_field *field, double *out)
{
    const struct gd_mesh *mesh = field->mesh;
    for (uint32_t i = 0; i < mesh->summary.index_count; i++) {
        uint32_t vertex = mesh->vertex_of_index[i];
        double distance = vertex == GD_NONE ? NAN : field->distance[vertex];
        out[i] = distance >= GD__FAR || distance > field->reach ? INFINITY : distance * mesh->unit;
    }
}
