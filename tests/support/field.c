#include "tests/support/field.h"

#include <math.h>
#include <stdlib.h>

#include "gd/vec.h"
#include "tests/support/test.h"

struct gd_field *test_field(const struct gd_mesh *mesh, const struct gd_seed *seeds, uint32_t count,
                            double radius)
{
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    struct gd_field_request request = {.seeds = seeds, .seed_count = count, .radius = radius};
    check_ok(gd_field_build(mesh, &request, NULL, &field, &detail), &detail);
    return field;
}

struct gd_field *test_field_from(const struct gd_mesh *mesh, struct gd_point point)
{
    return test_field(mesh, &(struct gd_seed){.point = point}, 1, 0);
}

struct gd_field *test_field_of_curve(const struct gd_mesh *mesh, const struct gd_curve *curve,
                                     double offset)
{
    uint32_t count = gd_curve_seed_count(curve);
    struct gd_seed *seeds = malloc(count * sizeof *seeds);
    assert_non_null(seeds);
    gd_curve_seeds(curve, offset, seeds);
    struct gd_field *field = test_field(mesh, seeds, count, 0);
    free(seeds);
    return field;
}

double test_distance(const struct gd_field *field, const struct gd_point *point)
{
    double distance = 0;
    check_ok(gd_field_distance(field, point, &distance), NULL);
    return distance;
}

double test_distance_to_segment(struct gd_vec3 p, struct gd_vec3 a, struct gd_vec3 b)
{
    struct gd_vec3 from = gd_vec3_sub(p, a), span = gd_vec3_sub(b, a);
    double part = gd_vec3_dot(from, span) / gd_vec3_dot(span, span);
    return gd_vec3_length(gd_vec3_along(from, -fmin(fmax(part, 0), 1), span));
}
