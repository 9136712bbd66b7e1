/* Picture pieces: the layer `cut` of a figure. The pieces of a cut are moved apart and replace the
 * surface. Their boundaries are drawn as lines. */
#ifndef SERVER_API_SURFACES_PICTURE_PIECES_H
#define SERVER_API_SURFACES_PICTURE_PIECES_H

#include "server/api/surfaces/picture_drawing.h"

/* Builds the mesh of the pieces as the figure's surface and adds their boundaries as layer i.
 * `arrays` are the arrays that a cut lists for a figure: positions, corners, piece_vertices,
 * piece_corners. On failure returns false with the problem. */
bool server_pieces_draw(struct server_picture_layers *layers, struct server_query *query,
                        uint32_t i, const struct server_arrays *arrays);

#endif
