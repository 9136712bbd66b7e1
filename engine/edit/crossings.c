#include "edit/crossings.h"

#include <math.h>

#include "base/pace.h"
#include "base/tolerance.h"
#include "mesh/bvh.h"

/* number of pace steps for one search, because a search takes some microseconds */
#define STEPS_A_SEARCH 40

struct triangle {
    uint32_t vertex[3];
    struct gd_vec3 place[3];
};

struct crossing_search {
    struct gd__bvh_search search; /* the key of each face that may cross is 0 */
    const struct gd_mesh *mesh;
    uint32_t *crossed;
    uint32_t face;
    struct triangle triangle; /* the corners of `face` */
    struct gd__box box;
};

static struct triangle triangle_of(const struct gd_mesh *mesh, uint32_t face)
{
    struct triangle t;
    for (int k = 0; k < 3; k++) {
        t.vertex[k] = mesh->origin[mesh->face_side[face][k]];
        t.place[k] = mesh->position[t.vertex[k]];
    }
    return t;
}

static bool has_vertex(const struct triangle *t, uint32_t vertex)
{
    return t->vertex[0] == vertex || t->vertex[1] == vertex || t->vertex[2] == vertex;
}

static struct gd_vec3 normal_of(const struct triangle *t)
{
    return gd_vec3_cross(gd_vec3_sub(t->place[1], t->place[0]),
                         gd_vec3_sub(t->place[2], t->place[0]));
}

/* Returns six times the volume of the tetrahedron a, b, c, d; positive if d lies above the
 * counter-clockwise triangle a, b, c. */
static double volume(struct gd_vec3 a, struct gd_vec3 b, struct gd_vec3 c, struct gd_vec3 d)
{
    struct gd_vec3 normal = gd_vec3_cross(gd_vec3_sub(b, a), gd_vec3_sub(c, a));
    return gd_vec3_dot(normal, gd_vec3_sub(d, a));
}

/* Returns true if the segment from p to q passes through the inside of the triangle. */
static bool pierces(struct gd_vec3 p, struct gd_vec3 q, const struct triangle *t)
{
    const struct gd_vec3 *c = t->place;
    if (!(volume(c[0], c[1], c[2], p) * volume(c[0], c[1], c[2], q) < 0)) return false;
    double turns[3];
    for (int k = 0; k < 3; k++) turns[k] = volume(p, q, c[k], c[(k + 1) % 3]);
    return (turns[0] > 0 && turns[1] > 0 && turns[2] > 0) ||
           (turns[0] < 0 && turns[1] < 0 && turns[2] < 0);
}

/* Returns true if an edge of `a` that has no corner in `b` passes through `b`. */
static bool an_edge_pierces(const struct triangle *a, const struct triangle *b)
{
    for (int k = 0; k < 3; k++) {
        int next = (k + 1) % 3;
        if (!has_vertex(b, a->vertex[k]) && !has_vertex(b, a->vertex[next]) &&
            pierces(a->place[k], a->place[next], b))
            return true;
    }
    return false;
}

static bool is_folded(const struct triangle *a, const struct triangle *b)
{
    struct gd_vec3 m = normal_of(a), n = normal_of(b);
    return gd_vec3_dot(m, n) < -cos(GD_TOL_EDIT_FOLD) * gd_vec3_length(m) * gd_vec3_length(n);
}

static bool cross(const struct triangle *a, const struct triangle *b)
{
    int shared = 0;
    for (int k = 0; k < 3; k++) shared += has_vertex(b, a->vertex[k]);
    return shared < 2 ? an_edge_pierces(a, b) || an_edge_pierces(b, a) : is_folded(a, b);
}

/* --- the search ------------------------------------------------------------------------------- */

static double box_bound(const struct gd__bvh_search *search, const struct gd__box *box)
{
    const struct gd__box *own = &((const struct crossing_search *)search)->box;
    bool is_apart = own->max.x < box->min.x || box->max.x < own->min.x || own->max.y < box->min.y ||
                    box->max.y < own->min.y || own->max.z < box->min.z || box->max.z < own->min.z;
    return is_apart ? INFINITY : 0;
}

static void visit_face(struct gd__bvh_search *search, uint32_t face)
{
    struct crossing_search *own = (struct crossing_search *)search;
    const struct gd_mesh *mesh = own->mesh;
    if (face <= own->face) return; /* so each pair of faces is tested once */
    const struct triangle other = triangle_of(mesh, face);
    if (!cross(&own->triangle, &other)) return;
    uint32_t a = mesh->index_of_face[own->face], b = mesh->index_of_face[face];
    if (b < own->crossed[a]) own->crossed[a] = b;
    if (a < own->crossed[b]) own->crossed[b] = a;
}

static void begin_face(struct crossing_search *own, uint32_t face)
{
    own->face = face;
    own->triangle = triangle_of(own->mesh, face);
    const struct gd_vec3 *c = own->triangle.place;
    own->box =
        (struct gd__box){{fmin(fmin(c[0].x, c[1].x), c[2].x), fmin(fmin(c[0].y, c[1].y), c[2].y),
                          fmin(fmin(c[0].z, c[1].z), c[2].z)},
                         {fmax(fmax(c[0].x, c[1].x), c[2].x), fmax(fmax(c[0].y, c[1].y), c[2].y),
                          fmax(fmax(c[0].z, c[1].z), c[2].z)}};
}

enum gd_status gd__find_crossings(const struct gd_polygons *triangles,
                                  const struct gd_control *control, uint32_t *crossed)
{
    struct gd_mesh *mesh;
    enum gd_status status = gd_mesh_build(triangles, NULL, control, &mesh, NULL);
    if (status) return status;
    memset(crossed, 0xff, triangles->polygon_count * sizeof *crossed);
    struct gd__pace pace = {.control = control, .fraction = 1};
    struct crossing_search own = {
        .search = {0, box_bound, visit_face}, .mesh = mesh, .crossed = crossed};
    for (uint32_t f = 0; f < mesh->face_count && gd__pace(&pace, STEPS_A_SEARCH); f++) {
        begin_face(&own, f);
        gd__bvh_run(mesh, &own.search);
    }
    gd_mesh_release(mesh);
    return pace.status;
}
