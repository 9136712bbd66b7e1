/* Sources of a face, unfolded into the face's plane. The distance at a point of the face is the
 * minimum over the sources that see the point: sigma + |point - source|, or sigma + gradient .
 * point for a linear source. Thus the distance is the lower envelope of cones and planes.
 *
 * There are three kinds of sources: the seeds in the face, the unfolded pseudo-sources of the
 * wedges that enter the face, and the face's corners. The pseudo-source of a wedge sees the sector
 * or strip behind the wedge. A corner sees the whole face. In a tie segments take precedence over
 * points, then the lower number decides.
 *
 * A segment across the face gives two sources, one for each side of it. A linear source is only
 * used where its distance is at least `nearest`. */
#pragma once

#include "field/face_frame.h"
#include "field/spans.h"

struct gd__source {
    struct gd__local at; /* for a linear source, the frame's origin */
    double sigma;        /* distance at `at` */
    bool linear;         /* the source is a segment: it has a strip instead of a sector */
    /* for a linear source, the gradient of its distance: a unit vector */
    struct gd__local gradient;
    bool has_sector; /* false if the source sees the whole face */
    /* unit normals, inwards, of the lines that bound the sector */
    struct gd__local left, right;
    /* points on these lines; for a point source, the source itself */
    struct gd__local left_at, right_at;
    /* least and greatest distance at which the source's paths enter the face */
    double nearest, farthest;
    /* a vertex, or vertex_count + number of a seed */
    uint32_t pseudo;
};

/* Reused from face to face. An all-zero struct is empty. */
struct gd__sources {
    uint32_t face;
    struct gd__face_frame frame;
    struct gd__source *source;
    uint32_t count, capacity;
    enum gd_status status; /* GD_NO_MEMORY if a source could not be added */
    /* spans of the circle or branch that is being computed: those where another source is nearer,
       and the others */
    struct gd__spans covered, spans;
};

/* Collects those sources of a face whose `nearest` is below `most`. Error: GD_NO_MEMORY. O(wedges
 * of the face's edges). */
GD_MUST_USE enum gd_status gd__sources_gather(const struct gd_field *field, uint32_t face,
                                              double most, struct gd__sources *out);
void gd__sources_destroy(struct gd__sources *sources);

/* Iterates over the windows of an edge, in the frame of `side`. The windows are lengthened by the
 * rounding error of their stored ends. Gaps are skipped. */
struct gd__edge_windows {
    const struct gd_field *field;
    uint32_t side, chunk, next; /* the next window is number `next` of `chunk` */
};

static inline struct gd__edge_windows gd__edge_windows(const struct gd_field *field, uint32_t side)
{
    return (struct gd__edge_windows){field, side, field->newest[side >> 1], 0};
}

/* Computes the next window. Returns false if there is none. */
bool gd__edge_windows_next(struct gd__edge_windows *windows, struct gd__window *out);

/* Returns the seeds in one face of an edge. All seeds on the edge are among them. */
struct gd__face_seeds gd__edge_seeds(const struct gd_field *field, uint32_t edge);

/* Computes the window of a point seed on an edge, in the frame of side 0. Returns false for any
 * other seed. A segment along the edge has wedges on it. */
bool gd__edge_seed_window(const struct gd_field *field, uint32_t edge, uint32_t seed,
                          struct gd__window *out);

/* Returns the distance at a position that the source sees. */
static inline double gd__source_distance(const struct gd__source *source, struct gd__local at)
{
    double dx = at.x - source->at.x, dy = at.y - source->at.y;
    if (source->linear) return source->sigma + (source->gradient.x * dx + source->gradient.y * dy);
    return source->sigma + sqrt(dx * dx + dy * dy);
}

/* Returns a bound of the error by which the ends of an edge's wedges are rounded when they are
 * stored: twice 2^-32 of the edge's length. */
static inline double gd__stored_slack(double length)
{
    return 2 * GD__WEDGE_UNIT * length;
}

/* Returns the length by which a linear wedge's end is extended to close the gap to its neighbour.
 * Stored ends are rounded inwards, to 2^-32 of an edge no longer than `size`. `away` is the
 * distance of that end from the segment. */
static inline double gd__line_lengthened(double size, double away)
{
    return fmax(fmin(2 * GD__WEDGE_UNIT * size, GD_TOL_LENGTHENED * away), 0);
}

/* Returns a bound of the rounding error of distances near `level`, at positions within a face of
 * size `size`. */
static inline double gd__envelope_slack(double level, double size)
{
    return GD_TOL_ENVELOPE * level + GD_TOL_PLACE * size;
}
