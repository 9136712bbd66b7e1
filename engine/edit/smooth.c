/* Smoothing: Jacobi steps towards the mean of the neighbours (the uniform Laplacian). A step uses
 * the component in the tangent plane, the component along the normal, or both. OpenMesh's smoother
 * is not used because it cannot be stopped. */
#include <stdlib.h>

#include "base/arena.h"
#include "base/slices.h"
#include "edit/edited.h"
#include "mesh/topology.h"

/* A step moves a vertex by this fraction of the distance to the mean. Full steps may oscillate. */
#define STEP 0.5

struct smoothing {
    const struct gd_mesh *mesh;
    const struct gd_smooth_options *options;
    struct gd__pace pace;
    struct gd__arena arena;
    struct gd_vec3 *place, *next; /* per internal vertex */
    bool *is_fixed;               /* per internal vertex */
    bool *is_feature;             /* per edge: its ends are fixed */
};

static struct gd_vec3 face_normal(const struct gd_mesh *mesh, const struct gd_vec3 *place,
                                  uint32_t face)
{
    struct gd_vec3 p[3];
    for (int k = 0; k < 3; k++) p[k] = place[mesh->origin[mesh->face_side[face][k]]];
    return gd_vec3_cross(gd_vec3_sub(p[1], p[0]), gd_vec3_sub(p[2], p[0]));
}

/* Finds the edges of the boundary and the sharp edges. An edge is sharp if the angle between its
 * faces exceeds options->feature_angle. */
static void find_features(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    const struct smoothing *smoothing = context;
    const struct gd_mesh *mesh = smoothing->mesh;
    double least = cos(smoothing->options->feature_angle);
    for (uint32_t e = begin; e < end && gd__pace(pace, 1); e++) {
        uint32_t left = mesh->side_face[2 * e], right = mesh->side_face[2 * e + 1];
        bool is_feature = left == GD_NONE || right == GD_NONE;
        if (!is_feature) {
            struct gd_vec3 a = face_normal(mesh, mesh->position, left);
            struct gd_vec3 b = face_normal(mesh, mesh->position, right);
            is_feature = gd_vec3_dot(a, b) < least * gd_vec3_length(a) * gd_vec3_length(b);
        }
        smoothing->is_feature[e] = is_feature;
    }
}

/* Fixes the ends of the edges that find_features finds. */
static void fix_vertices(struct smoothing *smoothing)
{
    const struct gd_mesh *mesh = smoothing->mesh;
    gd__slices_run(&smoothing->pace, mesh->edge_count, find_features, smoothing);
    if (smoothing->pace.status) return;
    GD__PACED (&smoothing->pace, e, mesh->edge_count)
        for (uint32_t k = 0; k < 2 && smoothing->is_feature[e]; k++)
            smoothing->is_fixed[mesh->origin[2 * e + k]] = true;
}

static struct gd_vec3 moved(const struct smoothing *smoothing, uint32_t vertex)
{
    const struct gd_mesh *mesh = smoothing->mesh;
    enum gd_smooth_direction direction = smoothing->options->direction;
    struct gd_vec3 p = smoothing->place[vertex], sum = {0}, normal = {0};
    uint32_t first = mesh->fan_first[vertex], end = mesh->fan_first[vertex + 1];
    for (uint32_t i = first; i < end; i++) {
        uint32_t face = mesh->side_face[mesh->fan[i].side];
        sum = gd_vec3_add(sum, smoothing->place[mesh->fan[i].tip]);
        if (direction == GD_SMOOTH_BOTH) continue;
        normal = gd_vec3_add(normal, face_normal(mesh, smoothing->place, face));
    }
    struct gd_vec3 way = gd_vec3_sub(gd_vec3_scale(sum, 1.0 / (end - first)), p);
    double square = gd_vec3_dot(normal, normal);
    struct gd_vec3 along =
        square > 0 ? gd_vec3_scale(normal, gd_vec3_dot(way, normal) / square) : (struct gd_vec3){0};
    if (direction == GD_SMOOTH_TANGENTIAL) way = gd_vec3_sub(way, along);
    if (direction == GD_SMOOTH_NORMAL) way = along;
    return gd_vec3_add(p, gd_vec3_scale(way, STEP));
}

