#include "field/layout.h"

#include <stdlib.h>

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

/* Returns true if the distances of an edge's ends differ by more than the edge's length, within the
 * field's reach. If no edge breaks this law, every vertex within the reach has a distance. */
static bool breaks_law(const struct gd_field *field, uint32_t side)
{
    const struct gd_mesh *mesh = field->mesh;
    double a = field->distance[mesh->origin[side]], b = field->distance[mesh->origin[side + 1]];
    double nearer = a < b ? a : b, through = nearer + mesh->side[side].length;
    return nearer + fabs(a - b) > through * (1 + GD_TOL_CHECK) && through <= field->reach;
}

static bool obeys_law(const struct gd_field *field)
{
    for (uint32_t side = 0; side < 2 * field->mesh->edge_count; side += 2)
        if (breaks_law(field, side)) return false;
    return true;
}

/* Lowers the distance of an edge's farther end to that of the path along the edge, if this path is
 * shorter. Changes only edges that are shorter than the rounding error of the nearer end's
 * distance. */
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

/* Repairs distances in faces that are as small as the rounding error. If windows tie to the last
 * bit, rounding may discard all of them, and vertices keep a distance that is too long, or none. In
 * such small faces paths along edges are equally good. In larger faces, for example around a very
 * thin tube, such distances are not repaired, and the build fails. Distances only decrease, so the
 * loop ends. */
static enum gd_status mend_field(struct gd_field *field)
{
    bool is_mended = true;
    for (uint32_t pass = 0; is_mended && pass < field->mesh->vertex_count; pass++) {
        is_mended = false;
        for (uint32_t side = 0; side < 2 * field->mesh->edge_count; side += 2)
            if (breaks_law(field, side)) is_mended |= mend_edge(field, side);
    }
    return obeys_law(field) ? GD_OK : GD_INTERNAL;
}

