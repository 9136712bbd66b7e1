#include "render/view.h"

#include <stdlib.h>

#define ENOUGH 0.95 /* visible fraction at which the search stops */
/* a view replaces the best one only if its visible fraction is larger by more than this */
#define BETTER 0.05

#define END_PART 0.1 /* weight of the visibility of each end */

/* viewport in a picture of 240 x 180 pixels */
static const struct gd__viewport sketch = {4, 4, 232, 172};

struct angles {
    double azimuth, elevation; /* degrees */
};

/* Views to try after iso, in order of their difference from iso. */
static const struct angles angles[] = {{-30, 26},  {75, 26},  {-75, 26}, {30, 55},   {120, 26},
                                       {-120, 26}, {0, 75},   {165, 26}, {-165, 26}, {30, -26},
                                       {-30, -26}, {120, 55}, {-90, 55}, {120, -26}, {-120, -26}};

struct chooser {
    const struct gd_mesh *mesh;
    struct gd_vec3 up;
    const struct gd__subject *subject;
    struct gd__budget *budget;
    struct gd__screen_point *points, *line;
};

static double path_seen(const struct chooser *chooser, const struct gd__depth_buffer *buffer)
{
    uint32_t count = chooser->subject->count;
    return (1 - 2 * END_PART) * gd__depth_buffer_visibility(buffer, chooser->line, count) +
           END_PART * gd__depth_buffer_visibility(buffer, chooser->line, 1) +
           END_PART * gd__depth_buffer_visibility(buffer, chooser->line + count - 1, 1);
}

static double points_seen(const struct chooser *chooser, const struct gd__depth_buffer *buffer)
{
    uint32_t count = chooser->subject->count;
    double sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += gd__depth_buffer_visibility(buffer, chooser->line + i, 1);
    return sum / count;
}

static enum gd_status sketch_view(const struct chooser *chooser, const struct gd_control *control,
                                  struct gd__raster *raster, double *seen)
{
    enum gd_status status = gd__raster_open(raster, control);
    if (!status) status = gd__raster_fill(raster, 0, control);
    if (status) return status;
    const struct gd__depth_buffer buffer = {.mesh = chooser->mesh,
                                            .points = chooser->points,
                                            .width = raster->width,
                                            .height = raster->height,
                                            .depth = raster->depth,
                                            .face = raster->face};
    *seen = chooser->subject->is_path ? path_seen(chooser, &buffer) : points_seen(chooser, &buffer);
    return GD_OK;
}

/* Computes how much of the path is visible from a direction. */
static enum gd_status try_view(const struct chooser *chooser, struct gd_vec3 direction,
                               const struct gd_control *control, double *seen)
{
    const struct gd_mesh *mesh = chooser->mesh;
    struct gd__camera camera = gd__camera_aim(mesh, direction, chooser->up);
    /* a copy of the budget, because the sketch frees all its memory */
    struct gd__budget budget = *chooser->budget;
    gd__camera_fit(&camera, mesh, NULL, 0, &sketch);
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        chooser->points[v] = gd__camera_project(&camera, mesh->position[v]);
    for (uint32_t i = 0; i < chooser->subject->count; i++)
        chooser->line[i] = gd__camera_project(&camera, chooser->subject->points[i]);
    struct gd__raster raster = {.mesh = mesh,
                                .points = chooser->points,
                                .width = (uint32_t)(sketch.width + 2 * sketch.left),
                                .height = (uint32_t)(sketch.height + 2 * sketch.top),
                                .grid = 1,
                                .rows = UINT32_MAX,
                                .budget = &budget};
    enum gd_status status = sketch_view(chooser, control, &raster, seen);
    gd__raster_close(&raster);
    return status;
}

static enum gd_status view_choose(const struct chooser *chooser, const struct gd_control *control,
                                  struct gd_vec3 *out)
{
    struct gd_vec3 direction = gd__view_direction(GD_VIEW_ISO, chooser->up);
    double seen, most = -1;
    *out = direction;
    for (uint32_t i = 0; i <= sizeof angles / sizeof *angles && most < ENOUGH; i++) {
        if (i > 0)
            direction = gd__view_from(angles[i - 1].azimuth * M_PI / 180,
                                      angles[i - 1].elevation * M_PI / 180, chooser->up);
        enum gd_status status = try_view(chooser, direction, control, &seen);
        if (status) return status;
        if (seen <= most + BETTER) continue;
        most = seen;
        *out = direction;
    }
    return GD_OK;
}

enum gd_status gd__view_choose(const struct gd_mesh *mesh, struct gd_vec3 up,
                               const struct gd__subject *subject, struct gd__budget *budget,
                               const struct gd_control *control, struct gd_vec3 *out)
{
    struct chooser chooser = {.mesh = mesh, .up = up, .subject = subject, .budget = budget};
    struct gd_vec3 direction;
    enum gd_status status = gd__budget_take(budget, ((size_t)mesh->vertex_count + subject->count) *
                                                        sizeof(struct gd__screen_point));
    if (status) return status;
    chooser.points = malloc(mesh->vertex_count * sizeof *chooser.points);
    chooser.line = malloc(subject->count * sizeof *chooser.line);
    status =
        chooser.points && chooser.line ? view_choose(&chooser, control, &direction) : GD_NO_MEMORY;
    free(chooser.points);
    free(chooser.line);
    if (!status) *out = direction;
    return status;
}
