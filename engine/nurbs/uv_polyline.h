/* UV polyline: a polyline in the parameter domain, with its arc length in space. Also fits a chain
 * to such a polyline. */
#pragma once

#include "nurbs/chain.h"

struct gd__uv_polyline {
    uint32_t count, capacity; /* `count` must be at least 2 when the polyline is measured */
    double (*at)[2];
    double *arc; /* for each place, length in space of the chords up to it */
};

void gd__uv_polyline_free(struct gd__uv_polyline *polyline);

/* Appends a place. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__uv_polyline_add(struct gd__uv_polyline *polyline,
                                               const double at[2]);

/* Appends the places [begin, end) of another polyline. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__uv_polyline_append(struct gd__uv_polyline *polyline,
                                                  const struct gd__uv_polyline *from,
                                                  uint32_t begin, uint32_t end);

/* Computes `arc`. Removes places that coincide in space with their predecessors, except the last
 * place. */
void gd__uv_polyline_measure(const struct gd_parametric *surface, struct gd__uv_polyline *polyline);

/* Computes the place at a fractional index i + f. */
void gd__uv_polyline_at(const struct gd__uv_polyline *polyline, double position, double at[2]);

/* Returns the fractional index, at least `from`, at which the arc length is `run`. */
double gd__uv_polyline_position(const struct gd__uv_polyline *polyline, double run, uint32_t from);

/* Samples a chain at GD__SAMPLES_A_SPAN equal steps of each span. Sample i is in span i /
 * GD__SAMPLES_A_SPAN of the chain, except the last sample, at the chain's end. The polyline is not
 * measured. Errors: GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. */
enum { GD__SAMPLES_A_SPAN = 4 };
GD_MUST_USE enum gd_status gd__uv_polyline_sample(const struct gd__chain *chain,
                                                  struct gd__uv_polyline *out);

/* Samples a chain, and measures the polyline. Errors: those of gd__uv_polyline_sample. */
GD_MUST_USE enum gd_status gd__uv_polyline_of_chain(const struct gd__chain *chain,
                                                    struct gd__uv_polyline *out);

/* Parameters for fitting a chain. */
struct gd__fit {
    uint32_t degree,
        spans; /* number of spans, distributed over the pieces by length; at least one each */
    struct gd__joint from, to;
    bool whole; /* true if the chain is one piece through all cells */
};

/* Fits a chain to a polyline. Divides it where it crosses lines of the surface. Ignores parts that
 * leave a cell by less than GD_TOL_CELL of the cell's width. Within this distance of a corner of
 * four cells, the chain continues directly in the opposite cell. Errors: GD_NO_MEMORY, GD_BUDGET,
 * GD_INTERNAL (more crossings than a shortest path has). */
GD_MUST_USE enum gd_status gd__chain_fit(const struct gd_parametric *surface,
                                         const struct gd__uv_polyline *polyline,
                                         const struct gd__fit *fit, struct gd__pace *pace,
                                         struct gd__chain **out);

/* Returns true if each piece stays in its cell, with a tolerance of GD_TOL_CELL of the cell's
 * width. Ends early if the chain's pace stops. */
bool gd__chain_is_proper(const struct gd__chain *chain);
