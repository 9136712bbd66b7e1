/* Reads back the animation of a written GLB, without the engine's reader. The times, translations
 * and rotations are at the end of the file. */
#include "gd/result_file.h"

#include <math.h>

#include "tests/samples/samples.h"
#include "tests/unit/io/reading.h"

#define TURN 6.283185307179586

enum { POSES = 65 };

static const struct gd_vec3 zero = {0, 0, 0};
static double line_points[2][3] = {{-1, -1, -1}, {1, 1, 1}};
static const uint32_t first[2] = {0, 2};

struct motion {
    char *bytes;
    size_t size;
    uint32_t count;
    const float *times, *translations, *rotations; /* count * 1, 3 and 4 numbers */
    float *numbers;
    double origin[3];
};

/* Reads `count` keys from the end of the file. */
static struct motion motion_read(const struct gd_result *result, uint32_t count)
{
    struct motion motion = {.count = count};
    assert_int_equal(gd_write_result(result, GD_RESULT_GLB, &motion.bytes, &motion.size), GD_OK);
    assert_true(motion.size <= gd_result_cost(result));
    size_t bytes = count * 8 * sizeof(float);
    assert_true(motion.size > bytes);
    motion.numbers = malloc(bytes);
    assert_non_null(motion.numbers);
    memcpy(motion.numbers, motion.bytes + motion.size - bytes, bytes);
    motion.times = motion.numbers;
    motion.translations = motion.numbers + count;
    motion.rotations = motion.numbers + 4 * (size_t)count;
    const char *origin = memmem(motion.bytes, motion.size, "\"translation\":[", 15);
    assert_non_null(origin);
    assert_int_equal(sscanf(origin, "\"translation\":[%lf,%lf,%lf]", &motion.origin[0],
                            &motion.origin[1], &motion.origin[2]),
                     3);
    return motion;
}

static void motion_free(struct motion *motion)
{
    free(motion->bytes);
    free(motion->numbers);
}

static bool has_text(const struct motion *motion, const char *text)
{
    return memmem(motion->bytes, motion->size, text, strlen(text)) != NULL;
}

static struct gd_vec3 rotate(const float q[4], struct gd_vec3 v)
{
    struct gd_vec3 axis = {(double)q[0], (double)q[1], (double)q[2]};
    struct gd_vec3 twice = gd_vec3_scale(gd_vec3_cross(axis, v), 2);
    return gd_vec3_add(gd_vec3_along(v, (double)q[3], twice), gd_vec3_cross(axis, twice));
}

static void expect_vector(struct gd_vec3 a, struct gd_vec3 b, double error)
{
    assert_true(gd_vec3_distance(a, b) <= error);
}

static void check_key(const struct motion *motion, uint32_t key, const struct gd_pose *pose,
                      double error)
{
    const float *q = motion->rotations + 4 * (size_t)key, *at = motion->translations + 3 * key;
    double norm = 0;
    struct gd_vec3 place = {motion->origin[0] + (double)at[0], motion->origin[1] + (double)at[1],
                            motion->origin[2] + (double)at[2]};
    for (int i = 0; i < 4; i++) norm += (double)q[i] * (double)q[i];
    assert_true(fabs(norm - 1) < 1e-6);
    expect_vector(place, pose->position, error);
    expect_vector(rotate(q, (struct gd_vec3){0, 0, 1}), pose->tangent, 1e-6);
    expect_vector(rotate(q, (struct gd_vec3){0, 1, 0}), pose->normal, 1e-6);
    expect_vector(rotate(q, (struct gd_vec3){1, 0, 0}), gd_vec3_cross(pose->normal, pose->tangent),
                  1e-6);
}

static double quaternion_dot(const float *a, const float *b)
{
    double dot = 0;
    for (int i = 0; i < 4; i++) dot += (double)a[i] * (double)b[i];
    return dot;
}

/* Sets the poses of an object that goes once around a tilted circle of the unit sphere. The normals
 * point outwards. */
static void circle_around(struct gd_vec3 centre, struct gd_pose poses[POSES])
{
    const struct gd_vec3 a = {0.6, 0, 0.8}, b = {-0.48, 0.8, 0.36};
    for (uint32_t i = 0; i < POSES; i++) {
        double angle = TURN * i / (POSES - 1);
        struct gd_vec3 out = gd_vec3_along(gd_vec3_scale(a, cos(angle)), sin(angle), b);
        poses[i] = (struct gd_pose){
            .along = angle,
            .position = gd_vec3_add(centre, out),
            .normal = out,
            .tangent = gd_vec3_along(gd_vec3_scale(a, -sin(angle)), cos(angle), b)};
    }
}

static struct gd_result result_of(const struct gd_pose *poses, uint32_t count)
{
    return (struct gd_result){.points = (const double(*)[3])line_points,
                              .first = first,
                              .line_count = 1,
                              .poses = poses,
                              .pose_count = count};
}

static void turns_evenly_along_a_circle(void **state)
{
    (void)state;
    struct gd_pose poses[POSES];
    circle_around(zero, poses);
    struct gd_result result = result_of(poses, POSES);
    struct motion motion = motion_read(&result, POSES);
    for (uint32_t i = 0; i < POSES; i++) {
        const float *q = motion.rotations + 4 * (size_t)i;
        check_key(&motion, i, &poses[i], 1e-6);
        assert_true(fabs((double)motion.times[i] - 10.0 * i / (POSES - 1)) < 1e-6);
        if (!i) continue;
        double half = 0;
        for (int k = 0; k < 4; k++) half += pow((double)(q[k] - q[k - 4]), 2);
        assert_true(quaternion_dot(q, q - 4) >= 0);
        assert_true(fabs(4 * asin(sqrt(half) / 2) - TURN / (POSES - 1)) < 1e-5);
    }
    assert_true(has_text(&motion, "\"path\":\"rotation\""));
    assert_true(has_text(&motion, "\"count\":65,\"type\":\"SCALAR\",\"min\":[0],\"max\":[10]"));
    motion_free(&motion);
}

