#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "subdiv/tracer.h"

void gd_limit_path_free(struct gd_limit_path *path)
{
    if (!path) return;
    free(path->steps);
    *path = (struct gd_limit_path){0};
}

/* A path that is being traced. */
struct line {
    struct gd_limit_path path;
    uint32_t capacity;
};

static enum gd_status limit_trace_append(struct line *line, const struct gd__tracer *tracer,
                                         const struct gd__face_place *local,
                                         const struct gd_control *control)
{
    struct gd_limit_path *path = &line->path;
    enum gd_status status = gd__array_extend(&path->steps, &line->capacity, path->step_count + 1ULL,
                                             sizeof *path->steps, control);
    if (status) return status;
    path->steps[path->step_count++] = (struct gd_limit_step){
        gd__place_of(tracer->walker->surface, local), tracer->position, path->length};
    return GD_OK;
}

/* Makes steps until the path has the requested length or cannot continue. */
static enum gd_status limit_trace_follow(struct gd__tracer *tracer, double length,
                                         const struct gd_control *control, struct line *line)
{
    struct gd_limit_path *path = &line->path;
    enum gd_status status = GD_OK;
    while (!status && !tracer->ended && path->length < length) {
        if (path->step_count % 8 == 1) status = gd_control_check(control, path->length / length);
        if (!status) status = gd__tracer_step(tracer, length - path->length, &path->length);
        if (!status) status = limit_trace_append(line, tracer, &tracer->local, control);
        if (!status && path->step_count >= GD_LIMIT_STEPS) {
            tracer->ended = true;
            tracer->end = GD_LIMIT_END_STEPS;
        }
    }
    path->end = tracer->ended ? tracer->end : GD_LIMIT_END_LENGTH;
    path->direction = tracer->direction;
    return status;
}

static enum gd_status limit_trace_check(const struct gd_subdivision *surface,
                                        struct gd_limit_point *start, struct gd_vec3 direction,
                                        double length, struct gd_detail *detail)
{
    if (!(length >= 0 && length < INFINITY))
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "the length is %g: it must be at least 0 and finite", length);
    double size = gd_vec3_length(direction);
    if (!(size > 0 && size < INFINITY))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the direction must be finite and not zero");
    return gd__place_check(surface, start, detail);
}

enum gd_status gd_limit_trace(const struct gd_subdivision *surface,
                              const struct gd_limit_trace_request *request,
                              const struct gd_control *control, struct gd_limit_path *out,
                              struct gd_detail *detail)
{
    struct gd_limit_point place = request->start;
    struct gd_vec3 direction = request->direction;
    double length = request->length;
    enum gd_status status = limit_trace_check(surface, &place, direction, length, detail);
    if (status) return status;
    struct gd__walker walker;
    status = gd__walker_create(&walker, surface, 3, control);
    if (status) return status;
    struct gd__tracer tracer;
    struct line line = {0};
    struct gd__face_place local = gd__face_place_of(surface, &place);
    status = gd__tracer_start(&tracer, &walker, &local,
                              gd_vec3_scale(direction, 1 / gd_vec3_length(direction)));
    if (status == GD_INVALID_ARGUMENT)
        gd_fail(detail, status,
                "the direction is normal to the surface: choose one with a part along it");
    if (!status) status = limit_trace_append(&line, &tracer, &local, control);
    if (!status) status = limit_trace_follow(&tracer, length, control, &line);
    if (status == GD_INTERNAL)
        gd_fail(detail, status,
                "the geodesic can't be followed beyond %g of its length, in face %u: control "
                "points all but coincide there",
                line.path.length, line.path.steps[line.path.step_count - 1].place.face);
    gd__walker_free(&walker);
    if (status)
        gd_limit_path_free(&line.path);
    else
        *out = line.path;
    return status;
}
