/* Flat strip: a drawing (SVG 1.1) of a path and of the faces that the path crosses, unfolded into
 * the plane. */
#pragma once

#include "gd/flat_strip.h"
#include "proto/json/writer.h"

/* Returns an upper bound of the drawing's bytes. */
size_t proto_flat_strip_bytes(const struct gd_flat_strip *strip);

/* Writes the drawing: the faces, the path, its ends, a scale bar of a round length, and the path's
 * length. One group holds the whole drawing, in the strip's exact coordinates and the mesh's unit,
 * y downwards; the group's transform alone scales it to the page. */
void proto_flat_strip_svg(struct proto_writer *writer, const struct gd_flat_strip *strip,
                          double length);
