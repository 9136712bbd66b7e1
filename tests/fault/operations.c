#include "tests/fault/operations.h"

#include <stdlib.h>

#include "gd/curve.h"
#include "tests/support/test.h"

void digest_bytes(struct digest *digest, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    for (size_t i = 0; i < size; i++) digest->value = (digest->value ^ at[i]) * 0x100000001b3u;
}

void digest_number(struct digest *digest, double number)
{
    digest_bytes(digest, &number, sizeof number);
}

static void digest_points(struct digest *digest, const struct gd_point *points, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        int weights = points[i].kind == GD_POINT_FACE ? 3 : points[i].kind == GD_POINT_EDGE;
        digest_number(digest, points[i].kind);
        digest_number(digest, points[i].element);
        digest_bytes(digest, points[i].weight, (size_t)weights * sizeof(double));
    }
}

void digest_path(struct digest *digest, const struct gd_path *path)
{
    digest_number(digest, path->length);
    digest_points(digest, path->points, path->count);
}

void digest_curve(struct digest *digest, const struct gd_curve *curve)
{
    digest_number(digest, curve->closed);
    digest_points(digest, curve->points, curve->count);
}

void digest_mesh(struct digest *digest, const struct gd_mesh *mesh)
{
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    digest_number(digest, summary->area);
    for (uint32_t i = 0; i < summary->index_count; i++) {
        struct gd_vec3 position = gd_mesh_position(mesh, (struct gd_vertex){i});
        digest_bytes(digest, &position, sizeof position);
    }
    for (uint32_t i = 0; i < summary->face_index_count; i++) {
        struct gd_vertex corners[3] = {{GD_NONE}, {GD_NONE}, {GD_NONE}};
        if (gd_mesh_has_face(mesh, (struct gd_face){i}))
            gd_mesh_corners(mesh, (struct gd_face){i}, corners);
        digest_bytes(digest, corners, sizeof corners);
    }
}
