#include "transport/meetings.h"

#include <stdlib.h>
#include <string.h>

#include "base/arena.h"
#include "base/tolerance.h"

/* A segment, in the frame of its face's side 0. */
struct segment {
    struct gd__local from, to;
    uint32_t before; /* the previous segment in the same face, or GD_NONE if there is none */
};

struct gd__meetings {
    const struct gd_mesh *mesh;
    struct gd__arena arena;
    uint32_t *newest; /* for each face, its latest segment */
    bool *is_met;     /* for each vertex, true if the line has passed through it */
    struct segment *segments;
    uint32_t count, capacity;
};

void gd__meetings_destroy(struct gd__meetings *meetings)
{
    if (!meetings) return;
    gd__arena_free(&meetings->arena);
    free(meetings);
}

enum gd_status gd__meetings_create(const struct gd_mesh *mesh, const struct gd_point *start,
                                   const struct gd_control *control, struct gd__meetings **out)
{
    struct gd__meetings *meetings = calloc(1, sizeof *meetings);
    if (!meetings) return GD_NO_MEMORY;
    struct gd__arena *arena = &meetings->arena;
    meetings->mesh = mesh;
    arena->budget.control = control;
    meetings->newest = gd__arena_take(arena, mesh->face_count, sizeof *meetings->newest);
    meetings->is_met = gd__arena_zeroed(arena, mesh->vertex_count, sizeof *meetings->is_met);
    if (arena->status) {
        enum gd_status status = arena->status;
        gd__meetings_destroy(meetings);
        return status;
    }
    memset(meetings->newest, 0xff,
           mesh->face_count * sizeof *meetings->newest); /* sets all entries to GD_NONE */
    if (start->kind == GD_POINT_VERTEX) meetings->is_met[start->element] = true;
    *out = meetings;
    return GD_OK;
}

/* --- two segments ----------------------------------------------------------------------------- */

/* For segments on the same line: returns the fraction of `a` at which it first overlaps `b`, or 2
 * if they do not overlap. */
static double meet_along(const struct segment *a, const struct segment *b)
{
    struct gd__local d = gd__local_minus(a->to, a->from), w = gd__local_minus(b->from, a->from),
                     e = gd__local_minus(b->to, a->from);
    double length = gd__local_dot(d, d), touch = GD_TOL_TOUCH * length;
    if (fabs(gd__local_cross(d, w)) > touch || fabs(gd__local_cross(d, e)) > touch) return 2;
    double first = fmin(gd__local_dot(d, w), gd__local_dot(d, e)) / length,
           last = fmax(gd__local_dot(d, w), gd__local_dot(d, e)) / length;
    if (last <= GD_TOL_TOUCH || first > 1 + GD_TOL_TOUCH) return 2;
    return fmax(first, GD_TOL_TOUCH);
}

/* Returns the fraction of `a` at which it meets `b`, or 2 if they do not meet. */
static double meetings_meet(const struct segment *a, const struct segment *b)
{
    struct gd__local d = gd__local_minus(a->to, a->from), e = gd__local_minus(b->to, b->from),
                     w = gd__local_minus(b->from, a->from);
    double sine = gd__local_cross(d, e), lengths = sqrt(gd__local_dot(d, d) * gd__local_dot(e, e));
    if (!(lengths > 0)) return 2;
    if (fabs(sine) <= GD_TOL_TOUCH * lengths) return meet_along(a, b);
    double part = gd__local_cross(w, e) / sine, other = gd__local_cross(w, d) / sine;
    if (part <= GD_TOL_TOUCH || part > 1 + GD_TOL_TOUCH) return 2;
    return other >= -GD_TOL_TOUCH && other <= 1 + GD_TOL_TOUCH ? part : 2;
}

/* --- the line --------------------------------------------------------------------------------- */

static struct gd__local meetings_place(const struct gd_mesh *mesh, uint32_t face,
                                       const struct gd_point *point)
{
    double weight[3];
    gd__point_weights(mesh, point, face, weight);
    return gd__face_local(mesh, mesh->face_side[face][0], weight);
}

enum gd_status gd__meetings_add(struct gd__meetings *meetings, uint32_t face,
                                const struct gd_point *from, const struct gd_point *to,
                                double *part)
{
    struct segment segment = {meetings_place(meetings->mesh, face, from),
                              meetings_place(meetings->mesh, face, to), meetings->newest[face]};
    double first = 2;
    for (uint32_t i = segment.before; i != GD_NONE; i = meetings->segments[i].before)
        first = fmin(first, meetings_meet(&segment, &meetings->segments[i]));
    if (to->kind == GD_POINT_VERTEX) {
        if (meetings->is_met[to->element]) first = fmin(first, 1);
        meetings->is_met[to->element] = true;
    }
    meetings->newest[face] = meetings->count;
    *part = first > 1 && first < 2 ? 1 : first;
    return gd__arena_append(&meetings->arena, &meetings->segments, &meetings->count,
                            &meetings->capacity, &segment, sizeof segment);
}
