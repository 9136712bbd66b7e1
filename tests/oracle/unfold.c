#include "tests/oracle/unfold.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

typedef long double real;

struct place {
    real x, y;
};

/* A triangle and its position in the original face, of which it is a part. */
struct face {
    uint32_t corner[3];
    uint32_t original;
    real weight[3][3]; /* barycentric coordinates of each corner in the original face */
    /* the face across the edge opposite to each corner, or NONE at the boundary */
    uint32_t across[3];
    /* true if the current unfolding contains the face, because no shortest path enters a face twice
       */
    bool passed;
};

struct unfold_mesh {
    real (*position)[3];
    struct face *face;
    uint32_t vertex_count, face_count, face_capacity;
    /* the distances of vertices; they are upper bounds until the end, and then exact */
    real *distance;
    bool linked; /* `across` is up to date */
};

static const uint32_t NONE = UINT32_MAX;

/* --- the mesh --------------------------------------------------------------------------------- */

struct unfold_mesh *unfold_create(const double (*positions)[3], uint32_t position_count,
                                  const uint32_t *corners, uint32_t face_count, uint32_t insertions)
{
    struct unfold_mesh *mesh = calloc(1, sizeof *mesh);
    if (!mesh) return NULL;
    mesh->face_capacity = face_count + 2 * insertions;
    mesh->position = calloc(position_count + insertions + 1, sizeof *mesh->position);
    mesh->face = calloc(mesh->face_capacity + 1, sizeof *mesh->face);
    if (!mesh->position || !mesh->face) {
        unfold_free(mesh);
        return NULL;
    }
    mesh->vertex_count = position_count;
    mesh->face_count = face_count;
    for (uint32_t v = 0; v < position_count; v++)
        for (int k = 0; k < 3; k++) mesh->position[v][k] = positions[v][k];
    for (uint32_t f = 0; f < face_count; f++) {
        struct face *face = &mesh->face[f];
        face->original = f;
        for (int k = 0; k < 3; k++) face->corner[k] = corners[3 * f + k], face->weight[k][k] = 1;
    }
    return mesh;
}

void unfold_free(struct unfold_mesh *mesh)
{
    if (!mesh) return;
    free(mesh->position);
    free(mesh->face);
    free(mesh);
}

static void link_faces(struct unfold_mesh *mesh)
{
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        for (int k = 0; k < 3; k++) {
            const uint32_t *corner = mesh->face[f].corner, a = corner[(k + 1) % 3],
                           b = corner[(k + 2) % 3];
            mesh->face[f].across[k] = NONE;
            for (uint32_t g = 0; g < mesh->face_count; g++) {
                const uint32_t *other = mesh->face[g].corner;
                bool has_a = other[0] == a || other[1] == a || other[2] == a;
                bool has_b = other[0] == b || other[1] == b || other[2] == b;
                if (g != f && has_a && has_b) mesh->face[f].across[k] = g;
            }
        }
    }
    mesh->linked = true;
}

/* --- inserting points ------------------------------------------------------------------------- */

static real determinant(const real a[3], const real b[3], const real c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Converts barycentric coordinates in the original face to coordinates in a part. Returns the
 * smallest coordinate. */
static real weights_in(const struct face *part, const real weight[3], real out[3])
{
    real total = determinant(part->weight[0], part->weight[1], part->weight[2]), least = INFINITY;
    for (int k = 0; k < 3; k++) {
        out[k] = determinant(weight, part->weight[(k + 1) % 3], part->weight[(k + 2) % 3]) / total;
        if (out[k] < least) least = out[k];
    }
    return least;
}

/* Returns the part of the original face in which the point lies deepest. */
static struct face *part_around(struct unfold_mesh *mesh, uint32_t original, const real weight[3],
                                real local[3])
{
    struct face *best = NULL;
    real deepest = -INFINITY;
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        real least = mesh->face[f].original == original ? weights_in(&mesh->face[f], weight, local)
                                                        : -INFINITY;
        if (least <= deepest) continue;
        deepest = least;
        best = &mesh->face[f];
    }
    assert(best);
    weights_in(best, weight, local);
    return best;
}

/* Adds a copy of `face` with `vertex` as its corner k. `weight` are the vertex' weights in the
 * original face. */
