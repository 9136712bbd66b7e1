/* Fuzzes field images in the form of the store. An opened field is queried everywhere; no query may
 * read outside of the image. */
#include <math.h>
#include <stdlib.h>

#include "gd/field.h"
#include "tests/fuzz/patched.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char *image(size_t *size)
{
    static char *bytes;
    static size_t length;
    if (!bytes) {
        struct gd_seed seed = {.offset = 0.125};
        struct gd_field *field;
        promise(gd_point_in_face(patched_surface(), (struct gd_face){2},
                                 (double[3]){0.5, 0.25, 0.25}, &seed.point, NULL) == GD_OK);
        promise(gd_field_build(patched_surface(),
                               &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL,
                               &field, NULL) == GD_OK);
        length = gd_field_image_size(field);
        bytes = malloc(length);
        promise(bytes != NULL);
        gd_field_write_image(field, bytes);
        gd_field_release(field);
    }
    *size = length;
    return bytes;
}

static void ask_everywhere(const struct gd_field *field)
{
    static const double places[4][3] = {{1, 0, 0}, {0.5, 0.5, 0}, {0.2, 0.3, 0.5}, {0, 0, 1}};
    for (uint32_t face = 0; face < gd_mesh_summary(patched_surface())->faces; face++) {
        for (int i = 0; i < 4; i++) {
            struct gd_point point;
            double distance;
            struct gd_path path;
            struct gd_vec3 gradient;
            uint32_t seed;
            promise(gd_point_in_face(patched_surface(), (struct gd_face){face}, places[i], &point,
                                     NULL) == GD_OK);
            if (gd_field_distance(field, &point, &distance) == GD_OK &&
                gd_field_path(field, &point, &path) == GD_OK)
                gd_path_free(&path);
            if (gd_field_nearest(field, &point, &distance, &seed) == GD_OK && isfinite(distance))
                promise(seed < gd_field_seed_count(field));
            if (gd_field_gradient(field, &point, &gradient) == GD_OK) promise(!isinf(gradient.x));
        }
    }
    /* queries every edge in both directions, which merges the edge's chunks of wedges */
    for (uint32_t a = 0; a < 9; a++) {
        for (uint32_t b = 0; b < 9; b++) {
            struct gd_wedge *wedges;
            uint32_t count;
            if (gd_field_wedges(field, (struct gd_vertex){a}, (struct gd_vertex){b}, &wedges,
                                &count) == GD_OK)
                free(wedges);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    size_t length, left;
    const char *whole = image(&length);
    char *patched = patched_copy(whole, length, data, size, &left);
    struct gd_field *field;
    struct gd_detail detail = {.text = ""};
    enum gd_status status = gd_field_open_image(
        patched_surface(), &(struct gd_field_image){patched, left, NULL, NULL}, &field, &detail);
    if (status == GD_OK) {
        ask_everywhere(field);
        gd_field_release(field);
    } else {
        promise(detail.text[0] != '\0');
    }
    free(patched);
    return 0;
}
