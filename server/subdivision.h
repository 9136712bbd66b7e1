/* Subdivision: the object of the kind `subdivision`: a surface, and a place for the discretizations of it that are kept. */
#ifndef SERVER_SUBDIVISION_H
#define SERVER_SUBDIVISION_H

#include "gd/subdivision.h"
#include "server/discretizations.h"

struct server_surface;

struct server_subdivision {
    struct gd_subdivision *surface;
    struct server_discretization_slot slot;
};

/* That of a surface of this kind; borrowed. Only its slot ever changes, under a lock of its own. */
struct server_subdivision *server_subdivision_of(const struct server_surface *surface);

#endif