static void add_part(struct unfold_mesh *mesh, const struct face *face, int k, uint32_t vertex,
                     const real weight[3])
{
    assert(mesh->face_count < mesh->face_capacity);
    struct face *part = &mesh->face[mesh->face_count++];
    *part = *face;
    part->corner[k] = vertex;
    memcpy(part->weight[k], weight, sizeof part->weight[k]);
}

static void replace_corner(struct face *face, int k, uint32_t vertex, const real weight[3])
{
    face->corner[k] = vertex;
    memcpy(face->weight[k], weight, sizeof face->weight[k]);
}

/* Splits every face that has the edge a-b at the vertex (1 - t) a + t b. */
static void split_edge(struct unfold_mesh *mesh, uint32_t a, uint32_t b, real t, uint32_t vertex)
{
    for (uint32_t f = 0, count = mesh->face_count; f < count; f++) {
        struct face *face = &mesh->face[f];
        int at_a = -1, at_b = -1;
        for (int k = 0; k < 3; k++) {
            if (face->corner[k] == a) at_a = k;
            if (face->corner[k] == b) at_b = k;
        }
        if (at_a < 0 || at_b < 0) continue;
        real weight[3];
        for (int k = 0; k < 3; k++)
            weight[k] = (1 - t) * face->weight[at_a][k] + t * face->weight[at_b][k];
        add_part(mesh, face, at_a, vertex, weight);
        replace_corner(face, at_b, vertex, weight);
    }
}

uint32_t unfold_insert(struct unfold_mesh *mesh, uint32_t original, const double barycentric[3])
{
    real weight[3] = {barycentric[0], barycentric[1], barycentric[2]}, local[3];
    struct face *face = part_around(mesh, original, weight, local);
    int zeros = 0, zero = 0, largest = 0;
    for (int k = 0; k < 3; k++) {
        if (local[k] <= 0) zeros++, zero = k;
        if (local[k] > local[largest]) largest = k;
    }
    if (zeros == 2) return face->corner[largest];
    uint32_t vertex = mesh->vertex_count++;
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 3; k++)
            mesh->position[vertex][axis] += local[k] * mesh->position[face->corner[k]][axis];
    mesh->linked = false;
    if (zeros == 1) {
        int a = (zero + 1) % 3, b = (zero + 2) % 3;
        split_edge(mesh, face->corner[a], face->corner[b], local[b] / (local[a] + local[b]),
                   vertex);
        return vertex;
    }
    add_part(mesh, face, 0, vertex, weight);
    add_part(mesh, face, 1, vertex, weight);
    replace_corner(face, 2, vertex, weight);
    return vertex;
}

/* --- unfolding -------------------------------------------------------------------------------- */

static real cross(struct place a, struct place b)
{
    return a.x * b.y - a.y * b.x;
}

