/* Net: a control mesh at some level of subdivision, as compact half-edge tables. A net represents
 * the whole mesh, or a neighbourhood that is subdivided locally.
 *
 * A side is a half-edge, from one corner of its face to the next, with the face on its left. The
 * sides of a face are consecutive. Usually all faces have `arity` corners (Catmull-Clark 4, Loop
 * 3), and side h belongs to face h / arity. Only the net of a control mesh with other polygons has
 * the array `first`. */
#pragma once

#include <stdbool.h>

#include "base/arena.h"
#include "gd/control_mesh.h"
#include "gd/vec.h"

/* The arrays belong to the gd__arena with which the net was created. */
struct gd__net {
    uint32_t arity;
    uint32_t point_count, face_count, side_count;
    struct gd_vec3 *points;
    /* for each point, sharpness of its corner tag (gd/control_mesh.h); INFINITY if the tag has at
       least GD_SHARPNESS_INFINITE */
    float *corner;
    /* face_count + 1 entries: for each face, its first side; NULL if all faces have `arity`
       sides */
    uint32_t *first;
    uint32_t *origin; /* for each side, the point where it begins */
    /* for each side, the opposite half-edge, or GD_NONE at the boundary and at the border of a
       neighbourhood */
    uint32_t *twin;
    uint32_t *edge; /* for each side, number of its edge; set and used by gd__net_refine */
    /* for each side, sharpness of its edge, equal on twins; INFINITY at the boundary of the mesh */
    float *sharpness;
    uint32_t *face_of; /* for each side, its face; NULL if `first` is NULL */
};

/* Creates a net with room for the given numbers of points and sides, in `arena`. Its counts are
 * zero, and `first` and `face_of` are NULL. */
void gd__net_create(struct gd__net *net, struct gd__arena *arena, uint32_t arity, size_t points,
                    size_t sides);

static inline uint32_t gd__face_of(const struct gd__net *net, uint32_t side)
{
    return net->face_of ? net->face_of[side] : side / net->arity;
}

static inline uint32_t gd__face_first(const struct gd__net *net, uint32_t face)
{
    return net->first ? net->first[face] : face * net->arity;
}

static inline uint32_t gd__net_next(const struct gd__net *net, uint32_t side)
{
    uint32_t face = gd__face_of(net, side);
    return side + 1 == gd__face_first(net, face + 1) ? gd__face_first(net, face) : side + 1;
}

static inline uint32_t gd__net_previous(const struct gd__net *net, uint32_t side)
{
    uint32_t face = gd__face_of(net, side);
    return side == gd__face_first(net, face) ? gd__face_first(net, face + 1) - 1 : side - 1;
}

static inline uint32_t gd__side_end(const struct gd__net *net, uint32_t side)
{
    return net->origin[gd__net_next(net, side)];
}

/* Fan: the faces and edges around a point, counter-clockwise. Spoke i is the edge of sides[i]. An
 * open fan has one more spoke: the last edge of its last face. */
struct gd__fan {
    /* outgoing sides, one for each face; the array has room for the largest valence of the mesh */
    uint32_t *sides;
    uint32_t count;
    bool closed;
};

/* Lists the fan around the origin of `side`. A closed fan begins with `side`, an open one with its
 * clockwise end. */
void gd__fan_around(const struct gd__net *net, uint32_t side, struct gd__fan *fan);

static inline uint32_t gd__fan_spokes(const struct gd__fan *fan)
{
    return fan->count + !fan->closed;
}

/* gd__spoke_end returns the point at the end of a spoke; gd__spoke_sharpness returns the spoke's
 * sharpness. */
static inline uint32_t gd__spoke_end(const struct gd__net *net, const struct gd__fan *fan,
                                     uint32_t spoke)
{
    return spoke < fan->count ? gd__side_end(net, fan->sides[spoke])
                              : net->origin[gd__net_previous(net, fan->sides[spoke - 1])];
}

static inline float gd__spoke_sharpness(const struct gd__net *net, const struct gd__fan *fan,
                                        uint32_t spoke)
{
    return net->sharpness[spoke < fan->count ? fan->sides[spoke]
                                             : gd__net_previous(net, fan->sides[spoke - 1])];
}
