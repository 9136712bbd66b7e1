/* Nodes: the points that a cut runs through. Vertices of the mesh, and new points of edges and
 * faces.
 *
 * Numbers below the mesh's vertex_count are its vertices; the others are new nodes. What lies
 * closer than `snap` times the longest edge of a face to a vertex, to a side or to another node IS
 * there: so nodes of one edge or inside one face keep that distance. Inside unit. */
#ifndef GD_CUT_NODES_H
#define GD_CUT_NODES_H

#include "base/budget.h"
#include "cut/lattice.h"
#include "mesh/local.h"

struct gd__node {
    struct gd_point point; /* of an edge or a face */
    struct gd__site site;  /* edge: u is the parameter, v 0; face: in the face */
    uint32_t next;         /* of the same edge or face; GD_NONE: the last */
};

struct gd__nodes {
    const struct gd_mesh *mesh;
    struct gd__budget *budget;
    double snap;
    double shift; /* the farthest that a point was moved */
    struct gd__node *items;
    uint32_t count, capacity;
    uint32_t *of_edge, *of_face; /* the first one of each; GD_NONE: there is none */
};

GD_MUST_USE enum gd_status gd__nodes_init(struct gd__nodes *nodes, const struct gd_mesh *mesh,
                                          double snap, struct gd__budget *budget);
void gd__nodes_free(struct gd__nodes *nodes); /* of one that is all zero: harmless */

/* The node where a point is, which may be a new one. GD_NO_MEMORY, GD_BUDGET, GD_TOO_LARGE. */
GD_MUST_USE enum gd_status gd__node_of_point(struct gd__nodes *nodes, const struct gd_point *point,
                                             uint32_t *out);

/* The same of a place in a face, by the barycentric coordinates of its corners 1 and 2. */
GD_MUST_USE enum gd_status gd__node_in_face(struct gd__nodes *nodes, uint32_t face, double u,
                                            double v, uint32_t *out);

/* A node of a new number; NULL: a vertex. */
static inline const struct gd__node *gd__node(const struct gd__nodes *nodes, uint32_t node)
{
    return node < nodes->mesh->vertex_count ? NULL
                                            : &nodes->items[node - nodes->mesh->vertex_count];
}

/* As a point of the mesh. */
struct gd_point gd__node_point(const struct gd__nodes *nodes, uint32_t node);

/* The sides of the face that a node of it lies on, as bits: two for a corner, none inside. */
uint32_t gd__node_sides(const struct gd__nodes *nodes, uint32_t face, uint32_t node);

/* Where a point is in a face that it lies in or on. */
struct gd__site gd__site_of_point(const struct gd_mesh *mesh, uint32_t face,
                                  const struct gd_point *point);
struct gd__site gd__node_site(const struct gd__nodes *nodes, uint32_t face, uint32_t node);

/* A site in the frame of the face's side 0. */
struct gd__local gd__site_local(const struct gd_mesh *mesh, uint32_t face, struct gd__site site);

/* The distance below which things are one in a face. */
double gd__nodes_reach(const struct gd__nodes *nodes, uint32_t face);

/* Walks the nodes of a face: its corners, those on its sides, those inside.
 *     struct gd__node_walk walk = {0};
 *     while ((node = gd__nodes_walk(nodes, face, &walk)) != GD_NONE) … */
struct gd__node_walk {
    uint32_t stage, next;
};
uint32_t gd__nodes_walk(const struct gd__nodes *nodes, uint32_t face, struct gd__node_walk *walk);

#endif
