#include "render/normals.h"

#define CREASE 0.77F /* cosine of 40 degrees: sharper edges between faces stay visible */
enum {
    MOST = 64, /* limit on faces around a vertex for smooth normals */
    CHECK_INTERVAL = 1 << 12
};

static struct gd__normal normals_normal_of(const struct gd_mesh *mesh, uint32_t face)
{
    const uint32_t *side = mesh->face_side[face];
    const struct gd_vec3 *position = mesh->position;
    struct gd_vec3 a = position[mesh->origin[side[0]]], b = position[mesh->origin[side[1]]],
                   c = position[mesh->origin[side[2]]];
    struct gd_vec3 n = gd_vec3_cross(gd_vec3_sub(b, a), gd_vec3_sub(c, a));
    n = gd_vec3_scale(n, 1 / gd_vec3_length(n));
    return (struct gd__normal){(float)n.x, (float)n.y, (float)n.z};
}

static float dot(struct gd__normal a, struct gd__normal b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static void normals_add(struct gd__normal *sum, float weight, struct gd__normal n)
{
    sum->x += weight * n.x;
    sum->y += weight * n.y;
    sum->z += weight * n.z;
}

static struct gd__normal *corner_at(const struct gd_mesh *mesh, struct gd__normal (*corners)[3],
                                    uint32_t side)
{
    uint32_t face = mesh->side_face[side];
    const uint32_t *sides = mesh->face_side[face];
    return &corners[face][sides[0] == side ? 0 : sides[1] == side ? 1 : 2];
}

/* Computes the normals of all corners at a vertex, with faces weighted by angle (G. Thuermer and C.
 * Wuethrich, "Computing vertex normals from polygonal facets", 1998). */
static void make_around(const struct gd_mesh *mesh, uint32_t vertex, const struct gd__normal *flat,
                        struct gd__normal (*corners)[3])
{
    const struct gd_fan *fan = mesh->fan + mesh->fan_first[vertex];
    uint32_t count = mesh->fan_first[vertex + 1] - mesh->fan_first[vertex];
    for (uint32_t i = 0; i < count; i++) {
        struct gd__normal own = flat[mesh->side_face[fan[i].side]], sum = {0};
        for (uint32_t k = 0; k < count && count <= MOST; k++) {
            double angle =
                (k + 1 < count ? fan[k + 1].angle : mesh->total_angle[vertex]) - fan[k].angle;
            struct gd__normal other = flat[mesh->side_face[fan[k].side]];
            if (dot(own, other) > CREASE) normals_add(&sum, (float)angle, other);
        }
        *corner_at(mesh, corners, fan[i].side) = dot(sum, own) > 0 ? sum : own;
    }
}

enum gd_status gd__normals_make(const struct gd_mesh *mesh, const struct gd_control *control,
                                struct gd__normal *flat, struct gd__normal (*corners)[3])
{
    enum gd_status status = GD_OK;
    for (uint32_t f = 0; f < mesh->face_count && !status; f++) {
        flat[f] = normals_normal_of(mesh, f);
        if (f % CHECK_INTERVAL == 0) status = gd_control_check(control, 0);
    }
    for (uint32_t v = 0; v < mesh->vertex_count && !status; v++) {
        make_around(mesh, v, flat, corners);
        if (v % CHECK_INTERVAL == 0) status = gd_control_check(control, 0);
    }
    return status;
}
