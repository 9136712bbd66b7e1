/* Candidate: a path between two curves that may become a result. It is one solution, or two
 * solutions that meet in a pole. A pole is a border of the domain whose places are all the same
 * point of the surface (gd/parametric.h). */
#pragma once

#include "nurbs/seeds.h"
#include "nurbs/solve.h"

#define GD__CANDIDATES_MOST 4

struct gd__candidate {
    /* number of solutions: 2 if the path passes through a pole, where the first one ends and the
       second one begins; otherwise 1 */
    uint32_t parts;
    bool tip; /* true if the path ends in a pole that a curve passes */
    /* True if the path passes through or near a pole, where a coarse curve is much too long. */
    bool by_pole;
    struct gd__solution part[2];
    /* number of the first candidate in this candidate's family of equally long paths; `is_family`
       is true if the family has other members */
    uint32_t family;
    bool is_family;
    uint32_t trims; /* number of times that the path was trimmed */
    /* These members identify a path: its length, and its points after a quarter and a half of the
     * length. Until gd__candidate_finish is called, they describe the coarse curve. */
    double coarse;
    struct gd_vec3 quarter, middle;
};

/* Computes at most GD__CANDIDATES_MOST coarse candidates along a seed. Near a pole, candidates are
 * also made for paths through the pole and on its other side. If a seed ends in a pole, a path
 * whose end is fixed there is also a candidate, because Newton's method moves a free end close to
 * the pole, but not into it. Errors: those of gd__newton. */
GD_MUST_USE enum gd_status gd__candidates_of_seed(const struct gd__task *task,
                                                  const struct gd_domain_curve *const ends[2],
                                                  const struct gd__path_seed *seed,
                                                  struct gd__candidate *out, uint32_t *count);

/* Refines a candidate until the tolerance is met. Errors: those of gd__newton. */
GD_MUST_USE enum gd_status gd__candidate_finish(const struct gd__task *task,
                                                struct gd__candidate *candidate);

/* Returns the joint at an end of a path. The end is on the curve, at the parameter s and the place
 * `at`. */
struct gd__joint gd__joint_of_end(const struct gd_domain_curve *curve, double s,
                                  const double at[2]);

void gd__candidate_free(struct gd__candidate *candidate);

double gd__candidate_length(const struct gd__candidate *candidate);

/* Returns true if Newton's method converged with a positive definite Hessian. */
bool gd__candidate_is_minimum(const struct gd__candidate *candidate);

/* Returns true if the path is a geodesic. This has three conditions. No part of the path is bent.
 * The path is straight at a pole that it passes. If the path ends in a pole that a curve passes, no
 * path to a nearby point of the curve is shorter. */
bool gd__candidate_is_geodesic(const struct gd__task *task, const struct gd__candidate *candidate);

/* Sets `coarse`, `quarter` and `middle`, which identify a path. */
void gd__candidate_identify(const struct gd_parametric *surface, struct gd__candidate *candidate);

/* Returns the parameter of the path's beginning (side 0) or end (side 1) on its curve, or 0 if the
 * curve is a point. */
double gd__candidate_parameter(const struct gd__candidate *candidate, int side);

/* Computes the winding numbers of the path: if its beginning has the coordinates of the first
 * curve, its end has those of the second curve plus out[k] periods in direction k. */
void gd__candidate_turns(const struct gd__candidate *candidate,
                         const struct gd_domain_curve *const ends[2], int32_t out[2]);
