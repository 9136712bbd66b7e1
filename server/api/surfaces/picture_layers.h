/* Picture layers: the layers of a figure, from the request to lines and marks of gd/picture.h.
 *
 * DESIGN. A layer whose kind is an operation ("trace") is a *part*: a query of that operation,
 * which runs the steps of a single request (query.h) and keeps its answer as arrays. Its lines are
 * the arrays "points" and "first" of that answer, which all operations with lines have. */
#ifndef SERVER_API_SURFACES_PICTURE_LAYERS_H
#define SERVER_API_SURFACES_PICTURE_LAYERS_H

#include "proto/queries/picture.h"
#include "server/query/query.h"

struct server_picture_layers {                                     /* all zero: none */
    const struct proto_picture_layer_list *wanted;                 /* borrowed */
    struct server_query *parts[PROTO_PICTURE_REQUEST_LAYERS_MOST]; /* of each layer, or NULL */
    /* for each layer of the kind `points` on a mesh: its located points */
    struct proto_located_points located[PROTO_PICTURE_REQUEST_LAYERS_MOST];
    uint32_t next;   /* first part to solve */
    bool is_begun;   /* that part's try_inline ran */
    uint64_t points; /* of all layers so far */
    struct gd_picture_layer drawn[GD_PICTURE_LAYERS];
    uint32_t count;
};

/* Creates the parts of the request's layers, and locates their points. The figure's query holds the
 * memory. On failure returns false with the problem, which points at the layer. */
bool server_picture_layers_decode(struct server_picture_layers *layers, struct server_query *query,
                                  const json_t *document);

/* Solves the parts. They are the fraction `share` of the query's work. After DONE all layers are
 * listed in `drawn`. */
enum server_query_turn server_picture_layers_solve(struct server_picture_layers *layers,
                                                   struct server_query *query, double share);
void server_picture_layers_free(struct server_picture_layers *layers);

#endif
