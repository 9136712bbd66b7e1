#include "tests/oracle/naive_windows.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t NONE = UINT32_MAX;

struct naive_side {
    uint32_t face, side;
};

struct naive_mesh {
    double (*position)[3];
    uint32_t (*corner)[3];
    /* across[f][k] is a side of the neighbour that shares corners k and k + 1 with face f; its
     * `face` is NONE on the boundary */
    struct naive_side (*across)[3];
    bool *is_convex; /* true for each inner vertex with a total angle below 2 pi */
    uint32_t vertex_count, face_count;
};

#if LDBL_MANT_DIG == 113
typedef long double quadruple;
#else
typedef __float128 quadruple;
#endif

/* Returns the square root. Computes the root in extended precision, and then doubles its number of
 * digits by one step of Newton's method. */
static quadruple quadruple_sqrt(quadruple x)
{
    if (!(x > 0)) return 0;
    quadruple root = sqrtl((long double)x);
    return (root + x / root) / 2;
}

#define REAL         long double
#define REAL_SQRT(x) sqrtl(x)
#define REAL_SLACK   1e-17L
#define NAME(name)   extended_##name
#include "tests/oracle/naive_windows_solver.h"

#define REAL         quadruple
#define REAL_SQRT(x) quadruple_sqrt(x)
#define REAL_SLACK   1e-31L
#define NAME(name)   quadruple_##name
#include "tests/oracle/naive_windows_solver.h"

struct naive_field {
    struct extended_solver *extended; /* only the solver of the selected precision is set */
    struct quadruple_solver *quadruple;
};

/* --- the mesh --------------------------------------------------------------------------------- */

static struct naive_side find_across(const struct naive_mesh *mesh, uint32_t face, uint32_t side)
{
    uint32_t a = mesh->corner[face][side], b = mesh->corner[face][(side + 1) % 3];
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        for (uint32_t k = 0; f != face && k < 3; k++) {
            uint32_t c = mesh->corner[f][k], d = mesh->corner[f][(k + 1) % 3];
            if ((a == c && b == d) || (a == d && b == c)) return (struct naive_side){f, k};
        }
    }
    return (struct naive_side){NONE, 0};
}

static long double angle_at(const struct naive_mesh *mesh, uint32_t face, uint32_t k)
{
    const double *a = mesh->position[mesh->corner[face][k]],
                 *b = mesh->position[mesh->corner[face][(k + 1) % 3]],
                 *c = mesh->position[mesh->corner[face][(k + 2) % 3]];
    long double u[3], v[3], product = 0, area = 0;
    for (int i = 0; i < 3; i++) u[i] = (long double)b[i] - a[i], v[i] = (long double)c[i] - a[i];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        product += u[i] * v[i];
        area += (u[i] * v[j] - u[j] * v[i]) * (u[i] * v[j] - u[j] * v[i]);
    }
    return atan2l(sqrtl(area), product);
}

/* Sets is_convex. Vertices that are flat up to rounding count as saddles: an unnecessary source
 * costs only time. */
static bool find_convex(struct naive_mesh *mesh)
{
    long double *angle = calloc(mesh->vertex_count, sizeof *angle);
    if (!angle) return false;
    for (uint32_t f = 0; f < mesh->face_count; f++)
        for (uint32_t k = 0; k < 3; k++) angle[mesh->corner[f][k]] += angle_at(mesh, f, k);
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        mesh->is_convex[v] = angle[v] < 2 * M_PI - 1e-9;
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        for (uint32_t k = 0; k < 3; k++) {
            if (mesh->across[f][k].face != NONE) continue;
            mesh->is_convex[mesh->corner[f][k]] = mesh->is_convex[mesh->corner[f][(k + 1) % 3]] =
                false;
        }
    }
    free(angle);
    return true;
}

struct naive_mesh *naive_mesh_create(const double (*positions)[3], uint32_t position_count,
                                     const uint32_t *corners, uint32_t face_count)
{
    struct naive_mesh *mesh = calloc(1, sizeof *mesh);
    if (!mesh) return NULL;
    mesh->vertex_count = position_count;
    mesh->face_count = face_count;
    mesh->position = calloc(position_count, sizeof *mesh->position);
    mesh->corner = calloc(face_count, sizeof *mesh->corner);
    mesh->across = calloc(face_count, sizeof *mesh->across);
    mesh->is_convex = calloc(position_count, sizeof *mesh->is_convex);
    bool complete = mesh->position && mesh->corner && mesh->across && mesh->is_convex;
    if (complete) {
        memcpy(mesh->position, positions, position_count * sizeof *mesh->position);
        memcpy(mesh->corner, corners, face_count * sizeof *mesh->corner);
        for (uint32_t f = 0; f < face_count; f++)
            for (uint32_t k = 0; k < 3; k++) mesh->across[f][k] = find_across(mesh, f, k);
    }
    if (complete && find_convex(mesh)) return mesh;
    naive_mesh_free(mesh);
    return NULL;
}

void naive_mesh_free(struct naive_mesh *mesh)
{
    if (!mesh) return;
    free(mesh->position);
    free(mesh->corner);
    free(mesh->across);
    free(mesh->is_convex);
    free(mesh);
}

/* --- fields ----------------------------------------------------------------------------------- */

struct naive_field *naive_field_solve(const struct naive_mesh *mesh, enum naive_precision precision,
                                      const struct naive_source *sources, uint32_t source_count,
                                      long double radius)
{
    struct naive_field *field = calloc(1, sizeof *field);
    if (!field) return NULL;
    if (precision == NAIVE_EXTENDED)
        field->extended = extended_solve(mesh, sources, source_count, radius);
    else
        field->quadruple = quadruple_solve(mesh, sources, source_count, radius);
    if (field->extended || field->quadruple) return field;
    free(field);
    return NULL;
}

void naive_field_free(struct naive_field *field)
{
    if (!field) return;
    extended_close(field->extended);
    quadruple_close(field->quadruple);
    free(field);
}

long double naive_field_distance(const struct naive_field *field, const struct naive_point *point)
{
    return field->extended ? extended_distance(field->extended, point)
                           : (long double)quadruple_distance(field->quadruple, point);
}

long double naive_field_vertex_distance(const struct naive_field *field, uint32_t vertex)
{
    return field->extended ? field->extended->distance[vertex]
                           : (long double)field->quadruple->distance[vertex];
}

uint32_t naive_field_windows(const struct naive_field *field)
{
    return field->extended ? field->extended->window_count : field->quadruple->window_count;
}