/* Uses each quarter turn about each axis. So each of the four components is the largest component
 * of some quaternion. */
static void writes_any_rotation(void **state)
{
    (void)state;
    static const struct gd_vec3 axes[6] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                                           {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    struct gd_pose poses[24];
    uint32_t count = 0;
    for (int t = 0; t < 6; t++)
        for (int n = 0; n < 6; n++) {
            if (t % 3 == n % 3) continue;
            poses[count] = (struct gd_pose){
                .along = count, .position = zero, .tangent = axes[t], .normal = axes[n]};
            count++;
        }
    struct gd_result result = result_of(poses, count);
    struct motion motion = motion_read(&result, count);
    for (uint32_t i = 0; i < count; i++) {
        check_key(&motion, i, &poses[i], 1e-6);
        const float *q = motion.rotations + 4 * (size_t)i;
        assert_true(!i || quaternion_dot(q, q - 4) >= 0);
    }
    motion_free(&motion);
}

static void leaves_out_equal_times(void **state)
{
    (void)state;
    static const double along[6] = {0, 0, 1, 1 + 1e-12, 3, 3};
    static const int kept[3] = {0, 2, 4};
    struct gd_pose circle[POSES], poses[6];
    circle_around(zero, circle);
    for (int i = 0; i < 6; i++) {
        poses[i] = circle[5 * i];
        poses[i].along = along[i] + 7;
    }
    struct gd_result result = result_of(poses, 6);
    struct motion motion = motion_read(&result, 3);
    for (uint32_t i = 0; i < 3; i++) {
        check_key(&motion, i, &poses[kept[i]], 1e-6);
        assert_true(fabs((double)motion.times[i] - 10 * along[kept[i]] / 3) < 1e-6);
    }
    assert_true(motion.times[2] == 10);
    assert_true(has_text(&motion, "\"count\":3,\"type\":\"VEC4\""));
    motion_free(&motion);
}

/* If the line has no length, or there are no poses, the file equals the file of the line alone. */
static void needs_a_length(void **state)
{
    (void)state;
    struct gd_pose poses[3] = {{.tangent = {1, 0, 0}, .normal = {0, 1, 0}}};
    poses[1] = poses[2] = poses[0];
    struct gd_result result = result_of(NULL, 0), still = result_of(poses, 3),
                     single = result_of(poses, 1);
    struct motion plain = motion_read(&result, 0);
    assert_false(has_text(&plain, "animations"));
    const struct gd_result *others[2] = {&still, &single};
    for (int i = 0; i < 2; i++) {
        struct motion other = motion_read(others[i], 0);
        assert_int_equal(other.size, plain.size);
        assert_memory_equal(other.bytes, plain.bytes, plain.size);
        motion_free(&other);
    }
    motion_free(&plain);
}

/* Far from the coordinates' origin, translations are relative to the origin of the lines. */
static void keeps_far_places(void **state)
{
    (void)state;
    const struct gd_vec3 centre = {1e6 + 0.1, -2e6, 3e6};
    struct gd_pose poses[POSES];
    double places[POSES][3];
    const uint32_t whole[2] = {0, POSES};
    circle_around(centre, poses);
    for (uint32_t i = 0; i < POSES; i++) {
        places[i][0] = poses[i].position.x;
        places[i][1] = poses[i].position.y;
        places[i][2] = poses[i].position.z;
    }
    const struct gd_result result = {.points = (const double(*)[3])places,
                                     .first = whole,
                                     .line_count = 1,
                                     .poses = poses,
                                     .pose_count = POSES};
    struct motion motion = motion_read(&result, POSES);
    for (uint32_t i = 0; i < POSES; i++) check_key(&motion, i, &poses[i], 1e-6);
    motion_free(&motion);
}

/* The object has no triangles, so a reader of meshes gets the same mesh. */
static void adds_nothing_to_the_mesh(void **state)
{
    (void)state;
    struct gd_pose poses[POSES];
    struct gd_polygons sphere, back;
    circle_around(zero, poses);
    assert_int_equal(sample_icosphere(2, 1, &sphere), GD_OK);
    struct gd_result result = result_of(poses, POSES);
    result.mesh = &sphere;
    struct motion motion = motion_read(&result, POSES);
    check_key(&motion, 5, &poses[5], 1e-6);
    assert_int_equal(read_copy(motion.bytes, motion.size, GD_FORMAT_GLB, NULL, &back, NULL), GD_OK);
    assert_int_equal(back.position_count, sphere.position_count);
    assert_int_equal(back.polygon_count, sphere.polygon_count);
    gd_polygons_free(&back);
    gd_polygons_free(&sphere);
    motion_free(&motion);
}

static void refuses_places_beyond_floats(void **state)
{
    (void)state;
    struct gd_pose poses[POSES];
    char *bytes = NULL;
    size_t size;
    circle_around((struct gd_vec3){1e300, 0, 0}, poses);
    struct gd_result result = result_of(poses, POSES);
    assert_int_equal(gd_write_result(&result, GD_RESULT_GLB, &bytes, &size), GD_EXTENT);
    assert_null(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(turns_evenly_along_a_circle),
        cmocka_unit_test(writes_any_rotation),
        cmocka_unit_test(leaves_out_equal_times),
        cmocka_unit_test(needs_a_length),
        cmocka_unit_test(keeps_far_places),
        cmocka_unit_test(adds_nothing_to_the_mesh),
        cmocka_unit_test(refuses_places_beyond_floats),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
