/* Picture layers: converts the layers in the request of a figure to lines and marks of
 * gd/picture.h.
 *
 * DESIGN. A layer whose kind is an operation ("trace") is a *part*: a query of that operation,
 * which runs the steps of a single request (query.h) and keeps its answer as arrays. Its lines are
 * the arrays "points" and "first" of that answer, which all operations with lines have. */
#ifndef SERVER_API_SURFACES_PICTURE_LAYERS_H
#define SERVER_API_SURFACES_PICTURE_LAYERS_H

#include "server/api/surfaces/picture_drawing.h"

/* Creates the parts of the request's layers, and locates their points. The figure's query holds the
 * memory. On failure returns false with the problem, which points at the layer. */
bool server_picture_layers_decode(struct server_picture_layers *layers, struct server_query *query,
                                  const json_t *document);

/* Solves the parts. Their work is the fraction `share` of the query's work. After DONE all layers
 * are listed in `drawn`. */
enum server_query_turn server_picture_layers_solve(struct server_picture_layers *layers,
                                                   struct server_query *query, double share);
void server_picture_layers_free(struct server_picture_layers *layers);

#endif
