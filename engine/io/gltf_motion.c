#include "io/gltf_document.h"

#include <math.h>

#define AXIS_PART 0.05 /* length of an axis, relative to the length of the line */

/* --- keys ------------------------------------------------------------------------------------- */

static double reach_of(const struct gd_result *result)
{
    if (!result->pose_count) return 0;
    return result->poses[result->pose_count - 1].along - result->poses[0].along;
}

/* Returns the time of a pose in seconds, from 0 for the first pose to GD_RESULT_SECONDS for the
 * last one. */
static float time_of(const struct gd_result *result, uint32_t pose)
{
    double gone = result->poses[pose].along - result->poses[0].along;
    return (float)(GD_RESULT_SECONDS * (gone / reach_of(result)));
}

/* Returns the first pose after `pose` that has a later time, or pose_count if there is none. */
static uint32_t next_key(const struct gd_result *result, uint32_t pose)
{
    float time = time_of(result, pose);
    while (++pose < result->pose_count)
        if (time_of(result, pose) > time) break;
    return pose;
}

/* --- rotations -------------------------------------------------------------------------------- */

/* Computes the quaternion x, y, z, w of the rotation that takes the axes to the pose's vectors, by
 * Shepperd's method. It computes the largest component from the diagonal of the matrix, and the
 * others from the other elements, so that no digits cancel. */
static void rotation_of(const struct gd_pose *pose, double q[4])
{
    struct gd_vec3 x = gd_vec3_cross(pose->normal, pose->tangent), y = pose->normal,
                   z = pose->tangent;
    const double m[3][3] = {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}};
    double trace = m[0][0] + m[1][1] + m[2][2], squares = 0;
    int i = m[1][1] > m[0][0] ? 1 : 0;
    if (m[2][2] > m[i][i]) i = 2;
    int j = (i + 1) % 3, k = (i + 2) % 3;
    if (trace > m[i][i]) {
        q[3] = 1 + trace;
        for (int a = 0; a < 3; a++)
            q[a] = m[(a + 2) % 3][(a + 1) % 3] - m[(a + 1) % 3][(a + 2) % 3];
    } else {
        q[i] = 1 + 2 * m[i][i] - trace;
        q[j] = m[j][i] + m[i][j];
        q[k] = m[k][i] + m[i][k];
        q[3] = m[k][j] - m[j][k];
    }
    for (int a = 0; a < 4; a++) squares += q[a] * q[a];
    for (int a = 0; a < 4; a++) q[a] /= sqrt(squares);
}

/* Replaces q by -q, which is the same rotation, if -q is closer to the previous quaternion. */
static void rotation_continue(const double before[4], double q[4])
{
    double dot = 0;
    for (int a = 0; a < 4; a++) dot += before[a] * q[a];
    for (int a = 0; a < 4 && dot < 0; a++) q[a] = -q[a];
}

/* --- data ------------------------------------------------------------------------------------- */

enum { AXIS_POINTS = 6, COLOUR_BYTES = 8 }; /* the object has the two ends of each of its axes */

/* Adds the axes as lines from the origin along z (tangent, red), y (normal, blue), x (green). */
static void add_axes(struct gd__gltf_writing *writing, float length)
{
    static const uint64_t colours[3] = {UINT64_C(0xffff00000000ffff), UINT64_C(0xffffffff00000000),
                                        UINT64_C(0xffff0000ffff0000)};
    struct gd__output *binary = &writing->binary, *json = &writing->accessor_list;
    const double most = (double)length;
    size_t begin = binary->size;
    for (int line = 0; line < 3; line++) {
        for (int axis = 0; axis < 3; axis++) gd__output_f32(binary, 0);
        for (int axis = 0; axis < 3; axis++) gd__output_f32(binary, axis == 2 - line ? length : 0);
    }
    gd__gltf_accessor(writing, writing->views, 0, GD__GLTF_FLOAT, AXIS_POINTS, "");
    gd__gltf_triple(json, ",\"type\":\"VEC3\",\"min\":", (const double[]){0, 0, 0});
    gd__gltf_triple(json, ",\"max\":", (const double[]){most, most, most});
    gd__output_text(json, "}");
    gd__gltf_view(writing, begin, 0, GD__GLTF_VERTICES);
    begin = binary->size;
    for (int point = 0; point < AXIS_POINTS; point++)
        gd__output_little_endian(binary, colours[point / 2], COLOUR_BYTES);
    gd__gltf_accessor(writing, writing->views, 0, GD__GLTF_SHORT, AXIS_POINTS,
                      ",\"normalized\":true,\"type\":\"VEC4\"}");
    gd__gltf_view(writing, begin, 0, GD__GLTF_VERTICES);
}

/* Adds the times of the keys: poses whose times, as floats, ascend strictly. Returns their
 * number. */
