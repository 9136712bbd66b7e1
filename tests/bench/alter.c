#include "tests/bench/alter.h"

#include <stdlib.h>

#include "gd/vec.h"
#include "tests/samples/random.h"
#include "tests/samples/transform.h"

enum gd_status alter_subdivide(struct gd_polygons *mesh, uint32_t levels)
{
    enum gd_status status = GD_OK;
    for (; levels && status == GD_OK; levels--)
        status = mesh->polygon_count > 1u << 26 ? GD_TOO_LARGE : sample_subdivide(mesh);
    return status;
}

static struct gd_vec3 position(const struct gd_polygons *mesh, uint32_t slot)
{
    const double *p = mesh->positions[mesh->corners[slot]];
    return (struct gd_vec3){p[0], p[1], p[2]};
}

/* For every vertex, adds up the normals of its faces. The length of a face's normal is twice the
 * face's area. The caller must set all vertex normals to zero beforehand. Returns the mean edge
 * length of the faces. */
static double add_normals(const struct gd_polygons *mesh, struct gd_vec3 *normals)
{
    double length = 0;
    for (uint32_t slot = 0; slot < 3 * mesh->polygon_count; slot += 3) {
        struct gd_vec3 a = position(mesh, slot), b = position(mesh, slot + 1),
                       c = position(mesh, slot + 2);
        struct gd_vec3 normal = gd_vec3_cross(gd_vec3_sub(b, a), gd_vec3_sub(c, a));
        length += gd_vec3_distance(a, b) + gd_vec3_distance(b, c) + gd_vec3_distance(c, a);
        for (uint32_t k = 0; k < 3; k++) {
            struct gd_vec3 *sum = &normals[mesh->corners[slot + k]];
            *sum = gd_vec3_add(*sum, normal);
        }
    }
    return length / (3.0 * mesh->polygon_count);
}

enum gd_status alter_roughen(struct gd_polygons *mesh, double amplitude)
{
    struct gd_vec3 *normals = calloc((size_t)mesh->position_count + 1, sizeof *normals);
    if (!normals) return GD_NO_MEMORY;
    double reach = amplitude * add_normals(mesh, normals);
    struct rng rng = {1};
    for (uint32_t i = 0; i < mesh->position_count; i++) {
        double length = gd_vec3_length(normals[i]), way = rng_between(&rng, -reach, reach);
        if (!(length > 0)) continue;
        mesh->positions[i][0] += way * normals[i].x / length;
        mesh->positions[i][1] += way * normals[i].y / length;
        mesh->positions[i][2] += way * normals[i].z / length;
    }
    free(normals);
    return GD_OK;
}
