#include "render/camera.h"

#include <float.h>

/* If the sine of the angle between `up` and the line of sight is below this, `up` is not used. */
#define PARALLEL 1e-6
/* Points of layers enlarge the view up to this distance beyond the surface, relative to the
 * surface's size. The control mesh of a tetrahedron is about four times as large as its limit
 * surface. */
#define BEYOND 2

static const struct gd_vec3 x_axis = {1, 0, 0}, y_axis = {0, 1, 0};

/* The axes to which the names of views refer. */
struct frame {
    struct gd_vec3 right, up, front;
};

static struct frame frame_of(struct gd_vec3 up)
{
    bool is_zero = up.x == 0 && up.y == 0 && up.z == 0;
    struct frame frame = {.up = is_zero ? y_axis : gd_vec3_unit(up)};
    struct gd_vec3 right = gd_vec3_along(x_axis, -gd_vec3_dot(x_axis, frame.up), frame.up);
    if (gd_vec3_length(right) < PARALLEL)
        right = gd_vec3_along(y_axis, -gd_vec3_dot(y_axis, frame.up), frame.up);
    frame.right = gd_vec3_unit(right);
    frame.front = gd_vec3_cross(frame.right, frame.up);
    return frame;
}

struct gd_vec3 gd__view_from(double azimuth, double elevation, struct gd_vec3 up)
{
    struct frame frame = frame_of(up);
    struct gd_vec3 level =
        gd_vec3_along(gd_vec3_scale(frame.front, cos(azimuth)), sin(azimuth), frame.right);
    return gd_vec3_along(gd_vec3_scale(level, cos(elevation)), sin(elevation), frame.up);
}

struct gd_vec3 gd__view_direction(enum gd_view view, struct gd_vec3 up)
{
    static const double quarter = M_PI / 2, iso_azimuth = M_PI / 6, iso_elevation = 0.45;
    struct frame frame = frame_of(up);
    switch (view) {
    case GD_VIEW_FRONT:
        return frame.front;
    case GD_VIEW_BACK:
        return gd_vec3_scale(frame.front, -1);
    case GD_VIEW_LEFT:
        return gd__view_from(-quarter, 0, up);
    case GD_VIEW_RIGHT:
        return gd__view_from(quarter, 0, up);
    case GD_VIEW_TOP:
        return frame.up;
    case GD_VIEW_BOTTOM:
        return gd_vec3_scale(frame.up, -1);
    default:
        return gd__view_from(iso_azimuth, iso_elevation, up);
    }
}

struct gd__camera gd__camera_aim(const struct gd_mesh *mesh, struct gd_vec3 towards,
                                 struct gd_vec3 up)
{
    struct frame frame = frame_of(up);
    struct gd__camera camera = {.towards = gd_vec3_unit(towards), .scale = 1};
    struct gd_vec3 right = gd_vec3_cross(frame.up, camera.towards);
    camera.right = gd_vec3_length(right) < PARALLEL ? frame.right : gd_vec3_unit(right);
    camera.up = gd_vec3_unit(gd_vec3_cross(camera.towards, camera.right));
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    camera.centre = gd_vec3_along(gd_vec3_scale(summary->min, 0.5 / mesh->unit), 0.5 / mesh->unit,
                                  summary->max);
    return camera;
}

struct extent {
    double left, right, bottom, top; /* normalised unit */
};

static void extent_add(struct extent *extent, double x, double y)
{
    if (x < extent->left) extent->left = x;
    if (x > extent->right) extent->right = x;
    if (y < extent->bottom) extent->bottom = y;
    if (y > extent->top) extent->top = y;
}

/* Adds the points of a layer. A point outside `most` counts as one on its border. */
static void extent_add_layer(struct extent *extent, const struct extent *most,
                             const struct gd__camera *camera, double unit,
                             const struct gd_picture_layer *layer)
{
    uint32_t count = layer->first ? layer->first[layer->count] : layer->count;
    for (uint32_t i = 0; i < count; i++) {
        struct gd_vec3 at = gd_vec3_sub(gd_vec3_scale(layer->points[i], 1 / unit), camera->centre);
        double x = gd_vec3_dot(at, camera->right), y = gd_vec3_dot(at, camera->up);
        extent_add(extent, fmin(fmax(x, most->left), most->right),
                   fmin(fmax(y, most->bottom), most->top));
    }
}

void gd__camera_fit(struct gd__camera *camera, const struct gd_mesh *mesh,
                    const struct gd_picture_layer *layers, uint32_t layer_count,
                    const struct gd__viewport *window)
{
    struct extent e = {DBL_MAX, -DBL_MAX, DBL_MAX, -DBL_MAX};
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        struct gd_vec3 at = gd_vec3_sub(mesh->position[v], camera->centre);
        extent_add(&e, gd_vec3_dot(at, camera->right), gd_vec3_dot(at, camera->up));
    }
    double more = BEYOND * fmax(e.right - e.left, e.top - e.bottom);
    const struct extent most = {e.left - more, e.right + more, e.bottom - more, e.top + more};
    for (uint32_t i = 0; i < layer_count; i++)
        extent_add_layer(&e, &most, camera, mesh->unit, &layers[i]);
    camera->scale = fmin(window->width / (e.right - e.left), window->height / (e.top - e.bottom));
    camera->x = window->left + 0.5 * window->width - 0.5 * (e.left + e.right) * camera->scale;
    camera->y = window->top + 0.5 * window->height + 0.5 * (e.bottom + e.top) * camera->scale;
}

void gd__camera_zoom(struct gd__camera *camera, const struct gd__viewport *window, double zoom,
                     const struct gd_vec3 *middle)
{
    double x = window->left + 0.5 * window->width, y = window->top + 0.5 * window->height;
    camera->scale *= zoom;
    camera->x = x + zoom * (camera->x - x);
    camera->y = y + zoom * (camera->y - y);
    if (!middle) return;
    struct gd_vec3 at = gd_vec3_scale(gd_vec3_sub(*middle, camera->centre), camera->scale);
    camera->x = x - gd_vec3_dot(at, camera->right);
    camera->y = y + gd_vec3_dot(at, camera->up);
}

struct gd__screen_point gd__camera_project(const struct gd__camera *camera, struct gd_vec3 position)
{
    struct gd_vec3 at = gd_vec3_scale(gd_vec3_sub(position, camera->centre), camera->scale);
    return (struct gd__screen_point){(float)(camera->x + gd_vec3_dot(at, camera->right)),
                                     (float)(camera->y - gd_vec3_dot(at, camera->up)),
                                     (float)-gd_vec3_dot(at, camera->towards)};
}
