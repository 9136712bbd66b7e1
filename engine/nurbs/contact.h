/* Contact: a part of a trimming loop that a path follows, or touches in one place.
 *
 * The domain is on the left of each loop (loops/loops.h). So a path that runs in the direction of
 * the loop has the obstacle on its right. *Pressing* angles and curvatures are positive if they
 * turn towards the obstacle. A taut path turns towards the obstacle wherever it touches the
 * obstacle. */
#pragma once

#include "nurbs/uv_polyline.h"

struct gd__contact {
    uint32_t loop, span; /* the span of the loop on which the contact lies */
    /* 1 if the path runs in the direction of the loop, -1 if it runs in the opposite direction */
    int direction;
    double begin, end;  /* parameters on the span; (end - begin) * direction >= 0 */
    double least, most; /* bounds of these parameters: 0 and 1, or the end of the path */
    double shift[2];    /* whole periods that are added to the loop's places */
};

struct gd__contacts {
    uint32_t count, capacity;
    struct gd__contact *items; /* in the order of the path */
};

/* A place of a contact. `at` has its parameters. The other members describe it in space: the unit
 * tangent in the direction of the path, the surface's unit normal, the speed |dx/dt|, and the
 * pressing geodesic curvature of the loop. */
struct gd__contact_place {
    double at[2];
    struct gd_vec3 x, tangent, normal;
    double speed, curvature;
};

void gd__contact_at(const struct gd_parametric *surface, const struct gd__contact *contact,
                    double t, struct gd__contact_place *out);

/* Returns the pressing angle from one direction to another, in the tangent plane. */
double gd__contact_turn(const struct gd__contact *contact, struct gd_vec3 normal,
                        struct gd_vec3 from, struct gd_vec3 to);

static inline bool gd__contact_is_arc(const struct gd__contact *contact)
{
    return contact->begin != contact->end;
}

/* Computes the length of the contact in space. Adds the error of the quadrature to *error. */
double gd__contact_length(const struct gd_parametric *surface, const struct gd__contact *contact,
                          struct gd__pace *pace, double *error);

/* Returns the smallest pressing curvature of the contact, and sets *t to its parameter. */
double gd__contact_least_curvature(const struct gd_parametric *surface,
                                   const struct gd__contact *contact, double *t);

/* Returns a contact that consists of one place of a loop. `at` has the coordinates of this place
 * along the path, which may differ by whole periods. */
struct gd__contact gd__contact_touch(const struct gd_parametric *surface,
                                     const struct gd__loop_place *place, int direction,
                                     const double at[2]);

/* Makes room for `count` contacts before contact `index`. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__contacts_open(struct gd__contacts *contacts, uint32_t index,
                                             uint32_t count);

/* Inserts the contact. At a corner of the loop, inserts a second contact on the span beyond the
 * corner. Sets *added to the number of inserted contacts. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__contacts_insert(const struct gd_parametric *surface,
                                               struct gd__contacts *contacts, uint32_t index,
                                               const struct gd__contact *contact, uint32_t *added);

/* The path of a seed, as contacts and the polylines between them (gaps). Gap i leads to contact
 * i. */
struct gd__taut_parts {
    struct gd__contacts contacts;
    uint32_t gap_count, gap_capacity; /* contacts.count + 1 */
    struct gd__uv_polyline *gaps;
};

/* Divides a shortest path of the trimmed tessellation where it touches loops. Errors: GD_NO_MEMORY,
 * GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__taut_divide(const struct gd_parametric *surface,
                                           const struct gd__uv_polyline *polyline,
                                           struct gd__pace *pace, struct gd__taut_parts *out);

/* Makes a single gap of the whole path, without contacts. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__taut_join(const struct gd__uv_polyline *polyline,
                                         struct gd__taut_parts *out);

void gd__taut_parts_free(struct gd__taut_parts *parts);
