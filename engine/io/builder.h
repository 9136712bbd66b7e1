/* Builder: collects the polygons of a file while it is being read. Arrays grow by half, within the
 * limits. Readers add only elements that they have read, and reserve only elements for which the
 * input is long enough. So the arrays' size is at most a small multiple of the input's size. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/pace.h"
#include "gd/io.h"
#include "io/scan.h"

struct gd__builder {
    const struct gd__scan *scan; /* borrowed; errors name a line or byte of this scan */
    /* a limit that the caller left 0 is already replaced by the default */
    struct gd_read_options limits;
    /* the number that the format gives to the first vertex, 0 or 1; used only in error texts */
    uint32_t index_base;
    const char *next_look; /* position of the scan at which the control is checked next */
    double done;           /* fraction of the reading that was last reported to the control */
    /* true if the input has vertices before this builder's part; their number is unknown */
    bool is_part;

    double (*positions)[3];
    size_t position_count, position_capacity;

    uint32_t *corners;
    size_t corner_count, corner_capacity;

    /* NULL as long as all polygons are triangles; otherwise the first corner of each closed
     * polygon */
    uint32_t *first;
    size_t first_capacity;

    size_t polygon_count;
    size_t open;        /* first corner of the open polygon */
    uint64_t triangles; /* number of triangles of the closed polygons */

    /* largest vertex number of a corner; the vertex may be defined later */
    uint64_t last_vertex;
    /* position in the input of the corner with last_vertex; NULL before the first corner */
    const char *last_vertex_at;
};

/* Returns an empty builder. `limits` may be NULL. */
struct gd__builder gd__builder_begin(const struct gd__scan *scan,
                                     const struct gd_read_options *limits);
void gd__builder_free(struct gd__builder *builder);

/* Reserves room for that many vertices and triangles. The caller must have checked that the input
 * is long enough for them. Errors: GD_TOO_LARGE, GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__builder_reserve(struct gd__builder *builder, uint64_t positions,
                                               uint64_t polygons);

/* Checks the control if enough input was read since the last check. Readers call this function
 * while they skip input. Errors: GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__builder_look(struct gd__builder *builder);

/* Returns a pace for a loop over the elements added so far. */
struct gd__pace gd__builder_pace(const struct gd__builder *builder);

/* Adds a vertex. Error texts name the line or byte of `at`. Checks the control at intervals.
 * Errors: GD_NON_FINITE, GD_TOO_LARGE, GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__builder_add_position(struct gd__builder *builder,
                                                    const double xyz[3], const char *at);

/* Adds a zero-based corner to the open polygon. gd__builder_finish checks that the vertex exists.
 * Checks the control at intervals. Errors: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__builder_add_corner(struct gd__builder *builder, uint64_t vertex,
                                                  const char *at);

/* Like gd__builder_add_corner, for a format that does not distinguish integers from other numbers.
 * Errors: GD_SYNTAX (not whole), GD_INDEX (negative), GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__builder_add_index(struct gd__builder *builder, double index,
                                                 const char *at);

/* Handles an invalid element at the position `at` that the reader can skip. If limits.skipped is
 * set, records the element's line in limits.skipped and returns GD_OK. Otherwise fails with
 * `status` and the formatted sentence. */
GD_MUST_USE enum gd_status gd__builder_skip(struct gd__builder *builder, const char *at,
                                            enum gd_status status, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Closes the open polygon. A polygon of fewer than three corners is passed to gd__builder_skip,
 * which skips it or returns GD_SYNTAX. Other errors: GD_TOO_LARGE, GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__builder_close_polygon(struct gd__builder *builder, const char *at);

/* Appends the polygons of a builder that has read the next part of the input. Returns false if that
 * would exceed a limit or if there is no memory; the builder is then unchanged. */
bool gd__builder_append(struct gd__builder *builder, const struct gd__builder *part);

/* Reports that a face names a vertex that does not exist, and returns GD_INDEX. `number` is the
 * vertex in the file's numbering. */
enum gd_status gd__builder_no_such_vertex(const struct gd__builder *builder, long long number,
                                          const char *at);

/* Moves the arrays, shrunk to their length, to `out` and empties the builder. Errors: GD_EMPTY,
 * GD_INDEX, GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__builder_finish(struct gd__builder *builder, struct gd_polygons *out);
