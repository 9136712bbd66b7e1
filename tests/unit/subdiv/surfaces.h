/* Control meshes for the tests of subdivision surfaces. */
#pragma once

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/limit.h"
#include "tests/support/test.h"

static inline struct gd_subdivision *surface_of(const struct gd_control_mesh *mesh,
                                                enum gd_scheme scheme)
{
    struct gd_subdivision *surface = NULL;
    struct gd_detail detail = {0};
    check_ok(gd_subdivision_create(mesh, scheme, NULL, &surface, &detail), &detail);
    return surface;
}

/* Creates a surface from an OBJ text with tags. */
static inline struct gd_subdivision *surface_from(const char *text, enum gd_scheme scheme)
{
    struct gd_control_mesh mesh;
    struct gd_detail detail = {0};
    check_ok(gd_read_control_mesh(text, strlen(text),
                                  &(struct gd_read_options){.format = GD_FORMAT_OBJ}, &mesh,
                                  &detail),
             &detail);
    struct gd_subdivision *surface = surface_of(&mesh, scheme);
    gd_control_mesh_free(&mesh);
    return surface;
}

/* Creates a surface from a file. Returns NULL if the file does not exist. */
static inline struct gd_subdivision *surface_from_file(const char *path, enum gd_scheme scheme)
{
    size_t size;
    char *text = test_read_file(path, &size);
    struct gd_subdivision *surface = text ? surface_from(text, scheme) : NULL;
    free(text);
    return surface;
}

/* The cube [-1,1]^3. Face 0 is z = 1 and begins at (-1,-1). */
#define CUBE                                                                                       \
    "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"         \
    "f 5 6 8 7\nf 1 3 4 2\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"

/* A cube without symmetry. */
#define SKEW_CUBE                                                                                  \
    "v -1 -1 -1\nv 1.2 -1.1 -1\nv -1 .8 -1.4\nv 1.1 1.3 -.7\nv -1 -.6 1\nv .7 -1 1.2\nv -1.3 1 "   \
    "1\nv 1 1.4 .8\n"                                                                              \
    "f 5 6 8 7\nf 1 3 4 2\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"

#define OCTAHEDRON                                                                                 \
    "v 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"                                    \
    "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 2 1 6\nf 3 2 6\nf 4 3 6\nf 1 4 6\n"

/* Makes a bent sheet of n x n cells. If `triangles`, each cell has two triangles. The quad (i,j) is
 * face i n + j with the corners (i,j), (i+1,j), (i+1,j+1), (i,j+1). */
static inline void make_sheet(uint32_t n, bool triangles, struct gd_control_mesh *out)
{
    *out = (struct gd_control_mesh){0};
    struct gd_polygons *p = &out->polygons;
    uint32_t row = n + 1, sides = triangles ? 6 : 4;
    p->position_count = row * row;
    p->polygon_count = (triangles ? 2 : 1) * n * n;
    p->positions = malloc(p->position_count * sizeof *p->positions);
    p->corners = malloc((size_t)n * n * sides * sizeof *p->corners);
    p->first = triangles ? NULL : malloc((p->polygon_count + 1) * sizeof *p->first);
    for (uint32_t i = 0; i < row * row; i++) {
        double x = i / row, y = i % row;
        p->positions[i][0] = x + 0.1 * sin(3 * y), p->positions[i][1] = y + 0.1 * cos(2 * x),
        p->positions[i][2] = sin(x) * cos(y);
    }
    uint32_t *corner = p->corners;
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t j = 0; j < n; j++) {
            uint32_t a = i * row + j, b = a + row, quad[4] = {a, b, b + 1, a + 1},
                     two[6] = {a, b, a + 1, b, b + 1, a + 1};
            memcpy(corner, triangles ? two : quad, sides * sizeof *corner);
            corner += sides;
        }
    }
    for (uint32_t i = 0; p->first && i <= p->polygon_count; i++) p->first[i] = 4 * i;
}

static inline struct gd_limit_jet jet_at(const struct gd_subdivision *surface, uint32_t face,
                                         uint32_t corner, double u, double v)
{
    struct gd_limit_jet jet = {0};
    struct gd_detail detail = {0};
    struct gd_limit_point place = {face, corner, u, v};
    check_ok(gd_limit_evaluate(surface, &place, &jet, &detail), &detail);
    return jet;
}

static inline void check_near(struct gd_vec3 actual, double x, double y, double z, double absolute)
{
    double off = gd_vec3_distance(actual, (struct gd_vec3){x, y, z});
    if (!(off <= absolute))
        fail_msg("(%.15g,%.15g,%.15g) is off by %g", actual.x, actual.y, actual.z, off);
}
