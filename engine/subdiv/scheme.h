/* Scheme: the data and functions that differ between Catmull-Clark and Loop subdivision. All other
 * code (refinement, neighbourhoods, descent, grids, tracing) is common to both.
 *
 * A face has its own coordinates (s,t). Their domain is the square [0,1]^2 or the triangle s, t >=
 * 0, s + t <= 1. `children` describes where a face's children lie: the point (s,t) of a child
 * is (origin + s axis_s + t axis_t) / 2 in the parent's coordinates. The determinant of the axes is
 * 1. */
#pragma once

#include "subdiv/net.h"

/* Value and derivatives in (s,t). */
struct gd__jet {
    struct gd_vec3 p, s, t, ss, st, tt;
};

/* A polynomial piece of the surface over its face: 16 B-spline control points, or the 15
 * coefficients of a quartic in powers of s and t. */
struct gd__patch {
    struct gd_vec3 c[16];
};

struct gd__child {
    int origin[2], s[2], t[2];
};

enum { GD__CHILDREN = 4 };

/* The arrays to which a grid is written. The value at (i,j) is stored at index origin + i step_s +
 * j step_t. */
struct gd__grid_rows {
    uint32_t cells;
    ptrdiff_t origin, step_s, step_t;
    struct gd_vec3 *positions, *normals;
};

struct gd__scheme {
    uint32_t arity;
    uint32_t valence; /* valence of regular vertices */
    bool face_points;
    struct gd__child children[GD__CHILDREN];
    /* true if the surface near a sharp corner with only one face is a polynomial */
    bool corner_patches;

    /* Returns the child whose domain contains (s,t). If (s,t) is within `slack` of the border
       between children and (ds,dt) is not 0, returns the child into which (ds,dt) points. */
    uint32_t (*child_at)(double s, double t, double ds, double dt, double slack);

    /* The subdivision rules for smooth interior points. `face_points` is NULL for Loop. */
    struct gd_vec3 (*edge_point)(const struct gd__net *net, uint32_t side,
                                 const struct gd_vec3 *face_points);
    struct gd_vec3 (*vertex_point)(const struct gd__net *net, const struct gd__fan *fan,
                                   const struct gd_vec3 *face_points);

    /* Limit masks of a closed fan without sharp edges. They give the position, and the tangent
       towards spoke 0, rotated by `angle`. With the angle 2 pi / n it is the tangent towards the
       next spoke. */
    struct gd_vec3 (*limit)(const struct gd__net *net, const struct gd__fan *fan);
    struct gd_vec3 (*tangent)(const struct gd__net *net, const struct gd__fan *fan, double angle);
    /* Limit mask of a closed fan around a fixed vertex. One component of the ring shrinks more
       slowly than the others; the mask gives its direction, or 0 if the ring has no such
       component. */
    struct gd_vec3 (*axis)(const struct gd__net *net, const struct gd__fan *fan);
    /* Limit mask at a crease with `faces` faces that begin at spoke `begin`. It gives the tangent
       across the crease, into the surface. */
    struct gd_vec3 (*cross)(const struct gd__net *net, const struct gd__fan *fan, uint32_t begin,
                            uint32_t faces);

    /* Computes the polynomial of face 0. All corners of this face must be regular
       (gd__ring_is_regular). */
    void (*patch)(const struct gd__net *net, struct gd__fan *fan, struct gd__patch *out);
    void (*evaluate)(const struct gd__patch *patch, double s, double t, struct gd__jet *out);

    /* Computes row i of a grid: positions and cross products of the derivatives at (i / cells, j /
       cells), for all 0 <= j <= cells in the domain. */
    void (*row)(const struct gd__patch *patch, uint32_t i, const struct gd__grid_rows *rows);
};

/* Returns true if the coordinate x lies beyond 1/2, the border between children. If x is within
 * `slack` of the border and dx is not 0, returns the sign of dx instead: true if dx > 0. */
static inline bool gd__is_beyond(double x, double dx, double slack)
{
    bool on = x >= 0.5 - slack && x <= 0.5 + slack;
    return on && dx != 0 ? dx > 0 : x > 0.5;
}

extern const struct gd__scheme gd__catmull_clark, gd__loop;

static inline const struct gd__scheme *gd__scheme_of(const struct gd__net *net)
{
    return net->arity == 4 ? &gd__catmull_clark : &gd__loop;
}
