#include "io/gltf_motion.h"

#include <math.h>
#include <stdbool.h>

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

uint32_t gd__motion_count(const struct gd_result *result)
{
    uint32_t count = 0;
    if (!(reach_of(result) > 0)) return 0;
    for (uint32_t pose = 0; pose < result->pose_count; pose = next_key(result, pose)) count++;
    return count;
}

float gd__motion_axis(const struct gd_result *result)
{
    return (float)(AXIS_PART * reach_of(result));
}

static void relative(const struct gd_pose *pose, const double origin[3], float out[3])
{
    out[0] = (float)(pose->position.x - origin[0]);
    out[1] = (float)(pose->position.y - origin[1]);
    out[2] = (float)(pose->position.z - origin[2]);
}

bool gd__motion_fits(const struct gd_result *result, const double origin[3])
{
    for (uint32_t pose = 0; pose < result->pose_count; pose++) {
        float at[3];
        relative(&result->poses[pose], origin, at);
        if (!isfinite(at[0]) || !isfinite(at[1]) || !isfinite(at[2])) return false;
    }
    return isfinite(gd__motion_axis(result));
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

/* Writes the axes as lines from the origin along z (tangent, red), y (normal, blue), x (green). */
static void write_axes(struct gd__output *output, float length)
{
    static const uint64_t colours[3] = {UINT64_C(0xffff00000000ffff), UINT64_C(0xffffffff00000000),
                                        UINT64_C(0xffff0000ffff0000)};
    for (int line = 0; line < 3; line++) {
        for (int axis = 0; axis < 3; axis++) gd__output_f32(output, 0);
        for (int axis = 0; axis < 3; axis++) gd__output_f32(output, axis == 2 - line ? length : 0);
    }
    for (int point = 0; point < GD__AXIS_POINTS; point++)
        gd__output_little_endian(output, colours[point / 2], GD__COLOUR_BYTES);
}

void gd__motion_write(struct gd__output *output, const struct gd_result *result,
                      const double origin[3])
{
    uint32_t count = result->pose_count;
    double before[4] = {0, 0, 0, 0}, q[4];
    float at[3];
    write_axes(output, gd__motion_axis(result));
    for (uint32_t pose = 0; pose < count; pose = next_key(result, pose))
        gd__output_f32(output, time_of(result, pose));
    for (uint32_t pose = 0; pose < count; pose = next_key(result, pose)) {
        relative(&result->poses[pose], origin, at);
        for (int axis = 0; axis < 3; axis++) gd__output_f32(output, at[axis]);
    }
    for (uint32_t pose = 0; pose < count; pose = next_key(result, pose)) {
        rotation_of(&result->poses[pose], q);
        rotation_continue(before, q);
        for (int a = 0; a < 4; a++) gd__output_f32(output, (float)q[a]);
        for (int a = 0; a < 4; a++) before[a] = q[a];
    }
}
