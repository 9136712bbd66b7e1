/* View: the part of a face that a source sees. A straight path leads from the source to each point
 * of the view. Normalised unit, in the face's plane. */
#pragma once

#include "field/voronoi_branch.h"

/* A triangle clipped by up to three lines. */
struct gd__view {
    int count;
    struct gd__local corner[7];
    double most; /* upper bound of the source's distances in the view */
};

/* Computes the view of a source. `nudge` is added to the source's distances. */
struct gd__view gd__source_view(const struct gd_field *field, const struct gd__face_frame *frame,
                                const struct gd__source *source, double nudge);

/* Returns true if `other` cannot compete in a view: it does not see the view, or it is farther than
 * the view's source at every point of the view. */
bool gd__view_is_beyond(const struct gd__view *view, const struct gd__source *other);

/* Reduces `turn` to the spans where the branch lies inside all borders of the source's view.
 * Returns false if no span is left. */
bool gd__branch_narrow_to_view(const struct gd_field *field, const struct gd__face_frame *frame,
                               const struct gd__branch *branch, const struct gd__source *source,
                               struct gd__turn *turn);

/* Returns the spans where both sources see their branch, and where the branch lies in the face or
 * at most `slack` outside. The result is usually empty. */
struct gd__turn gd__branch_domain(const struct gd_field *field, const struct gd__sources *sources,
                                  const struct gd__branch *branch, const uint32_t pair[2],
                                  double slack);

/* Removes the sources at corners of the face where no path bends. A straight path through such a
 * corner belongs to a source behind the corner. */
void gd__sources_drop_needless(const struct gd_field *field, struct gd__sources *sources);

/* Returns an upper bound of the distances in a face; at least GD__FAR if it is not reached. */
double gd__face_farthest(const struct gd_field *field, uint32_t face);
