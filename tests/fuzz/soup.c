#include "tests/fuzz/soup.h"

#include <math.h>

#include "tests/fuzz/promise.h"

enum { LEAST_VERTICES = 3, COUNTS = SOUP_VERTICES - LEAST_VERTICES + 1 };

uint8_t soup_next(const uint8_t **data, size_t *size)
{
    if (*size == 0) return 0;
    --*size;
    return *(*data)++;
}

void soup_read(const uint8_t *data, size_t size, struct soup *soup)
{
    uint8_t first = soup_next(&data, &size), mend = first / COUNTS;
    soup->vertices = LEAST_VERTICES + first % COUNTS;
    double scale = ldexp(1, (int)(int8_t)soup_next(&data, &size)),
           squeeze = ldexp(1, -(soup_next(&data, &size) % 24));
    soup->scale = scale;
    soup->options = (struct gd_mesh_options){
        .repair_split = mend & 1, .weld = mend & 2, .weld_tolerance = mend & 4 ? 0.125 * scale : 0};
    for (uint32_t v = 0; v < soup->vertices; v++)
        for (int k = 0; k < 3; k++)
            soup->positions[v][k] =
                (int8_t)soup_next(&data, &size) * 0.125 * scale * (k == 2 ? squeeze : 1);
    soup->faces = soup->first[0] = 0;
    while (size >= 3 && soup->faces < SOUP_FACES) {
        uint8_t kind = soup_next(&data, &size);
        uint32_t corners = kind % 8 == 0 ? 4 : 3, at = soup->first[soup->faces];
        for (uint32_t k = 0; k < corners; k++)
            soup->corners[at + k] = soup_next(&data, &size) % soup->vertices;
        soup->first[++soup->faces] = at + corners;
    }
}

struct gd_mesh *soup_build(struct soup *soup)
{
    const struct gd_polygons polygons = {.positions = soup->positions,
                                         .position_count = soup->vertices,
                                         .polygon_count = soup->faces,
                                         .corners = soup->corners,
                                         .first = soup->first};
    struct gd_detail detail = {.text = ""};
    struct gd_mesh *mesh;
    enum gd_status status = gd_mesh_build(&polygons, &soup->options, NULL, &mesh, &detail);
    if (!status) return mesh;
    promise(detail.text[0] != '\0' && status != GD_INTERNAL);
    return NULL;
}