enum gd_status gd__field_take(void *user, struct gd__wavefront *front)
{
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

void gd__field_view(const struct gd__wavefront *front, double reach, struct gd_field *view)
{
    const struct gd_workspace *work = front->work;
    view->mesh = front->mesh;
    view->reach = reach;
    view->distance = work->distance;
    view->predecessor = work->predecessor;
    view->newest = work->newest;
    view->wedges = work->wedges.base;
    view->wedge_bytes = work->wedges.used;
}

enum gd_status gd__field_propagate(struct gd_field *field,
                                   const struct gd__propagation *propagation,
                                   const struct gd_control *control)
{
    uint64_t start = gd_now_ns();
    struct gd__sink take = {.take = gd__field_take, .user = field};
    enum gd_status status = gd__wavefront_run(field->mesh, propagation, &take, control);
    if (!status && !obeys_law(field)) status = mend_field(field);
    field->bytes = gd__field_bytes(field);
    field->statistics.build_ns = gd_now_ns() - start;
    return status;
}

/* The arguments of gd_field_build and of gd_field_distances_only. */
struct build {
    const struct gd_mesh *mesh;
    const struct gd_field_request *request;
    const struct gd_control *control;
    struct gd_detail *detail;
    double *distances; /* NULL for gd_field_build */
    bool has_wedges;   /* false if only distances of vertices are needed */
};

/* A sink that evaluates the request's points. It leaves the arrays to the workspace, so that the
 * next propagation uses the same memory. If distances must be mended, the field takes the
 * arrays. */
struct points_sink {
    const struct build *build;
    struct gd_field *field;
};

static enum gd_status evaluate_points(void *user, struct gd__wavefront *front)
{
    const struct points_sink *sink = user;
    const struct gd_field_request *request = sink->build->request;
    struct gd_field *field = sink->field, view = {.seeds = field->seeds,
                                                  .seed_count = field->seed_count,
                                                  .has_segments = field->has_segments,
                                                  .face_seeds = field->face_seeds,
                                                  .face_seed_count = field->face_seed_count};
    enum gd_status status = GD_OK;
    gd__field_view(front, front->bound, &view);
    bool is_lawful = obeys_law(&view);
    if (!is_lawful) status = gd__field_take(field, front);
    if (!is_lawful && !status) status = mend_field(field);
    return status ? status
                  : gd_field_distances(is_lawful ? &view : field, request->points,
                                       request->point_count, sink->build->control,
                                       sink->build->distances);
}

static enum gd_status build_once(const struct build *build, struct gd__variant variant,
                                 struct gd_field **out)
{
    const struct gd_field_request *request = build->request;
    enum gd_status status = check_request(request, build->detail);
    if (status) return status;
    struct gd_field *field = gd__field_create(build->mesh);
    if (!field) return gd_fail_status(build->detail, GD_NO_MEMORY);
    status = gd__field_take_seeds(field, request, build->detail);
    if (!status) {
        struct gd__propagation propagation = {
            .seeds = field->seeds,
            .seed_count = field->seed_count,
            .radius = request->radius > 0 ? request->radius / field->mesh->unit : GD__FAR,
            .target = request->target,
            .points = build->distances ? request->points : NULL,
            .point_count = build->distances ? request->point_count : 0,
            .without_wedges = !build->has_wedges,
            .variant = variant};
        struct points_sink evaluation = {build, field};
        status = build->distances && build->has_wedges
                     ? gd__wavefront_run(field->mesh, &propagation,
                                         &(struct gd__sink){evaluate_points, &evaluation},
                                         build->control)
                     : gd__field_propagate(field, &propagation, build->control);
        if (status) gd_fail_status(build->detail, status);
    }
    if (status)
        gd_field_release(field);
    else
        *out = field;
    return status;
}

/* If the check fails, builds the field again by another variant of the propagation, in which
 * rounding discards other windows. */
static enum gd_status build_somehow(const struct build *build, struct gd_field **out)
{
    const struct gd__variant variants[] = {{0},
                                           {.no_coalescing = true},
                                           {.no_cone = true},
                                           {.no_coalescing = true, .no_filter = true}};
    enum gd_status status = GD_INTERNAL;
    for (size_t i = 0; i < sizeof variants / sizeof *variants && status == GD_INTERNAL; i++)
        status = build_once(build, variants[i], out);
    return status;
}

enum gd_status gd_field_build(const struct gd_mesh *mesh, const struct gd_field_request *request,
                              const struct gd_control *control, struct gd_field **out,
                              struct gd_detail *detail)
{
    const struct build build = {mesh, request, control, detail, NULL, true};
    return build_somehow(&build, out);
}

static bool all_are_vertices(const struct gd_field_request *request)
{
    uint32_t i = 0;
    while (i < request->point_count && request->points[i].kind == GD_POINT_VERTEX) i++;
    return i == request->point_count;
}

enum gd_status gd_field_distances_only(const struct gd_mesh *mesh,
                                       const struct gd_field_request *request,
                                       const struct gd_control *control, double *out,
                                       struct gd_detail *detail)
{
    const struct build build = {mesh, request, control, detail, out, !all_are_vertices(request)};
    struct gd_field *field = NULL;
    enum gd_status status = build_somehow(&build, &field);
    if (!status && !request->points) gd_field_vertex_distances(field, out);
    if (!status && request->points && !build.has_wedges)
        status = gd_field_distances(field, request->points, request->point_count, control, out);
    gd_field_release(field);
    return status;
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

struct gd_field *gd_field_retain(const struct gd_field *field)
{
    gd__references_add(&field->references);
    return (struct gd_field *)field;
}

void gd_field_release(const struct gd_field *field)
{
    if (!field || !gd__references_drop(&field->references)) return;
    struct gd_field *shared = (struct gd_field *)field;
    gd_mesh_release(shared->mesh);
    if (!shared->is_image && !shared->shown) {
        free(shared->distance);
        free(shared->predecessor);
        free(shared->newest);
        gd__region_release(&shared->kept);
        free(shared->seeds);
    }
    if (shared->release_image) shared->release_image(shared->image_user);
    if (!shared->shown) free(shared->face_seeds);
    gd_field_release(shared->shown);
    free(shared);
}

/* Copies all members except the reach, and except the members that own memory. */
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

struct gd__levels gd__field_face_levels(const struct gd_field *field, uint32_t face)
{
    const struct gd_mesh *mesh = field->mesh;
    const uint32_t *side = mesh->face_side[face];
    const struct gd_side *s = &mesh->side[side[0]];
    const double length[3] = {s->length, s->right_length, s->left_length};
    struct gd__levels levels = {0, GD__FAR};
    for (int k = 0; k < 3; k++) {
        double distance = field->distance[mesh->origin[side[k]]], before = length[(k + 2) % 3],
               reach = length[k] > before ? length[k] : before;
        levels.least = levels.least > distance ? levels.least : distance;
        levels.most = levels.most < distance + reach ? levels.most : distance + reach;
    }
    return levels;
}

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
