/* OpenSubdiv's limit surfaces behind a C interface: an implementation that shares nothing with the
 * engine. Not there on machines without it (libosd-dev). */
#ifndef TESTS_ORACLE_OPENSUBDIV_H
#define TESTS_ORACLE_OPENSUBDIV_H

#include <stdbool.h>

#include "gd/limit.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Levels of adaptive refinement before it approximates around an extraordinary vertex: the most
 * that it takes. Beyond 2^-(it - 1) of a face from all of them its surfaces are exact. */
#define OPENSUBDIV_LEVEL 10

bool opensubdiv_is_available(void);

struct opensubdiv_surface;

/* A surface of its own from a control mesh that the engine took. NULL: OpenSubdiv is not there. */
struct opensubdiv_surface *opensubdiv_create(const struct gd_control_mesh *mesh,
                                             enum gd_scheme scheme);
void opensubdiv_free(struct opensubdiv_surface *surface);

/* A vertex of the uniform refinement of some level, as one of its faces has it. */
struct opensubdiv_vertex {
    struct gd_limit_point place;
    struct gd_vec3 position, normal; /* by the limit masks; the normal of any length */
    /* no: on a crease it is that of any side, at other boundaries than even ones not the limit */
    bool has_normal;
    bool is_exact; /* no: its mask is another vertex' */
};

/* Vertices of all faces at `level` >= 1, one a corner of each, in `*out`, malloc'ed; returns how
 * many. */
size_t opensubdiv_vertices(const struct opensubdiv_surface *surface, int level,
                           struct opensubdiv_vertex **out);

/* Position and derivatives at a place, from patches. */
void opensubdiv_evaluate(const struct opensubdiv_surface *surface,
                         const struct gd_limit_point *place, struct gd_limit_jet *out);

#ifdef __cplusplus
}
#endif

#endif
