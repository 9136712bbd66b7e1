/* Diagram: Voronoi diagrams and what must be true of them. Each check fails the running test. */
#ifndef TESTS_SUPPORT_DIAGRAM_H
#define TESTS_SUPPORT_DIAGRAM_H

#include "gd/voronoi.h"
#include "tests/support/test.h"

/* Members: each a point, or a curve of points and the segments between them. All zero is none. */
struct member_set {
    struct gd_seed *seeds;
    uint32_t *member_of_seed;
    uint32_t seed_count, count;
};

void member_set_put_point(struct member_set *set, struct gd_point point, double offset);

/* Consecutive points lie within one face; of a closed curve the last and the first too. */
void member_set_put_curve(struct member_set *set, const struct gd_point *points, uint32_t count,
                          bool closed, double offset);

/* The shortest path between two points. */
void member_set_put_path(struct member_set *set, const struct gd_mesh *mesh, struct gd_point from,
                         struct gd_point to);

/* Adds the last member's seeds to the one before it. */
void member_set_join(struct member_set *set);
void member_set_free(struct member_set *set);

/* A diagram, and all that it is checked by. */
struct diagram {
    const struct gd_mesh *mesh;
    const struct member_set *set;
    struct gd_field *field, **alone; /* of all members; of each */
    struct gd_voronoi voronoi;
    double size; /* the greatest distance of a vertex from a member */
};

/* The set is borrowed. */
struct diagram diagram_of(const struct gd_mesh *mesh, const struct member_set *set,
                          double tolerance);
void diagram_free(struct diagram *diagram);

/* Ends of bisectors within rounding of a place. */
uint32_t diagram_ends_at(const struct diagram *diagram, const struct gd_point *point);
double diagram_length(const struct diagram *diagram); /* of all bisectors */

/* Bisectors: both members are as near to each vertex, nothing is nearer, and they end on the
 * boundary or where three do. Labels are of members that are as near as any. Where other members
 * are nearest along an edge, a bisector crosses it in between. */
void check_diagram(const struct diagram *diagram);

#endif
