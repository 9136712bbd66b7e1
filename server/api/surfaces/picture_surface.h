/* Picture surface: the mesh that a figure shows. For a mesh, this is the mesh itself, or the pieces
 * of a cut. For a smooth surface, it is a mesh that approximates the surface; the exact field of
 * this mesh approximates the field of the surface. */
#pragma once

#include "proto/queries/picture.h"
#include "server/fields/discretizations.h"
#include "server/query/query.h"

struct server_picture_surface {                   /* all zero at first */
    const struct gd_mesh *mesh;                   /* stored mesh, or mesh of a member below */
    struct server_discretization *discretization; /* for a subdivision surface */
    struct gd_tessellation *tessellation;         /* for a NURBS surface */
    struct gd_mesh *pieces;                       /* for a cut */
    /* seeds of the field of a smooth surface; at most one list has items */
    struct proto_uvs uvs;
    struct proto_limit_places places;
    double max_distance; /* limit of that field; 0 means none */
    struct gd_field *field;
};

/* Decodes the body of the layer `field` of a smooth surface. Pointers of problems are relative to
 * the body. */
bool server_picture_surface_decode(struct server_picture_surface *surface,
                                   struct server_query *query, const json_t *body);

/* Finds or builds the mesh, and the field if there are seeds. This work is the fraction `share` of
 * the query's work. On failure returns false with the problem. */
bool server_picture_surface_open(struct server_picture_surface *surface, struct server_query *query,
                                 double share);
void server_picture_surface_close(struct server_picture_surface *surface);
