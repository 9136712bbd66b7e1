/* Common part of the fuzzers of the readers. Accepted polygons must satisfy the readers'
 * invariants. Writing them by a writer that keeps doubles, and reading the result, must give the
 * same polygons. */
#include "tests/fuzz/reader.h"
#include "tests/fuzz/promise.h"

#include <stdlib.h>
#include <string.h>

/* Checks the readers' promises. A violated promise ends the run, and the fuzzer keeps the input. */
static void check_promises(const struct gd_polygons *polygons, const struct gd_read_options *limits)
{
    uint64_t triangles = 0;
    promise(polygons->polygon_count > 0 && polygons->position_count <= limits->max_vertices);
    for (uint32_t i = 0; i < polygons->polygon_count; i++) {
        uint32_t corners = gd_polygons_first(polygons, i + 1) - gd_polygons_first(polygons, i);
        promise(corners >= 3 && corners <= gd_polygons_corner_count(polygons));
        triangles += corners - 2;
    }
    promise(triangles <= limits->max_faces);
    for (uint32_t i = 0; i < gd_polygons_corner_count(polygons); i++)
        promise(polygons->corners[i] < polygons->position_count);
    for (uint32_t i = 0; i < polygons->position_count; i++) {
        for (int axis = 0; axis < 3; axis++)
            promise(polygons->positions[i][axis] - polygons->positions[i][axis] == 0);
    }
}

static void check_equal(const struct gd_polygons *a, const struct gd_polygons *b)
{
    promise(a->position_count == b->position_count && a->polygon_count == b->polygon_count);
    promise(gd_polygons_corner_count(a) == gd_polygons_corner_count(b));
    promise(memcmp(a->positions, b->positions, a->position_count * sizeof *a->positions) == 0);
    promise(memcmp(a->corners, b->corners, gd_polygons_corner_count(a) * sizeof *a->corners) == 0);
    for (uint32_t i = 0; i < a->polygon_count; i++)
        promise(gd_polygons_first(a, i) == gd_polygons_first(b, i));
}

static void check_round_trip(const struct gd_polygons *polygons, enum gd_format format)
{
    char *bytes;
    size_t size;
    struct gd_polygons back;
    enum gd_status status = gd_write_polygons(polygons, format, &bytes, &size);
    bool is_float = format == GD_FORMAT_STL || format == GD_FORMAT_GLB || format == GD_FORMAT_GLTF;
    if (is_float && (status == GD_NOT_TRIANGLES || status == GD_EXTENT)) return;
    promise(status == GD_OK);
    promise(gd_format_recognise(bytes, size) == format);
    promise(gd_read_polygons(bytes, size, &(struct gd_read_options){.format = format}, &back,
                             NULL) == GD_OK);
    free(bytes);
    if (!is_float) check_equal(polygons, &back);
    gd_polygons_free(&back);
}

int fuzz_reader(enum gd_format format, const uint8_t *data, size_t size)
{
    const struct gd_read_options options = {
        .format = format, .max_faces = 4096, .max_vertices = 4096};
    struct gd_polygons polygons;
    struct gd_detail detail = {.text = ""};
    size_t cost = gd_read_cost(data, size, &options);
    enum gd_status status = gd_read_polygons(data, size, &options, &polygons, &detail);
    if (status != GD_OK) {
        promise(detail.text[0] != '\0' && status != GD_INTERNAL);
        return 0;
    }
    check_promises(&polygons, &options);
    promise(polygons.position_count * sizeof *polygons.positions <= cost);
    for (format = GD_FORMAT_OBJ; format <= GD_FORMAT_GLTF; format++)
        check_round_trip(&polygons, format);
    gd_polygons_free(&polygons);
    return 0;
}
