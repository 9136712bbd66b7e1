/* Taut: shortest paths in a trimmed domain.
 *
 * DESIGN
 * - A taut path consists of geodesics of the surface and of parts of loops (contacts, contact.h).
 *   It leaves a loop along its tangent, or at a corner, and turns towards the obstacle wherever it
 *   touches the obstacle. These are the conditions of a local minimum among the paths that do not
 *   leave the domain.
 * - The exact geodesic of the trimmed tessellation gives the class of the path and its first
 *   contacts. Each *gap* (a part of the path before, between or after contacts) is computed as a
 *   geodesic without constraint. Then the ends of the contacts move. Let a be the angle between
 *   path and loop at such an end, and k the geodesic curvature of the loop. After a step of about a
 *   / k along the loop, the angle is 0. Near the solution the loop is tangential to the gap, so
 *   this step moves the end of the gap along the gap itself. Therefore the steps of neighbouring
 *   contacts do not influence each other, and they converge as Newton's method does.
 * - A gap that leaves the domain gets a contact on the side of the obstacle on which the path of
 *   the tessellation passes it. A contact at which the path turns away from the obstacle is
 *   removed.
 * - A path is accepted only if all conditions hold: each gap is a geodesic that Newton's method
 *   proves to be a local minimum, no gap leaves the domain, the path is tangential to loops, and
 *   each contact presses against the obstacle. */
#pragma once

#include "nurbs/candidate.h"
#include "nurbs/contact.h"
#include "nurbs/seeds.h"

struct gd__gap {
    struct gd__uv_polyline line; /* initial path */
    bool is_solved, is_empty;    /* `is_empty` is true if both ends are the same place */
    struct gd__solution solution;
};

struct gd__taut {
    const struct gd__task *task;
    const struct gd_domain_curve *const *ends; /* the two curves at the path's ends */
    const struct gd__path_seed *seed;          /* the path of the tessellation */
    double s[2];                               /* parameters of the path's ends on the curves */
    struct gd__contacts contacts;
    /* there are contacts.count + 1 gaps; gap i leads to contact i */
    uint32_t gap_count, gap_capacity;
    struct gd__gap *gaps;
    double residual; /* largest angle by which the path violates a condition */
    double length, error;
    bool is_taut; /* true if all conditions hold */
};

/* Computes the taut path of a seed. The first contacts are where the seed touches loops, or, if
 * `is_free`, none. `out->is_taut` is false if the conditions do not hold after a limited number of
 * steps. Errors: those of gd__newton. */
GD_MUST_USE enum gd_status gd__taut_solve(const struct gd__task *task,
                                          const struct gd_domain_curve *const ends[2],
                                          const struct gd__path_seed *seed, bool is_free,
                                          struct gd__taut *out);

void gd__taut_free(struct gd__taut *taut);

/* The place `at` where a gap is farthest outside the domain, the nearest place of the loops, and
 * the gap's velocity there. gd__gap_check sets *inside to true if the gap does not leave the
 * domain, and otherwise fills this struct. */
struct gd__leaving {
    struct gd__loop_place place;
    double at[2];
    double shift[2]; /* whole periods between the loop and the gap */
    /* The gap is outside the domain between these two places of the loop. `has_crossings` is false
       if they are not known, because the gap passes between the loop and its samples. */
    double s[2];
    bool has_crossings;
    struct gd_vec3 velocity;
    uint32_t sample; /* index of the last sample before `at`, or at it */
    bool is_sample;  /* true if `at` is a sample */
    struct gd__uv_polyline samples;
};
GD_MUST_USE enum gd_status gd__gap_check(const struct gd__chain *chain, bool *inside,
                                         struct gd__leaving *out);

/* Computes the contact for a gap that leaves the domain: on the side on which the seed passes the
 * obstacle, where the loop is farthest from the gap. */
struct gd__contact gd__passing_contact(const struct gd__taut *taut, uint32_t gap,
                                       const struct gd__leaving *leaving);

/* Returns true if the path passes each hole on the same side as its seed. Returns false if the pace
 * stops. */
bool gd__passing_agrees(const struct gd__taut *taut);

/* Computes all taut paths, or the shortest one, in a trimmed domain. Errors: those of gd__newton,
 * and GD_INTERNAL (a path that may be shortest is not proven). */
GD_MUST_USE enum gd_status gd__taut_paths(const struct gd__task *task,
                                          const struct gd_domain_curve *const ends[2],
                                          const struct gd__path_seeds *seeds, bool all,
                                          struct gd_geodesics *out);

/* Converts a taut path to the caller's struct. Errors: GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__taut_answer(const struct gd__taut *taut, struct gd_geodesic *out);