static uint32_t add_times(struct gd__gltf_writing *writing)
{
    const struct gd_result *result = writing->result;
    size_t begin = writing->binary.size;
    uint32_t keys = 0;
    for (uint32_t pose = 0; pose < result->pose_count; pose = next_key(result, pose), keys++)
        gd__output_f32(&writing->binary, time_of(result, pose));
    gd__gltf_accessor(writing, writing->views, 0, GD__GLTF_FLOAT, keys,
                      ",\"type\":\"SCALAR\",\"min\":[0],\"max\":[");
    gd__gltf_member(&writing->accessor_list, "", GD_RESULT_SECONDS);
    gd__output_text(&writing->accessor_list, "]}");
    gd__gltf_view(writing, begin, 0, 0);
    return keys;
}

/* Adds the translations of the keys, relative to the origin. */
static void add_translations(struct gd__gltf_writing *writing, uint32_t keys)
{
    const struct gd_result *result = writing->result;
    size_t begin = writing->binary.size;
    for (uint32_t pose = 0, key = 0; pose < result->pose_count; pose++) {
        const struct gd_vec3 position = result->poses[pose].position;
        const float at[3] = {(float)(position.x - writing->origin[0]),
                             (float)(position.y - writing->origin[1]),
                             (float)(position.z - writing->origin[2])};
        writing->fits &= isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2]);
        if (pose < key) continue;
        key = next_key(result, pose);
        for (int axis = 0; axis < 3; axis++) gd__output_f32(&writing->binary, at[axis]);
    }
    gd__gltf_accessor(writing, writing->views, 0, GD__GLTF_FLOAT, keys, ",\"type\":\"VEC3\"}");
    gd__gltf_view(writing, begin, 0, 0);
}

/* Adds the rotations of the keys as unit quaternions x, y, z, w. The dot product of two consecutive
 * quaternions is at least 0, so that interpolation turns the object by the smaller angle. */
static void add_rotations(struct gd__gltf_writing *writing, uint32_t keys)
{
    const struct gd_result *result = writing->result;
    size_t begin = writing->binary.size;
    double before[4] = {0, 0, 0, 0}, q[4];
    for (uint32_t pose = 0; pose < result->pose_count; pose = next_key(result, pose)) {
        rotation_of(&result->poses[pose], q);
        rotation_continue(before, q);
        for (int a = 0; a < 4; a++) gd__output_f32(&writing->binary, (float)q[a]);
        for (int a = 0; a < 4; a++) before[a] = q[a];
    }
    gd__gltf_accessor(writing, writing->views, 0, GD__GLTF_FLOAT, keys, ",\"type\":\"VEC4\"}");
    gd__gltf_view(writing, begin, 0, 0);
}

/* --- the object ------------------------------------------------------------------------------- */

static void describe_sampler(struct gd__output *json, uint32_t input, uint32_t output)
{
    gd__gltf_member(json, "{\"interpolation\":\"LINEAR\",\"input\":", input);
    gd__gltf_member(json, ",\"output\":", output);
    gd__output_text(json, "}");
}

/* Describes the object and its animation. `first` is its first accessor. */
static void describe_object(struct gd__gltf_writing *writing, uint32_t first)
{
    struct gd__output *meshes = &writing->mesh_list, *json = &writing->animations;
    gd__output_text(&writing->node_list, ",{\"name\":\"object\",\"mesh\":1}");
    gd__output_text(&writing->material_list,
                    ",{\"name\":\"axes\",\"pbrMetallicRoughness\":{\"metallicFactor\":0}}");
    gd__gltf_member(meshes, ",{\"primitives\":[{\"attributes\":{\"POSITION\":", first);
    gd__gltf_member(meshes, ",\"COLOR_0\":", first + UINT64_C(1));
    gd__output_text(meshes, "},\"mode\":1,\"material\":2}]}");
    gd__output_text(
        json, ",\"animations\":[{\"name\":\"motion\",\"channels\":["
              "{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"translation\"}},"
              "{\"sampler\":1,\"target\":{\"node\":1,\"path\":\"rotation\"}}],\"samplers\":[");
    describe_sampler(json, first + 2, first + 3);
    gd__output_text(json, ",");
    describe_sampler(json, first + 2, first + 4);
    gd__output_text(json, "]}]");
    writing->nodes++;
    writing->materials++;
}

void gd__gltf_motion(struct gd__gltf_writing *writing)
{
    float length = (float)(AXIS_PART * reach_of(writing->result));
    if (!(reach_of(writing->result) > 0)) return;
    writing->fits &= isfinite(length);
    if (!writing->fits) return;
    describe_object(writing, writing->accessors);
    add_axes(writing, length);
    uint32_t keys = add_times(writing);
    add_translations(writing, keys);
    add_rotations(writing, keys);
}
