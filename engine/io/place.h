/* Place: the transform of a mesh into the space of its scene. The columns of the 3x4 matrix are the
 * images of x, y, z, and of the origin. */
#pragma once

#include <stdbool.h>

struct gd__place {
    double columns[4][3];
};

static const struct gd__place gd__unmoved = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};

static inline void gd__place_apply(const struct gd__place *place, const double local[3],
                                   double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = place->columns[0][axis] * local[0] + place->columns[1][axis] * local[1] +
                    place->columns[2][axis] * local[2] + place->columns[3][axis];
}

/* Composes two transforms: `inner` first, then `outer`. */
static inline struct gd__place gd__place_compose(const struct gd__place *outer,
                                                 const struct gd__place *inner)
{
    struct gd__place out;
    for (int column = 0; column < 4; column++) {
        const double *c = inner->columns[column];
        for (int axis = 0; axis < 3; axis++)
            out.columns[column][axis] =
                outer->columns[0][axis] * c[0] + outer->columns[1][axis] * c[1] +
                outer->columns[2][axis] * c[2] + (column == 3 ? outer->columns[3][axis] : 0);
    }
    return out;
}

/* Returns true if the transform mirrors space, which reverses the orientation of faces. */
static inline bool gd__place_mirrors(const struct gd__place *place)
{
    const double *x = place->columns[0], *y = place->columns[1], *z = place->columns[2];
    return x[0] * (y[1] * z[2] - y[2] * z[1]) + x[1] * (y[2] * z[0] - y[0] * z[2]) +
               x[2] * (y[0] * z[1] - y[1] * z[0]) <
           0;
}
