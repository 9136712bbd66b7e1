/* Matrix: the distances of many pairs, row by row, on as many workers as are free.
 *
 * DESIGN. The metric is symmetric: of sources and targets, those that are fewer become the rows,
 * each different one once. A row is a field of its point, evaluated at all columns at once: a field
 * that is cached, or one that is built and dropped again, in the memory of the row before; without
 * its wedges where all columns are vertices. Rows of few columns are searched for instead, pair by
 * pair. From one component to another nothing is computed.
 *
 * Each row is a task of an executor (executor.h) with a workspace and a grant from the byte budget
 * of its own. A row that finds too little memory while others run is left, and tried again when it
 * is alone. The first failure ends all rows: those by fields within a millisecond or so, those by
 * searches at the end of theirs. */
#ifndef SERVER_QUERY_MATRIX_ROWS_H
#define SERVER_QUERY_MATRIX_ROWS_H

#include "gd/point.h"
#include "server/http/exchange.h"
#include "server/surfaces/surface.h"

struct server_matrix_request {
    struct server_surface *surface; /* borrowed, as the points are */
    const struct gd_point *sources, *targets;
    uint32_t source_count, target_count; /* at least one each */
    double max_distance;                 /* INFINITY: no limit */
};

/* Bytes that solving holds besides its rows and `out`, at most. */
size_t server_matrix_cost(const struct server_matrix_request *request);

/* `out`: source_count x target_count distances, a source a row; INFINITY: no path; NAN: beyond
 * max_distance. Untouched on failure. `part`: on whose behalf, and which part of his work it is. To
 * be called by a worker. Errors: those of gd_field_build and gd_field_distances; GD_BUDGET: not
 * even all that could be had was enough for one row. */
GD_MUST_USE enum gd_status server_matrix_solve(const struct server_monitor *part,
                                               const struct server_matrix_request *request,
                                               double *out);

#endif
