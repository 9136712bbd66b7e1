/* Nodes: the points of a cut, which are vertices of the mesh and new points on edges and in faces.
 *
 * Nodes with numbers below the mesh's vertex_count are its vertices. Larger numbers are new nodes.
 * The reach of a face is `snap` times its longest edge. A point within the reach of a vertex, a
 * side or another node is moved onto it, so that nodes on one edge or inside one face are at least
 * the reach apart. Normalised unit. */
#pragma once

#include "base/arena.h"
#include "cut/lattice.h"
#include "mesh/local.h"

struct gd__node {
    struct gd_point point; /* the node's point, on an edge or in a face */
    /* for a node on an edge, u is the parameter along the edge, and v is 0; for a node in a face,
       the position in the face */
    struct gd__site site;
    uint32_t next; /* the next node of the same edge or face; GD_NONE for the last one */
};

struct gd__nodes {
    const struct gd_mesh *mesh;
    struct gd__arena *arena; /* has the arrays */
    double snap;
    double shift; /* largest distance by which a point was moved */
    struct gd__node *items;
    uint32_t count, capacity;
    uint32_t *of_edge, *of_face; /* first node of each edge and face, or GD_NONE if there is none */
};

/* Allocates an array of numbers that are all GD_NONE. Returns NULL on a failure of the arena. */
uint32_t *gd__cut_numbers(struct gd__arena *arena, size_t count);

/* Finds or creates the node at a point. Errors: GD_NO_MEMORY, GD_BUDGET, GD_TOO_LARGE. */
GD_MUST_USE enum gd_status gd__node_of_point(struct gd__nodes *nodes, const struct gd_point *point,
                                             uint32_t *out);

/* Finds or creates the node at a position in a face, given by the barycentric coordinates of
 * corners 1 and 2. Errors: those of gd__node_of_point. */
GD_MUST_USE enum gd_status gd__node_in_face(struct gd__nodes *nodes, uint32_t face, double u,
                                            double v, uint32_t *out);

/* Returns the new node with that number, or NULL if the number is that of a vertex. */
static inline const struct gd__node *gd__node(const struct gd__nodes *nodes, uint32_t node)
{
    return node < nodes->mesh->vertex_count ? NULL
                                            : &nodes->items[node - nodes->mesh->vertex_count];
}

/* Returns a node as a point of the mesh. */
struct gd_point gd__node_point(const struct gd__nodes *nodes, uint32_t node);

/* Returns a mask of the face's sides on which the node lies: bit k stands for side k. A corner lies
 * on two sides, and a node inside the face on none. */
uint32_t gd__node_sides(const struct gd__nodes *nodes, uint32_t face, uint32_t node);

/* Return the position, in a face, of a point or a node of the face. */
struct gd__site gd__site_of_point(const struct gd_mesh *mesh, uint32_t face,
                                  const struct gd_point *point);
struct gd__site gd__node_site(const struct gd__nodes *nodes, uint32_t face, uint32_t node);

/* Returns a site's position in the frame of the face's side 0. */
struct gd__local gd__site_local(const struct gd_mesh *mesh, uint32_t face, struct gd__site site);

/* Returns the reach of a face. Positions that are closer than this become the same node. */
double gd__nodes_reach(const struct gd__nodes *nodes, uint32_t face);

/* Iterates over the nodes of a face: its corners, the nodes on its sides, the nodes inside.
 *
 *     struct gd__node_walk walk = {0};
 *     while ((node = gd__nodes_walk(nodes, face, &walk)) != GD_NONE) … */
struct gd__node_walk {
    uint32_t stage, next;
};
uint32_t gd__nodes_walk(const struct gd__nodes *nodes, uint32_t face, struct gd__node_walk *walk);