static real between(const struct unfold_mesh *mesh, uint32_t a, uint32_t b)
{
    const real *p = mesh->position[a], *q = mesh->position[b];
    return hypotl(hypotl(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
}

/* Returns the position of c on the left of the line from a to b. The caller knows the positions of
 * a and b. */
static struct place lay_left(const struct unfold_mesh *mesh, uint32_t a, uint32_t b, uint32_t c,
                             struct place at_a, struct place at_b)
{
    const real *p = mesh->position[a], *q = mesh->position[b], *r = mesh->position[c];
    real u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]},
         v[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
    real n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    real square = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
    real along = (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / square;
    real aside = sqrtl(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / square;
    struct place d = {at_b.x - at_a.x, at_b.y - at_a.y};
    return (struct place){at_a.x + along * d.x - aside * d.y, at_a.y + along * d.y + aside * d.x};
}

/* An edge in the plane, with the source at the origin, and the cone of directions that reach it. */
struct cone {
    uint32_t right, left; /* the edge's vertices */
    struct place at_right, at_left;
    struct place from, to;
    uint32_t ahead;  /* the face beyond the edge */
    uint32_t origin; /* vertex of the source */
};

/* Returns the distance of the origin from the segment a-b. */
static real distance_to_segment(struct place a, struct place b)
{
    struct place d = {b.x - a.x, b.y - a.y};
    real t = -(a.x * d.x + a.y * d.y) / (d.x * d.x + d.y * d.y);
    t = t > 0 ? t < 1 ? t : 1 : 0;
    return hypotl(a.x + t * d.x, a.y + t * d.y);
}

/* Returns whether every path through the cone to a point of the edge is longer than a known path to
 * this point. */
static bool is_hopeless(const struct unfold_mesh *mesh, const struct cone *cone)
{
    real length = hypotl(cone->at_left.x - cone->at_right.x, cone->at_left.y - cone->at_right.y);
    real known = (mesh->distance[cone->left] + mesh->distance[cone->right] + length) / 2;
    return mesh->distance[cone->origin] + distance_to_segment(cone->at_right, cone->at_left) >
           known * (1 + 1e-12L);
}

static int corner_of(const struct face *face, uint32_t vertex)
{
    return face->corner[0] == vertex ? 0 : face->corner[1] == vertex ? 1 : 2;
}

static void improve(struct unfold_mesh *mesh, uint32_t vertex, real distance)
{
    if (distance < mesh->distance[vertex]) mesh->distance[vertex] = distance;
}

static void unfold(struct unfold_mesh *mesh, const struct cone *cone)
{
    if (cone->ahead == NONE || mesh->face[cone->ahead].passed || is_hopeless(mesh, cone)) return;
    struct face *face = &mesh->face[cone->ahead];
    int k = 0;
    while (face->corner[k] == cone->right || face->corner[k] == cone->left) k++;
    uint32_t apex = face->corner[k];
    struct place at = lay_left(mesh, cone->left, cone->right, apex, cone->at_left, cone->at_right);
    bool left_of_from = cross(cone->from, at) >= 0, right_of_to = cross(at, cone->to) >= 0;
    if (left_of_from && right_of_to)
        improve(mesh, apex, mesh->distance[cone->origin] + hypotl(at.x, at.y));
    face->passed = true;
    if (left_of_from)
        unfold(mesh, &(struct cone){cone->right, apex, cone->at_right, at, cone->from,
                                    right_of_to ? at : cone->to,
                                    face->across[corner_of(face, cone->left)], cone->origin});
    if (right_of_to)
        unfold(mesh,
               &(struct cone){apex, cone->left, at, cone->at_left, left_of_from ? at : cone->from,
                              cone->to, face->across[corner_of(face, cone->right)], cone->origin});
    face->passed = false;
}

static void walk_edges(struct unfold_mesh *mesh, uint32_t vertex)
{
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        const uint32_t *corner = mesh->face[f].corner;
        if (corner[0] != vertex && corner[1] != vertex && corner[2] != vertex) continue;
        for (int k = 0; k < 3; k++)
            improve(mesh, corner[k], mesh->distance[vertex] + between(mesh, vertex, corner[k]));
    }
}

/* Finds all straight segments from a vertex whose distance is known. */
static void unfold_from(struct unfold_mesh *mesh, uint32_t vertex)
{
    walk_edges(mesh, vertex);
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        struct face *face = &mesh->face[f];
        int k = corner_of(face, vertex);
        if (face->corner[k] != vertex) continue;
        uint32_t right = face->corner[(k + 1) % 3], left = face->corner[(k + 2) % 3];
        struct place at_right = {between(mesh, vertex, right), 0};
        struct place at_left = lay_left(mesh, vertex, right, left, (struct place){0, 0}, at_right);
        face->passed = true;
        unfold(mesh, &(struct cone){right, left, at_right, at_left, at_right, at_left,
                                    face->across[k], vertex});
        face->passed = false;
    }
}

/* Dijkstra's algorithm over the vertices. `relax` improves distances from a vertex. On entry
 * mesh->distance has upper bounds. */
static void settle_all(struct unfold_mesh *mesh, void (*relax)(struct unfold_mesh *, uint32_t))
{
    bool *settled = calloc(mesh->vertex_count, sizeof *settled);
    assert(settled);
    for (;;) {
        uint32_t next = NONE;
        for (uint32_t v = 0; v < mesh->vertex_count; v++)
            if (!settled[v] && isfinite(mesh->distance[v]) &&
                (next == NONE || mesh->distance[v] < mesh->distance[next]))
                next = v;
        if (next == NONE) break;
        settled[next] = true;
        relax(mesh, next);
    }
    free(settled);
}

void unfold_distances(struct unfold_mesh *mesh, uint32_t source, long double *out)
{
    if (!mesh->linked) link_faces(mesh);
    mesh->distance = out;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) out[v] = INFINITY;
    out[source] = 0;
    settle_all(mesh, walk_edges);
    settle_all(mesh, unfold_from);
}
