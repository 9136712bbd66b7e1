/* A C interface to OpenSubdiv's limit surfaces, an implementation that shares no code with the
 * engine. Without OpenSubdiv (libosd-dev) it is not available. */
#pragma once

#include <stdbool.h>

#include "gd/limit.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Number of levels of adaptive refinement, which is the maximum that OpenSubdiv allows. Near an
 * extraordinary vertex, at distances below 2^-(level - 1) of a face, OpenSubdiv approximates the
 * surface. Elsewhere it is exact. */
#define OPENSUBDIV_LEVEL 10

bool opensubdiv_is_available(void);

struct opensubdiv_surface;

/* Copies a control mesh that the engine accepted. Returns NULL if OpenSubdiv is not available. */
struct opensubdiv_surface *opensubdiv_create(const struct gd_control_mesh *mesh,
                                             enum gd_scheme scheme);
void opensubdiv_free(struct opensubdiv_surface *surface);

/* A vertex of a uniform refinement, given as a corner of one of the faces around it. */
struct opensubdiv_vertex {
    struct gd_limit_point place;
    struct gd_vec3 position, normal; /* computed by the limit masks; the normal is not normalized */
    /* false on irregular boundaries, and on a crease, where each side has its own normal */
    bool has_normal;
    bool is_exact; /* false if OpenSubdiv used the mask of another vertex type */
};

/* Computes the vertices of all faces at `level` >= 1, one for each corner. *out is owned by the
 * caller. Returns their number. */
size_t opensubdiv_vertices(const struct opensubdiv_surface *surface, int level,
                           struct opensubdiv_vertex **out);

/* Computes position and derivatives at a point of the surface from OpenSubdiv's patches. */
void opensubdiv_evaluate(const struct opensubdiv_surface *surface,
                         const struct gd_limit_point *place, struct gd_limit_jet *out);

#ifdef __cplusplus
}
#endif
