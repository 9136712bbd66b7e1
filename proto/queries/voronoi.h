/* Voronoi: which member of a set each part of a surface is nearest to. The answer
 * {"labels": [member per vertex index], "bisectors": [{"members", "closed", "length", "points"}]}
 * is written as it is found:
 *
 *     proto_voronoi_begin(&writer);
 *     proto_voronoi_labels_begin(&writer);
 *     for each vertex index: proto_voronoi_label(&writer, label);
 *     proto_voronoi_list_end(&writer);
 *     proto_voronoi_bisectors_begin(&writer);
 *     for each bisector:
 *         proto_bisector_begin(&writer, &bisector), its points, proto_bisector_end(&writer);
 *     proto_voronoi_list_end(&writer);
 *     proto_voronoi_end(&writer); */
#ifndef PROTO_VORONOI_H
#define PROTO_VORONOI_H

#include "gd/voronoi.h"
#include "proto/json/writer.h"

#define PROTO_VORONOI_POINTS 500000 /* most points of an answer's bisectors */

void proto_voronoi_begin(struct proto_writer *writer);
void proto_voronoi_end(struct proto_writer *writer);
void proto_voronoi_labels_begin(struct proto_writer *writer);
void proto_voronoi_label(struct proto_writer *writer, uint32_t label); /* UINT32_MAX: null */
void proto_voronoi_bisectors_begin(struct proto_writer *writer);
void proto_voronoi_list_end(struct proto_writer *writer);

/* "members", "closed" and "length"; then "points" if they are wanted: begin,
 * proto_path_point_encode of each, end. */
void proto_bisector_begin(struct proto_writer *writer, const struct gd_bisector *bisector);
void proto_bisector_points_begin(struct proto_writer *writer);
void proto_bisector_end(struct proto_writer *writer);

#endif
