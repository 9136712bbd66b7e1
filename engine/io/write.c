#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "gd/io.h"
#include "gd/vec.h"
#include "io/writers.h"

#define PLY_HEADER_MOST 512 /* upper bound of the bytes of the header */

static uint32_t largest_polygon(const struct gd_polygons *polygons)
{
    uint32_t largest = 0;
    for (uint32_t i = 0; i < polygons->polygon_count; i++) {
        uint32_t size = gd_polygons_size(polygons, i);
        if (size > largest) largest = size;
    }
    return largest;
}

void gd__write_xyz(struct gd__output *output, const double position[3], const char *separator)
{
    for (int axis = 0; axis < 3; axis++) {
        if (axis > 0) gd__output_text(output, separator);
        gd__output_double(output, position[axis]);
    }
}

/* Writes the vertices of a polygon. `base` is the number of the first vertex. */
static void write_corners(struct gd__output *output, const struct gd_polygons *polygons,
                          uint32_t polygon, uint32_t base, const char *separator)
{
    uint32_t first = gd_polygons_first(polygons, polygon),
             end = gd_polygons_first(polygons, polygon + 1);
    for (uint32_t corner = first; corner < end; corner++) {
        if (corner > first) gd__output_text(output, separator);
        gd__output_integer(output, (uint64_t)polygons->corners[corner] + base);
    }
}

void gd__write_obj(struct gd__output *output, const struct gd_polygons *polygons)
{
    for (uint32_t i = 0; i < polygons->position_count && !output->failed; i++) {
        gd__output_text(output, "v ");
        gd__write_xyz(output, polygons->positions[i], " ");
        gd__output_text(output, "\n");
    }
    for (uint32_t i = 0; i < polygons->polygon_count && !output->failed; i++) {
        gd__output_text(output, "f ");
        write_corners(output, polygons, i, 1, " ");
        gd__output_text(output, "\n");
    }
}

static enum gd_status write_obj(struct gd__output *output, const struct gd_polygons *polygons)
{
    gd__write_obj(output, polygons);
    return GD_OK;
}

static enum gd_status write_off(struct gd__output *output, const struct gd_polygons *polygons)
{
    gd__output_text(output, "OFF\n");
    gd__output_integer(output, polygons->position_count);
    gd__output_text(output, " ");
    gd__output_integer(output, polygons->polygon_count);
    gd__output_text(output, " 0\n");
    for (uint32_t i = 0; i < polygons->position_count && !output->failed; i++) {
        gd__write_xyz(output, polygons->positions[i], " ");
        gd__output_text(output, "\n");
    }
    for (uint32_t i = 0; i < polygons->polygon_count && !output->failed; i++) {
        gd__output_integer(output, gd_polygons_size(polygons, i));
        gd__output_text(output, " ");
        write_corners(output, polygons, i, 0, " ");
        gd__output_text(output, "\n");
    }
    return GD_OK;
}

static enum gd_status write_json(struct gd__output *output, const struct gd_polygons *polygons)
{
    gd__output_text(output, "{\"vertices\":[");
    for (uint32_t i = 0; i < polygons->position_count && !output->failed; i++) {
        gd__output_text(output, i > 0 ? ",[" : "[");
        gd__write_xyz(output, polygons->positions[i], ",");
        gd__output_text(output, "]");
    }
    gd__output_text(output, "],\"faces\":[");
    for (uint32_t i = 0; i < polygons->polygon_count && !output->failed; i++) {
        gd__output_text(output, i > 0 ? ",[" : "[");
        write_corners(output, polygons, i, 0, ",");
        gd__output_text(output, "]");
    }
    gd__output_text(output, "]}\n");
    return GD_OK;
}

static void write_ply_header(struct gd__output *output, const struct gd_polygons *polygons,
                             bool has_distances, bool long_lists)
{
    gd__output_text(output, "ply\nformat binary_little_endian 1.0\nelement vertex ");
    gd__output_integer(output, polygons->position_count);
    gd__output_text(output, "\nproperty double x\nproperty double y\nproperty double z\n");
    gd__output_text(output,
                    has_distances ? "property double distance\nelement face " : "element face ");
    gd__output_integer(output, polygons->polygon_count);
    gd__output_text(output, long_lists ? "\nproperty list uint uint vertex_indices\nend_header\n"
                                       : "\nproperty list uchar uint vertex_indices\nend_header\n");
}

void gd__write_ply(struct gd__output *output, const struct gd_polygons *polygons,
                   const double *distances)
{
    bool long_lists = largest_polygon(polygons) > UINT8_MAX;
    gd__output_expect(output, PLY_HEADER_MOST +
                                  polygons->position_count * (size_t)(distances ? 32 : 24) +
                                  polygons->polygon_count * (size_t)(long_lists ? 4 : 1) +
                                  gd_polygons_corner_count(polygons) * sizeof(uint32_t));
    write_ply_header(output, polygons, distances != NULL, long_lists);
    for (uint32_t i = 0; i < polygons->position_count && !output->failed; i++) {
        for (int axis = 0; axis < 3; axis++) gd__output_f64(output, polygons->positions[i][axis]);
        if (distances) gd__output_f64(output, isfinite(distances[i]) ? distances[i] : NAN);
    }
    for (uint32_t i = 0; i < polygons->polygon_count && !output->failed; i++) {
        gd__output_little_endian(output, gd_polygons_size(polygons, i), long_lists ? 4 : 1);
        for (uint32_t corner = gd_polygons_first(polygons, i);
             corner < gd_polygons_first(polygons, i + 1); corner++) {
            gd__output_little_endian(output, polygons->corners[corner], 4);
        }
    }
}

