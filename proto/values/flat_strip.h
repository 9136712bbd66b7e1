/* Flat strip: a path and the faces that it runs through, laid flat, as a drawing (SVG 1.1). */
#ifndef PROTO_FLAT_STRIP_H
#define PROTO_FLAT_STRIP_H

#include "gd/flat_strip.h"
#include "proto/json/writer.h"

/* Bytes of the drawing at most. */
size_t proto_flat_strip_bytes(const struct gd_flat_strip *strip);

/* Writes the drawing: the faces, the path, its ends, a bar of a round length, and the path's
 * length. All that is drawn is in one group whose coordinates are those of the strip, in the mesh's
 * unit and to the last digit, y downwards; its transform alone makes a page of it. */
void proto_flat_strip_svg(struct proto_writer *writer, const struct gd_flat_strip *strip,
                          double length);

#endif
