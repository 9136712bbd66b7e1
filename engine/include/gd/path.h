/* Path: a polyline on the surface. Consecutive points lie within one face. */
#ifndef GD_PATH_H
#define GD_PATH_H

#include <stdint.h>

#include "gd/point.h"

GD_EXTERN_C_BEGIN

struct gd_path {
    double length;           /* length of the polyline */
    uint32_t count;          /* number of points, at least 1 */
    struct gd_point *points; /* from the start to the end of the path */
};

/* Frees the points and zeroes the struct. NULL is allowed. */
void gd_path_free(struct gd_path *path);

GD_EXTERN_C_END

#endif
