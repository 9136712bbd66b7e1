#include "tests/support/field.h"

#include <stdlib.h>

#include "tests/support/test.h"

struct gd_field *test_field(const struct gd_mesh *mesh, const struct gd_seed *seeds, uint32_t count, double radius)
{
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    struct gd_field_request request = {.seeds = seeds, .seed_count = count, .radius = radius};
    check_ok(gd_field_build(mesh, &request, NULL, NULL, &field, &detail), &detail);
    return field;
}

struct gd_field *test_field_from(const struct gd_mesh *mesh, struct gd_point point)
{
    return test_field(mesh, &(struct gd_seed){.point = point}, 1, 0);
}

struct gd_field *test_field_of_curve(const struct gd_mesh *mesh, const struct gd_curve *curve, double offset)
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
