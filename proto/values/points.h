/* Points: a list of points in a request, and their locations on a mesh. */
#pragma once

#include "proto/values/point.h"

struct proto_points { /* all zero means empty */
    struct proto_point *items;
    uint32_t count, capacity;
};

void proto_points_free(struct proto_points *points); /* leaves an empty list */

/* Appends a point for the caller to fill. Returns NULL on insufficient_memory. */
struct proto_point *proto_points_add(struct proto_points *points, struct proto_problem *problem);

/* Adds the points of a JSON array of at most `most` items; `pointer` is the array's place. On
 * failure the list may have some of them. Problems: invalid_request, too_large (with the limit),
 * insufficient_memory. */
bool proto_points_decode(struct proto_points *points, const json_t *value, const char *pointer,
                         uint32_t most, struct proto_problem *problem);

/* Adds the point that is a member of the document. `pointer` is the member's JSON Pointer
 * ("/from"). */
bool proto_points_decode_member(struct proto_points *points, const json_t *document,
                                const char *pointer, struct proto_problem *problem);

/* Adds points from compact text, separated by semicolons: "v:12;e:3-9:0.25". `parameter` is the
 * place of all points. */
bool proto_points_parse(struct proto_points *points, const char *text, const char *parameter,
                        uint32_t most, struct proto_problem *problem);

struct proto_located_points {   /* all zero means empty */
    const struct gd_mesh *mesh; /* borrowed */
    struct gd_point *points;
    /* distances by which points were moved; NAN if not moved; in the same allocation as the
       points */
    double *snaps;
    uint32_t count;
};

void proto_located_points_free(struct proto_located_points *located); /* leaves an empty list */

/* Locates all points, of which there is at least one. Problems: those of proto_point_locate, and
 * insufficient_memory. */
bool proto_points_locate(const struct gd_mesh *mesh, const struct proto_points *points,
                         struct proto_located_points *out, struct proto_problem *problem);

/* Writes an array of `count` points, from points[first] on. */
void proto_located_points_encode(struct proto_writer *writer,
                                 const struct proto_located_points *located, uint32_t first,
                                 uint32_t count);
