/* Flight: a straight line on its way from face to face. It enters the face of `side` over that
 * side, `t` from its origin, in the direction (dx, dy) of the side's frame, a unit vector with dy
 * >= 0. Nothing is rotated in space: crossing a face reads one record of the mesh. */
#ifndef GD_TRANSPORT_FLIGHT_H
#define GD_TRANSPORT_FLIGHT_H

#include "mesh/topology.h"

struct gd__flight {
    uint32_t side; /* without a face when the line has come to the boundary */
    double t, dx, dy;
};

/* How a face was crossed: the length of the edge by which it was left, and of the way. Where the
 * line runs into the end of an edge up to rounding, t may lie off the edge by some, or be NaN: not
 * between the ends; and `run` is of no use. */
struct gd__passage {
    double edge, run;
};

static inline void gd__flight_turn(struct gd__flight *flight, double x, double y)
{
    /* one step of Newton keeps the length at 1 over any number of faces */
    double length = x * x + y * y, scale = 1.5 - 0.5 * length;
    flight->dx = x * scale;
    flight->dy = y * scale;
}

/* Leaves the face of the flight's side, whose record is `s`: by the edge to the left, origin ->
 * apex, or to the right, apex -> destination. With u along the edge, sin = |u x d| is the new dy,
 * so one division gives both where and how far. A line from the side's origin itself goes right. */
static inline struct gd__passage gd__flight_cross(const struct gd_side *s,
                                                  struct gd__flight *flight)
{
    double t = flight->t, dx = flight->dx, dy = flight->dy;
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y; /* apex */
    if ((px - t) * dy - py * dx > 0 && t > 0) {
        double sine = s->left_x * dy - s->left_y * dx, inverse = 1 / sine;
        flight->side = s->left;
        flight->t = t * dy * inverse;
        gd__flight_turn(flight, s->left_x * dx + s->left_y * dy, sine);
        return (struct gd__passage){s->left_length, t * s->left_y * inverse};
    }
    double sine = s->right_x * dy - s->right_y * dx, inverse = 1 / sine, rest = s->length - t;
    flight->side = s->right;
    flight->t = s->right_length - rest * dy * inverse;
    gd__flight_turn(flight, s->right_x * dx + s->right_y * dy, sine);
    return (struct gd__passage){s->right_length, -rest * s->right_y * inverse};
}

#endif