static enum gd_status write_ply(struct gd__output *output, const struct gd_polygons *polygons)
{
    gd__write_ply(output, polygons, NULL);
    return GD_OK;
}

static struct gd_vec3 corner_position(const struct gd_polygons *polygons, uint32_t corner)
{
    const double *position = polygons->positions[polygons->corners[corner]];
    return (struct gd_vec3){position[0], position[1], position[2]};
}

/* Returns the unit normal of a triangle; zero if it has none. */
static struct gd_vec3 normal_of(struct gd_vec3 a, struct gd_vec3 b, struct gd_vec3 c)
{
    struct gd_vec3 normal = gd_vec3_cross(gd_vec3_sub(b, a), gd_vec3_sub(c, a));
    double length = gd_vec3_length(normal);
    return gd_vec3_scale(normal, length > 0 ? 1 / length : 0);
}

static void write_stl_vector(struct gd__output *output, struct gd_vec3 v)
{
    gd__output_f32(output, (float)v.x);
    gd__output_f32(output, (float)v.y);
    gd__output_f32(output, (float)v.z);
}

/* Returns false if a coordinate of a corner is no finite float, or if the largest one is not 0 but
 * too small for a normal float. */
static bool has_float_range(const struct gd_polygons *polygons)
{
    double largest = 0;
    for (uint32_t corner = 0; corner < gd_polygons_corner_count(polygons); corner++) {
        const double *position = polygons->positions[polygons->corners[corner]];
        for (int axis = 0; axis < 3; axis++) {
            if (!isfinite((float)position[axis])) return false;
            largest = fmax(largest, fabs(position[axis]));
        }
    }
    return largest == 0 || largest >= (double)FLT_MIN;
}

static enum gd_status write_stl(struct gd__output *output, const struct gd_polygons *polygons)
{
    if (!gd_polygons_are_triangles(polygons)) return GD_NOT_TRIANGLES;
    if (!has_float_range(polygons)) return GD_EXTENT;
    static const char header[80] = "binary STL"; /* the header must not begin with "solid" */
    gd__output_bytes(output, header, sizeof header);
    gd__output_little_endian(output, polygons->polygon_count, 4);
    for (uint32_t i = 0; i < polygons->polygon_count && !output->failed; i++) {
        struct gd_vec3 corners[3];
        for (uint32_t k = 0; k < 3; k++)
            corners[k] = corner_position(polygons, gd_polygons_first(polygons, i) + k);
        write_stl_vector(output, normal_of(corners[0], corners[1], corners[2]));
        for (int k = 0; k < 3; k++) write_stl_vector(output, corners[k]);
        gd__output_little_endian(output, 0, 2); /* no attributes */
    }
    return GD_OK;
}

static enum gd_status write_glb(struct gd__output *output, const struct gd_polygons *polygons)
{
    return gd__glb_write(output, &(struct gd_result){.mesh = polygons});
}

static enum gd_status write_gltf(struct gd__output *output, const struct gd_polygons *polygons)
{
    return gd__gltf_write(output, &(struct gd_result){.mesh = polygons});
}

static enum gd_status write_format(struct gd__output *output, const struct gd_polygons *polygons,
                                   enum gd_format format)
{
    switch (format) {
#define WRITER_CASE(NAME, name, media)                                                             \
    case GD_FORMAT_##NAME:                                                                         \
        return write_##name(output, polygons);
        GD_WRITTEN_FORMAT_MAP(WRITER_CASE)
#undef WRITER_CASE
    case GD_FORMAT_3MF:
    case GD_FORMAT_ANY:
        break;
    }
    return GD_INVALID_ARGUMENT;
}

enum gd_status gd__output_finish(struct gd__output *output, enum gd_status status, char **out,
                                 size_t *size)
{
    if (status == GD_OK && output->failed) status = output->status ? output->status : GD_NO_MEMORY;
    if (status != GD_OK) {
        free(output->bytes);
        return status;
    }
    *out = output->bytes;
    *size = output->size;
    return GD_OK;
}

enum gd_status gd_write_polygons(const struct gd_polygons *polygons, enum gd_format format,
                                 char **out, size_t *size)
{
    return gd_write_polygons_within(polygons, format, NULL, out, size);
}

enum gd_status gd_write_polygons_within(const struct gd_polygons *polygons, enum gd_format format,
                                        const struct gd_control *control, char **out, size_t *size)
{
    struct gd__output output = {.control = control};
    enum gd_status status = write_format(&output, polygons, format);
    return gd__output_finish(&output, status, out, size);
}
