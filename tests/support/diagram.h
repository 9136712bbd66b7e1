/* Diagram: builds Voronoi diagrams and checks the properties of all Voronoi diagrams. A failed
 * check fails the running test. */
#pragma once

#include "gd/voronoi.h"
#include "tests/support/test.h"

/* A set of members. A member is a point, or a curve of points and the segments between them. If all
 * fields of the struct are zero, the set is empty. */
struct member_set {
    struct gd_seed *seeds;
    uint32_t *member_of_seed;
    uint32_t seed_count, count;
};

void member_set_put_point(struct member_set *set, struct gd_point point, double offset);

/* Adds a curve. Consecutive points must lie in one face. For a closed curve this also applies to
 * the last and the first point. */
void member_set_put_curve(struct member_set *set, const struct gd_point *points, uint32_t count,
                          bool closed, double offset);

/* Adds the shortest path between two points. */
void member_set_put_path(struct member_set *set, const struct gd_mesh *mesh, struct gd_point from,
                         struct gd_point to);

/* Merges the last member into the member before it. */
void member_set_join(struct member_set *set);
void member_set_free(struct member_set *set);

/* A diagram and the fields with which it is checked. */
struct diagram {
    const struct gd_mesh *mesh;
    const struct member_set *set;
    /* the field of all members, and the field of each single member */
    struct gd_field *field, **alone;
    struct gd_voronoi voronoi;
    double size; /* largest distance of a vertex from a member */
};

/* Builds the diagram. The set is borrowed. */
struct diagram diagram_of(const struct gd_mesh *mesh, const struct member_set *set,
                          double tolerance);
void diagram_free(struct diagram *diagram);

/* Returns the number of ends of bisectors at a point, within rounding. */
uint32_t diagram_ends_at(const struct diagram *diagram, const struct gd_point *point);
/* returns the sum of the lengths of all bisectors */
double diagram_length(const struct diagram *diagram);

/* Checks bisectors: both members are equidistant at each vertex, no member is nearer, and ends are
 * on the boundary or where three bisectors end. Checks that labels name nearest members. Checks
 * that a bisector crosses an edge where the nearest member changes. */
void check_diagram(const struct diagram *diagram);
