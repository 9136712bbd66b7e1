/* Triangulation: a constrained Delaunay triangulation of sites inside one large triangle, with
 * segments between sites.
 *
 *     gd__plane_create(&plane, capacity), then the caller fills plane.sites
 *     gd__plane_begin(&plane, corners): the large triangle
 *     gd__plane_insert(&plane, s, &same) for each other site
 *     gd__plane_fix(&plane, a, b) for each segment
 *
 * DESIGN. Exact orientations of the sites alone determine the possible triangles. Therefore every
 * triangle is counter-clockwise and the triangles tile the large one, regardless of rounding. The
 * caller's `is_bad` chooses among possible flips (Lawson 1977). Segments are inserted by flips of
 * the edges that they cross (Sloan 1993). */
#pragma once

#include "base/arena.h"
#include "base/pace.h"
#include "gd/polygons.h"
#include "plane/site.h"

struct gd__plane_triangle {
    uint32_t corner[3]; /* counter-clockwise */
    /* for each side k (from corner k to corner k + 1), the triangle across this side, or GD_NONE if
       there is none */
    uint32_t across[3];
    bool is_fixed[3]; /* for each side, true if it is a segment */
};

struct gd__plane_side {
    uint32_t triangle, k;
};

struct gd__plane {
    struct gd__pace *pace; /* borrowed */
    struct gd__arena arena;
    /* Returns true if the common side of two triangles is to be flipped. Must return false if the
       triangles do not form a strictly convex quadrilateral. It is not called for segments. */
    bool (*is_bad)(const struct gd__plane *plane, struct gd__plane_side side);
    struct gd__site *sites; /* `capacity` entries, like triangle_at */
    uint32_t *triangle_at;  /* for each inserted site, a triangle of which it is a corner */
    uint32_t capacity, triangle_count;
    struct gd__plane_triangle *triangles;
    uint32_t (*queue)[2]; /* sides as pairs of sites, or triangles, that are to be processed */
    uint32_t last;        /* the triangle where the next search begins */
};

/* Returns the corner of a triangle after or before corner k. */
static inline uint32_t gd__corner_after(uint32_t k)
{
    return k == 2 ? 0 : k + 1;
}
static inline uint32_t gd__corner_before(uint32_t k)
{
    return k == 0 ? 2 : k - 1;
}

/* Allocates the arrays for `capacity` sites. Sets no other member. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__plane_create(struct gd__plane *plane, uint32_t capacity);
void gd__plane_free(struct gd__plane *plane); /* frees the arrays, and zeroes the struct */
size_t gd__plane_bytes(uint32_t capacity);    /* size of the arrays */

/* Begins with one triangle. */
void gd__plane_begin(struct gd__plane *plane, const uint32_t corner[3]);

/* Inserts a site, and flips bad sides. Sets *same to the inserted site at the same position, or to
 * `s` if there is none. Errors: GD_RUNAWAY (the site lies outside the large triangle),
 * GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__plane_insert(struct gd__plane *plane, uint32_t s, uint32_t *same);

/* Changes the triangulation such that the segment between two sites is a side of triangles. Errors:
 * GD_RUNAWAY (the segment passes a site, or crosses another segment), GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__plane_fix(struct gd__plane *plane, uint32_t a, uint32_t b);

/* Flips bad sides until no side is bad. */
void gd__plane_improve(struct gd__plane *plane);

/* Returns the corner that lies across a side, in the other triangle. */
uint32_t gd__plane_opposite(const struct gd__plane *plane, struct gd__plane_side side);

/* Returns true if the two triangles at a side form a strictly convex quadrilateral. */
bool gd__plane_is_convex(const struct gd__plane *plane, struct gd__plane_side side);
