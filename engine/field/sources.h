/* Sources: all that a face sees its distances from, laid into the face's plane. The distance at a
 * point of the face is the least over the sources that see the point: sigma + |point - source|, or
 * sigma + gradient . point for a linear source, of a segment. It is the lower envelope of cones and
 * planes.
 *
 * Sources are the seeds in the face; the unfolded pseudo-sources of the wedges that look into the
 * face, each seeing a sector or a strip behind its wedge; and the face's corners, from which the
 * straight way always exists. Of sources that tie the one that comes first counts, of a point and a
 * segment the segment.
 *
 * A segment across the face is two sources, one for each side of it: a linear source sees nothing
 * that would be nearer than `nearest`. */
#ifndef GD_FIELD_SOURCES_H
#define GD_FIELD_SOURCES_H

#include "field/frame.h"

struct gd__source {
    struct gd__local at;       /* of a linear source the frame's origin */
    double sigma;              /* distance there */
    bool linear;               /* it has a sector then, a strip */
    struct gd__local gradient; /* of a linear source: of its distance, of unit length */
    bool has_sector;           /* else it sees all around */
    /* unit normals into the sector, of the lines that bound it */
    struct gd__local left, right;
    /* places on these lines: the source, if it is no linear one */
    struct gd__local left_at, right_at;
    /* distances that it enters the face with: least, and greatest */
    double nearest, farthest;
    /* the pseudo-source: a vertex, or vertex_count + number of the seed */
    uint32_t pseudo;
};

/* All zero is empty; reused from face to face. */
struct gd__sources {
    uint32_t face;
    struct gd__frame frame;
    struct gd__source *source;
    uint32_t count, capacity;
};

/* The sources of a face whose nearest distance is less than `most`. GD_NO_MEMORY. O(wedges of its
 * edges). */
GD_MUST_USE enum gd_status gd__sources_gather(const struct gd_field *field, uint32_t face,
                                              double most, struct gd__sources *out);
void gd__sources_destroy(struct gd__sources *sources);

/* Window `i` of a chunk in the frame of `side`, and lengthened by what its stored ends may be short
 * of. False: it is a gap. */
bool gd__sources_window(const struct gd_field *field, const struct gd__chunk *chunk, uint32_t i,
                        uint32_t side, struct gd__window *out);

/* At a place that it sees. */
static inline double gd__source_distance(const struct gd__source *source, struct gd__local at)
{
    double dx = at.x - source->at.x, dy = at.y - source->at.y;
    if (source->linear) return source->sigma + (source->gradient.x * dx + source->gradient.y * dy);
    return source->sigma + sqrt(dx * dx + dy * dy);
}

/* Ends of wedges are stored to 2^-32 of the edge: they may be short of what the source sees by so
 * much of its length. */
static inline double gd__stored_slack(double length)
{
    return 2 * GD__WEDGE_UNIT * length;
}

/* What distances as far as a level, at places within that size, may be off by from rounding. */
static inline double gd__envelope_slack(double level, double size)
{
    return GD_TOL_ENVELOPE * level + GD_TOL_PLACE * size;
}

#endif
