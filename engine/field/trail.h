/* Trail: the polyline that back-tracing makes, point by point (trace.c).
 *
 * Inside unit and numbering of the mesh. The first failure is kept in the status, and nothing is
 * appended after it. */
#ifndef GD_FIELD_TRAIL_H
#define GD_FIELD_TRAIL_H

#include "field/layout.h"

struct gd__trail {
    const struct gd_field *field;
    const struct gd_mesh *mesh;
    struct gd_path path; /* the caller's in the end */
    uint32_t capacity;
    double snap; /* part of an edge within which a crossing is at its end */
    /* GD_TOL_ASIDE_LEAST or more: the rays are careful (ray.c); 0: they are not */
    double aside;
    uint32_t vertex; /* the last one that the path went through; GD_NONE: none yet */
    double nearest;  /* distance of the point at which the leg began */
    /* a shortest path crosses no face twice: more steps are an error, not a longer walk */
    uint64_t steps_left;
    enum gd_status status;
};

/* Room for some points more; false, and the status says so, without memory. */
bool gd__trail_grow(struct gd__trail *trail);

/* The same for one point. */
static inline bool gd__trail_reserve(struct gd__trail *trail)
{
    return trail->path.count < trail->capacity || gd__trail_grow(trail);
}

/* Appends a point, unless it is the last one again, to which it is so far. */
void gd__trail_append(struct gd__trail *trail, struct gd_point point, double length);

/* Distance between a point of a face and the last point, which lies in that face too. */
double gd__trail_run(const struct gd__trail *trail, const struct gd_point *point, uint32_t face);

/* Appends a point of a face in which the last point lies too. The length is that of the segment
 * itself, measured in the face: nothing of the distances that the wedges gave enters it, so that
 * the two can be compared. */
void gd__trail_append_in_face(struct gd__trail *trail, struct gd_point point, uint32_t face);

/* Appends a point seed of such a face, the end of the path, however near it is. */
void gd__trail_append_seed(struct gd__trail *trail, uint32_t seed, uint32_t face);

/* The point at parameter t of a side; the edge's end when it is within the trail's snap of it. */
struct gd_point gd__trail_side_point(const struct gd__trail *trail, uint32_t side, double t);

#endif
