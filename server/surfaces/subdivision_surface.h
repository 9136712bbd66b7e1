/* Subdivision: the object of the kind `subdivision`: a surface, and a place for the discretizations
 * of it that are kept. */
#ifndef SERVER_SURFACES_SUBDIVISION_SURFACE_H
#define SERVER_SURFACES_SUBDIVISION_SURFACE_H

#include "gd/subdivision.h"
#include "server/surfaces/discretizations.h"

struct server_surface;

struct server_subdivision {
    struct gd_subdivision *surface;
    struct server_discretization_slot slot;
};

/* That of a surface of this kind; borrowed. Only its slot ever changes, under a lock of its own. */
struct server_subdivision *server_subdivision_of(const struct server_surface *surface);

#endif
