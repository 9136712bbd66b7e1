/* Picture layers: converts the layers in the request of a figure to lines and marks of
 * gd/picture.h.
 *
 * DESIGN. A layer whose kind is an operation ("trace") is a *part*: a query of that operation,
 * which runs the steps of a single request (query.h) and keeps its answer as arrays. Its lines are
 * the arrays "points" and "first" of that answer, which all operations with lines have. */
#pragma once

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

/* Creates the parts of the request's layers, and locates their points. The figure's query holds the
 * memory. On failure returns false with the problem, which points at the layer. */
bool server_picture_layers_decode(struct server_picture_layers *layers, struct server_query *query,
                                  const json_t *document);

/* Solves the parts. Their work is the fraction `share` of the query's work. After DONE all layers
 * are listed in `drawn`. */
enum server_query_turn server_picture_layers_solve(struct server_picture_layers *layers,
                                                   struct server_query *query, double share);
void server_picture_layers_free(struct server_picture_layers *layers);

/* --- for layers of one form ------------------------------------------------------------------- */

#define SERVER_DRAWN_MARK 2.4 /* radius of control points */

/* Adds a layer with the pen of the request's layer i. */
struct gd_picture_layer *server_drawn_add(struct server_picture_layers *layers, uint32_t i);

/* Allocates `points` points for the `count` lines of a layer. Returns the array of the indices
 * where the lines begin, for the caller to fill. On failure, sets the problem and returns NULL. */
uint32_t *server_drawn_reserve(struct server_picture_layers *layers, struct server_query *query,
                               uint32_t count, uint64_t points, struct gd_picture_layer *drawn);

/* Sets shape[0] lines of shape[1] points each, and returns the array for their points. On failure,
 * sets the problem and returns NULL. */
struct gd_vec3 *server_drawn_lines(struct server_picture_layers *layers, struct server_query *query,
                                   const uint32_t shape[2], struct gd_picture_layer *drawn);

/* picture_nets.c: draw layer i, which shows how a smooth surface is made. On failure return false
 * with the problem. The problem's pointer is relative to the body of the layer, or, for a curve, to
 * an object with the member "curve". Only NURBS surfaces have a domain. */
bool server_domain_curve_draw(struct server_picture_layers *layers, struct server_query *query,
                              uint32_t i);
bool server_isoparametric_draw(struct server_picture_layers *layers, struct server_query *query,
                               uint32_t i);
bool server_control_net_draw(struct server_picture_layers *layers, struct server_query *query,
                             uint32_t i);

/* picture_pieces.c: builds the mesh of the pieces as the figure's surface and adds their boundaries
 * as layer i. `arrays` are the arrays that a cut lists for a figure: positions, corners,
 * piece_vertices, piece_corners. On failure returns false with the problem. */
bool server_pieces_draw(struct server_picture_layers *layers, struct server_query *query,
                        uint32_t i, const struct server_arrays *arrays);
