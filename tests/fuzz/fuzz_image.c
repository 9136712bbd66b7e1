/* Fuzzes field images as they lie in the store. The input is a list of patches (three bytes of place, one of value) to the image of a real field, so
 * that most of it stays plausible. What is opened is asked everywhere; no answer may lead outside of the image. */
#include <stdlib.h>
#include <string.h>

#include "gd/field.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(int promise)
{
    if (!promise) abort();
}

/* A pyramid over a square that is open below, with saddles where its sides are pushed in; made once. */
static const struct gd_mesh *surface(void)
{
    static struct gd_mesh *mesh;
    static double positions[9][3] = {{0, 0, 1},  {1, 0, 0},       {0.3, 0.3, 0}, {0, 1, 0},     {-0.3, 0.3, 0},
                                     {-1, 0, 0}, {-0.3, -0.3, 0}, {0, -1, 0},    {0.3, -0.3, 0}};
    static uint32_t corners[] = {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 6, 0, 6, 7, 0, 7, 8, 0, 8, 1};
    struct gd_polygons polygons = {.positions = positions, .position_count = 9, .polygon_count = 8, .corners = corners};
    if (!mesh) require(gd_mesh_build(&polygons, NULL, NULL, &mesh, NULL) == GD_OK);
    return mesh;
}

static const char *image(size_t *size)
{
    static char *bytes;
    static size_t length;
    if (!bytes) {
        struct gd_seed seed = {.offset = 0.125};
        struct gd_field *field;
        require(gd_point_in_face(surface(), (struct gd_face){2}, (double[3]){0.5, 0.25, 0.25}, &seed.point, NULL) ==
                GD_OK);
        require(gd_field_build(surface(), &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL, NULL,
                               &field, NULL) == GD_OK);
        length = gd_field_image_size(field);
        bytes = malloc(length);
        require(bytes != NULL);
        gd_field_write_image(field, bytes);
        gd_field_release(field);
    }
    *size = length;
    return bytes;
}

static void ask_everywhere(const struct gd_field *field)
{
    static const double places[4][3] = {{1, 0, 0}, {0.5, 0.5, 0}, {0.2, 0.3, 0.5}, {0, 0, 1}};
    for (uint32_t face = 0; face < gd_mesh_summary(surface())->faces; face++) {
        for (int i = 0; i < 4; i++) {
            struct gd_point point;
            double distance;
            struct gd_path path;
            require(gd_point_in_face(surface(), (struct gd_face){face}, places[i], &point, NULL) == GD_OK);
            if (gd_field_distance(field, &point, &distance) == GD_OK && gd_field_path(field, &point, &path) == GD_OK)
                gd_path_free(&path);
        }
    }
    for (uint32_t a = 0; a < 9; a++) { /* every edge, in both directions: its chunks are merged */
        for (uint32_t b = 0; b < 9; b++) {
            struct gd_wedge *wedges;
            uint32_t count;
            if (gd_field_wedges(field, (struct gd_vertex){a}, (struct gd_vertex){b}, &wedges, &count) == GD_OK)
                free(wedges);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    size_t length, cut = 0;
    const char *whole = image(&length);
    char *patched = malloc(length);
    require(patched != NULL);
    memcpy(patched, whole, length);
    if (size && data[0] == 0xff) cut = data[size - 1];
    for (; size >= 4; data += 4, size -= 4) patched[(data[0] << 16 | data[1] << 8 | data[2]) % length] = (char)data[3];
    struct gd_field *field;
    struct gd_detail detail = {.text = ""};
    enum gd_status status = gd_field_open_image(surface(), patched, length - cut, NULL, NULL, &field, &detail);
    if (status == GD_OK) {
        ask_everywhere(field);
        gd_field_release(field);
    } else {
        require(detail.text[0] != '\0');
    }
    free(patched);
    return 0;
}
