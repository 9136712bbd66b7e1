#include "field/path_builder.h"

#include "base/array.h"
#include "mesh/canonical.h"

#define CAPACITY 128 /* initial capacity in points */

bool gd__path_builder_grow(struct gd__path_builder *builder)
{
    builder->status = gd__array_extend(&builder->path.points, &builder->capacity,
                                       builder->path.count + (uint64_t)CAPACITY,
                                       sizeof *builder->path.points, NULL);
    return !builder->status;
}

/* Returns true if both are the same point up to rounding, for instance the start of a ray on an
 * edge and its first crossing. */
static bool is_same_place(const struct gd_point *a, const struct gd_point *b)
{
    if (a->kind != GD_POINT_EDGE || b->kind != GD_POINT_EDGE || a->element != b->element)
        return gd_point_equal(a, b);
    return fabs(a->weight[0] - b->weight[0]) <= GD_TOL_ON_BORDER;
}

static void push_point(struct gd__path_builder *builder, struct gd_point point, double length)
{
    if (!gd__path_builder_reserve(builder)) return;
    builder->path.points[builder->path.count++] = point;
    builder->path.length += length;
}

void gd__path_builder_append(struct gd__path_builder *builder, struct gd_point point, double length)
{
    struct gd_path *path = &builder->path;
    if (builder->status || (path->count && is_same_place(&path->points[path->count - 1], &point)))
        return;
    push_point(builder, point, length);
}

/* For short segments, differences of weights in the frame of the nearest corner are exact. */
double gd__path_builder_run(const struct gd__path_builder *builder, const struct gd_point *point,
                            uint32_t face)
{
    double from[3], to[3];
    gd__point_weights(builder->mesh, &builder->path.points[builder->path.count - 1], face, from);
    gd__point_weights(builder->mesh, point, face, to);
    return gd__local_length(
        gd__leg_key_in_face(builder->mesh, face, gd__main_corner(from), from, to));
}

void gd__path_builder_append_in_face(struct gd__path_builder *builder, struct gd_point point,
                                     uint32_t face)
{
    if (!builder->status)
        gd__path_builder_append(builder, point, gd__path_builder_run(builder, &point, face));
}

void gd__path_builder_append_seed(struct gd__path_builder *builder, uint32_t seed, uint32_t face)
{
    struct gd_point point = builder->field->seeds[seed].point;
    if (builder->status || gd_point_equal(&builder->path.points[builder->path.count - 1], &point))
        return;
    push_point(builder, point, gd__path_builder_run(builder, &point, face));
}

struct gd_point gd__path_builder_side_point(const struct gd__path_builder *builder, uint32_t side,
                                            double t)
{
    const struct gd_mesh *mesh = builder->mesh;
    double length = mesh->side[side].length;
    if (t <= builder->snap * length) return gd__point_of_vertex(mesh->origin[side]);
    if (t >= (1 - builder->snap) * length) return gd__point_of_vertex(mesh->origin[side ^ 1]);
    return gd__point_within_side(side, t / length);
}
