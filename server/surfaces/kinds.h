/* The objects of NURBS and subdivision surfaces. */
#pragma once

#include "gd/subdivision.h"
#include "gd/tessellation.h"
#include "proto/queries/nurbs.h"
#include "server/fields/discretizations.h"
#include "server/surfaces/surface.h"

/* A parametric surface, and the mesh on which its shortest paths are first searched. */
struct server_nurbs {
    struct gd_parametric *surface;
    struct proto_nurbs_form form;
    /* NULL means that there is none; `refusal` and `detail` give the reason */
    struct gd_tessellation *tessellation;
    enum gd_status refusal;
    struct gd_detail detail;
};

/* A subdivision surface, and its cached discretizations. */
struct server_subdivision {
    struct gd_subdivision *surface;
    /* guarded by the lock of its owner (discretizations.h); all other members are immutable */
    struct server_discretization_slot slot;
};

/* Return the object of a surface of that kind, borrowed. */
static inline const struct server_nurbs *server_nurbs_of(const struct server_surface *surface)
{
    return surface->object;
}
static inline struct server_subdivision *server_subdivision_of(const struct server_surface *surface)
{
    return surface->object;
}
