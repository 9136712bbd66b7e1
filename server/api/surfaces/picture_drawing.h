/* Picture drawing: the layers of a figure while they are solved and drawn, and the functions that
 * add lines and marks to them. */
#ifndef SERVER_API_SURFACES_PICTURE_DRAWING_H
#define SERVER_API_SURFACES_PICTURE_DRAWING_H

#include "proto/values/domain_curve.h"
#include "server/api/surfaces/picture_surface.h"

struct server_picture_layers {                                     /* all zero means none */
    const struct proto_picture_layer_list *wanted;                 /* borrowed */
    struct server_picture_surface *surface;                        /* borrowed */
    struct server_query *parts[PROTO_PICTURE_REQUEST_LAYERS_MOST]; /* one for each layer, or NULL */
    /* for each layer of the kind `points` on a mesh: its located points */
    struct proto_located_points located[PROTO_PICTURE_REQUEST_LAYERS_MOST];
    /* for each layer of the kind `curve` on a NURBS surface: its curve */
    struct proto_domain_curve curves[PROTO_PICTURE_REQUEST_LAYERS_MOST];
    bool has_set;    /* the figure's query names the set of a field */
    uint32_t next;   /* first part to solve */
    bool is_begun;   /* true if try_inline of that part was called */
    uint64_t points; /* number of points of all layers so far */
    struct gd_picture_layer drawn[GD_PICTURE_LAYERS];
    uint32_t count;
};

#define SERVER_DRAWN_MARK 2.4 /* radius of control points */

/* Adds a layer with the pen of the request's layer i. */
struct gd_picture_layer *server_drawn_add(struct server_picture_layers *layers, uint32_t i);

/* Allocates points that are freed with the figure's query. On failure, sets the problem and returns
 * NULL. */
struct gd_vec3 *server_drawn_points(struct server_picture_layers *layers,
                                    struct server_query *query, uint64_t count);

/* Sets shape[0] lines of shape[1] points each, and returns the array for their points. On failure,
 * sets the problem and returns NULL. */
struct gd_vec3 *server_drawn_lines(struct server_picture_layers *layers, struct server_query *query,
                                   const uint32_t shape[2], struct gd_picture_layer *drawn);

#endif
