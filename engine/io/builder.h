/* Builder: the polygons of a file while it is being read. Arrays grow by half, within the limits;
 * what they hold at any time is at most a small multiple of the bytes read, because readers add
 * nothing, and reserve nothing, that those bytes don't account for. */
#ifndef GD_IO_BUILDER_H
#define GD_IO_BUILDER_H

#include <stddef.h>
#include <stdint.h>

#include "base/pace.h"
#include "gd/io.h"
#include "io/scan.h"

struct gd__builder {
    const struct gd__scan *scan;   /* borrowed: errors name its places */
    struct gd_read_options limits; /* neither is 0 */
    /* how the format numbers its first vertex: 0 or 1; for error texts only */
    uint32_t index_base;
    const char *next_look; /* at the control, once the scan is there */
    double done;           /* part of the reading, as the control was told last */

    double (*positions)[3];
    size_t position_count, position_capacity;

    uint32_t *corners;
    size_t corner_count, corner_capacity;

    /* NULL as long as all polygons are triangles, else the beginning of each closed polygon */
    uint32_t *first;
    size_t first_capacity;

    size_t polygon_count;
    size_t open;        /* first corner of the polygon that is being added */
    uint64_t triangles; /* of the closed polygons */

    uint64_t last_vertex;       /* the highest that a corner names, which may be defined later */
    const char *last_vertex_at; /* and where; NULL before the first corner */
};

/* An empty builder. `limits` may be NULL. */
struct gd__builder gd__builder_begin(const struct gd__scan *scan,
                                     const struct gd_read_options *limits);
void gd__builder_free(struct gd__builder *builder);

/* Room for so many vertices and triangles: call it with counts that the input's length was checked
 * to hold. GD_TOO_LARGE, GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__builder_reserve(struct gd__builder *builder, uint64_t positions,
                                               uint64_t polygons);

/* Looks at the control if it is time to; to be called for whatever is read and not added.
 * GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__builder_look(struct gd__builder *builder);

/* For a loop over what was added so far. */
struct gd__pace gd__builder_pace(const struct gd__builder *builder);

/* Each names `at` in its errors, and looks at the control. GD_NON_FINITE, GD_TOO_LARGE,
 * GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__builder_add_position(struct gd__builder *builder,
                                                    const double xyz[3], const char *at);

/* Adds a corner to the open polygon, zero-based; whether the vertex exists is asked by
 * gd__builder_finish. GD_NO_MEMORY. Looks at the control. */
GD_MUST_USE enum gd_status gd__builder_add_corner(struct gd__builder *builder, uint64_t vertex,
                                                  const char *at);

/* The same for a number of a format that doesn't tell integers from others. GD_SYNTAX (not whole),
 * GD_INDEX (negative), GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__builder_add_index(struct gd__builder *builder, double index,
                                                 const char *at);

/* Makes a polygon of the corners since the last one. GD_SYNTAX (fewer than three), GD_TOO_LARGE,
 * GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__builder_close_polygon(struct gd__builder *builder, const char *at);

/* GD_INDEX for a vertex that a face names, in the file's own numbering. */
enum gd_status gd__builder_no_such_vertex(const struct gd__builder *builder, long long number,
                                          const char *at);

/* Hands the arrays, shrunk to their length, over to `out`; the builder is empty then. GD_EMPTY,
 * GD_INDEX, GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__builder_finish(struct gd__builder *builder, struct gd_polygons *out);

#endif