static void move_vertices(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    const struct smoothing *smoothing = context;
    for (uint32_t v = begin; v < end && gd__pace(pace, 7); v++)
        smoothing->next[v] = smoothing->is_fixed[v] ? smoothing->place[v] : moved(smoothing, v);
}

static void iterate(struct smoothing *smoothing)
{
    gd__slices_run(&smoothing->pace, smoothing->mesh->vertex_count, move_vertices, smoothing);
    struct gd_vec3 *place = smoothing->place;
    smoothing->place = smoothing->next;
    smoothing->next = place;
}

static enum gd_status write(struct smoothing *smoothing, struct gd_edited *out)
{
    const struct gd_mesh *mesh = smoothing->mesh;
    /* this memory is no longer needed, so it is reused for the numbers */
    uint32_t *number = (uint32_t *)(void *)smoothing->next;
    struct gd_edited made;
    enum gd_status status = gd__edited_allocate(&made, mesh->vertex_count, mesh->face_count);
    if (status) return status;
    gd__edited_copy(&made, mesh, number, &smoothing->pace);
    for (uint32_t v = 0; v < mesh->vertex_count && gd__pace(&smoothing->pace, 1); v++) {
        struct gd_vec3 p = gd_vec3_scale(smoothing->place[v], mesh->unit);
        if (!smoothing->is_fixed[v]) memcpy(made.polygons.positions[number[v]], &p, sizeof p);
    }
    if (smoothing->pace.status)
        gd_edited_free(&made);
    else
        *out = made;
    return smoothing->pace.status;
}

static enum gd_status check_options(const struct gd_smooth_options *options,
                                    struct gd_detail *detail)
{
    if (options->iterations < 1 || options->iterations > GD_SMOOTH_ITERATIONS_MOST)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "iterations = %u is not 1 to %d",
                       options->iterations, GD_SMOOTH_ITERATIONS_MOST);
    if (!(options->feature_angle >= 0 && options->feature_angle <= acos(-1)))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "feature_angle = %.17g is not 0 to pi",
                       options->feature_angle);
    return GD_OK;
}

static enum gd_status smoothing_run(struct smoothing *smoothing, struct gd_edited *out)
{
    const struct gd_mesh *mesh = smoothing->mesh;
    size_t bytes = mesh->vertex_count * sizeof *smoothing->place;
    smoothing->place = gd__arena_take(&smoothing->arena, bytes, 1);
    smoothing->next = gd__arena_take(&smoothing->arena, bytes, 1);
    smoothing->is_fixed =
        gd__arena_zeroed(&smoothing->arena, mesh->vertex_count, sizeof *smoothing->is_fixed);
    smoothing->is_feature =
        gd__arena_take(&smoothing->arena, mesh->edge_count, sizeof *smoothing->is_feature);
    if (smoothing->arena.status) return smoothing->arena.status;
    memcpy(smoothing->place, mesh->position, bytes);
    fix_vertices(smoothing);
    for (uint32_t i = 0; i < smoothing->options->iterations && !smoothing->pace.status; i++) {
        smoothing->pace.fraction = i / (double)smoothing->options->iterations;
        iterate(smoothing);
    }
    return smoothing->pace.status ? smoothing->pace.status : write(smoothing, out);
}

enum gd_status gd_smooth_mesh(const struct gd_mesh *mesh, const struct gd_smooth_options *options,
                              const struct gd_control *control, struct gd_edited *out,
                              struct gd_detail *detail)
{
    struct smoothing smoothing = {.mesh = mesh, .options = options, .pace = {.control = control}};
    enum gd_status status = check_options(options, detail);
    if (!status) status = gd_control_afford(control, gd_edit_cost(mesh->face_count));
    if (!status) status = smoothing_run(&smoothing, out);
    gd__arena_free(&smoothing.arena);
    return status;
}
