/* Path builder: appends points to the polyline of a back-traced path (trace.c).
 *
 * Normalised unit and numbering of the mesh. `status` holds the first failure; after a failure,
 * calls append nothing. */
#pragma once

#include "field/layout.h"

struct gd__path_builder {
    const struct gd_field *field;
    const struct gd_mesh *mesh;
    struct gd_path path; /* the result, for the caller */
    uint32_t capacity;
    /* fraction of an edge: a crossing within this distance of an end is moved to the end */
    double snap;
    /* 0 means plain rays; GD_TOL_ASIDE_LEAST or more means careful rays (trace.c) */
    double aside;
    uint32_t vertex; /* the last vertex that the path passed, or GD_NONE if there is none yet */
    double nearest;  /* distance of the point where the current leg began */
    /* Bound on steps: a shortest path crosses no face twice, so a longer path is an error. */
    uint64_t steps_left;
    enum gd_status status;
};

/* Makes room for more points. On failure returns false and sets the status. */
bool gd__path_builder_grow(struct gd__path_builder *builder);

/* Makes room for one point. */
static inline bool gd__path_builder_reserve(struct gd__path_builder *builder)
{
    return builder->path.count < builder->capacity || gd__path_builder_grow(builder);
}

/* Appends a point at distance `length` from the last one, unless both are the same point. */
void gd__path_builder_append(struct gd__path_builder *builder, struct gd_point point,
                             double length);

/* Returns the distance from a point of a face to the last point, which must lie in that face
 * too. */
double gd__path_builder_run(const struct gd__path_builder *builder, const struct gd_point *point,
                            uint32_t face);

/* Appends a point of a face that contains the last point. The length is measured in the face,
 * independently of the wedges' distances, so that the caller can compare both. */
void gd__path_builder_append_in_face(struct gd__path_builder *builder, struct gd_point point,
                                     uint32_t face);

/* Appends a point seed, the end of the path, in a face that contains the last point, unless the
 * seed is exactly the last point. */
void gd__path_builder_append_seed(struct gd__path_builder *builder, uint32_t seed, uint32_t face);

/* Returns the point at parameter t of a side, moved to an end of the edge if it is within
 * `snap`. */
struct gd_point gd__path_builder_side_point(const struct gd__path_builder *builder, uint32_t side,
                                            double t);
