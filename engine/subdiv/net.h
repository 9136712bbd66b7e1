/* Net: a control mesh at some level of subdivision, as compact half-edge tables. The whole mesh has
 * one, and so has each neighbourhood that is subdivided locally.
 *
 * Side h is the half-edge from corner h of its face to the next one, the face to its left; the
 * sides of a face follow each other. Faces have `arity` corners (4 Catmull-Clark, 3 Loop), so that
 * side h is of face h / arity; only the net of a control mesh with other polygons has `first`. */
#ifndef GD_SUBDIV_NET_H
#define GD_SUBDIV_NET_H

#include <stdbool.h>

#include "gd/control_mesh.h"
#include "gd/vec.h"

struct gd__net {
    uint32_t arity;
    uint32_t point_count, face_count, side_count;
    struct gd_vec3 *points;
    float *corner;    /* per point: its tag's sharpness, INFINITY from GD_SHARPNESS_INFINITE on */
    uint32_t *first;  /* face_count + 1 offsets of sides, NULL: arity each */
    uint32_t *origin; /* per side: the point that it starts from */
    /* per side: the same edge seen from the other face, GD_NONE at the boundary and where a
       neighbourhood was cut out */
    uint32_t *twin;
    uint32_t *edge;    /* per side: number of its edge; set and used by gd__net_refine */
    float *sharpness;  /* per side, equal on both; INFINITY at the boundary of the mesh */
    uint32_t *face_of; /* per side, only with `first` */
};

/* Memory for so many points, faces and sides, counts zero; `polygons`: with `first` and `face_of`.
 * GD_NO_MEMORY: nothing is held. */
GD_MUST_USE enum gd_status gd__net_create(struct gd__net *net, uint32_t arity, size_t points,
                                          size_t faces, size_t sides, bool polygons);
void gd__net_free(struct gd__net *net);

/* Bytes that gd__net_create takes. */
size_t gd__net_size(size_t points, size_t faces, size_t sides, bool polygons);

static inline uint32_t gd__face_of(const struct gd__net *net, uint32_t side)
{
    return net->face_of ? net->face_of[side] : side / net->arity;
}

static inline uint32_t gd__face_first(const struct gd__net *net, uint32_t face)
{
    return net->first ? net->first[face] : face * net->arity;
}

static inline uint32_t gd__side_next(const struct gd__net *net, uint32_t side)
{
    uint32_t face = gd__face_of(net, side);
    return side + 1 == gd__face_first(net, face + 1) ? gd__face_first(net, face) : side + 1;
}

static inline uint32_t gd__side_previous(const struct gd__net *net, uint32_t side)
{
    uint32_t face = gd__face_of(net, side);
    return side == gd__face_first(net, face) ? gd__face_first(net, face + 1) - 1 : side - 1;
}

static inline uint32_t gd__side_end(const struct gd__net *net, uint32_t side)
{
    return net->origin[gd__side_next(net, side)];
}

/* Fan: the faces and edges around a point, counter-clockwise. Spoke i is the edge of sides[i]; an
 * open fan has one more, the last side's predecessor. */
struct gd__fan {
    uint32_t *sides; /* outgoing, one a face; room for the largest valence of the mesh */
    uint32_t count;
    bool closed;
};

/* The fan around the origin of `side`: from `side` on if it is closed, else from its clockwise end
 * on. */
void gd__fan_around(const struct gd__net *net, uint32_t side, struct gd__fan *fan);

static inline uint32_t gd__fan_spokes(const struct gd__fan *fan)
{
    return fan->count + !fan->closed;
}

/* The point at the end of a spoke, and its sharpness. */
static inline uint32_t gd__spoke_end(const struct gd__net *net, const struct gd__fan *fan,
                                     uint32_t spoke)
{
    return spoke < fan->count ? gd__side_end(net, fan->sides[spoke])
                              : net->origin[gd__side_previous(net, fan->sides[spoke - 1])];
}

static inline float gd__spoke_sharpness(const struct gd__net *net, const struct gd__fan *fan,
                                        uint32_t spoke)
{
    return net->sharpness[spoke < fan->count ? fan->sides[spoke]
                                             : gd__side_previous(net, fan->sides[spoke - 1])];
}

#endif
