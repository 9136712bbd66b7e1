#include "gd/result_file.h"

#include <math.h>
#include <stdlib.h>

#include "gd/number.h"
#include "io/gltf_document.h"
#include "io/writers.h"

/* --- PLY -------------------------------------------------------------------------------------- */

static enum gd_status write_ply(struct gd__output *output, const struct gd_result *result)
{
    if (!result->mesh) return GD_INVALID_ARGUMENT;
    gd__write_ply(output, result->mesh, result->distances);
    return GD_OK;
}

/* --- OBJ -------------------------------------------------------------------------------------- */

static void write_line(struct gd__output *output, uint64_t begin, uint64_t count)
{
    gd__output_text(output, "l");
    for (uint64_t i = 0; i < count; i++) {
        gd__output_text(output, " ");
        gd__output_integer(output, begin + i + 1);
    }
    gd__output_text(output, "\n");
}

/* Returns true if the line's level differs from that of the previous line. */
static bool begins_level(const struct gd_result *result, uint32_t line)
{
    return result->levels && (!line || result->levels[line] != result->levels[line - 1]);
}

static void write_group(struct gd__output *output, double level)
{
    gd__output_text(output, "g level_");
    gd__output_double(output, level);
    gd__output_text(output, "\n");
}

/* Writes OBJ. A line of one point is not valid in OBJ, so only its vertex is written. */
static enum gd_status write_obj(struct gd__output *output, const struct gd_result *result)
{
    if (!result->line_count) return GD_INVALID_ARGUMENT;
    uint64_t before = result->mesh ? result->mesh->position_count : 0;
    if (result->mesh) gd__write_obj(output, result->mesh);
    for (uint32_t i = 0; i < result->first[result->line_count]; i++) {
        gd__output_text(output, "v ");
        gd__write_xyz(output, result->points[i], " ");
        gd__output_text(output, "\n");
    }
    for (uint32_t line = 0; line < result->line_count; line++) {
        uint32_t begin = result->first[line], count = result->first[line + 1] - begin;
        if (begins_level(result, line)) write_group(output, result->levels[line]);
        if (count > 1) write_line(output, before + begin, count);
    }
    return GD_OK;
}

/* --- CSV -------------------------------------------------------------------------------------- */

/* Writes the position and the distance of a row, without the line end. Leaves the distance empty if
 * it is not finite. */
static void write_place(struct gd__output *output, const double position[3], double distance)
{
    gd__output_text(output, ",");
    gd__write_xyz(output, position, ",");
    gd__output_text(output, ",");
    if (isfinite(distance)) gd__output_double(output, distance);
}

static double step(const double a[3], const double b[3])
{
    return hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
}

static void write_line_rows(struct gd__output *output, const struct gd_result *result,
                            uint32_t line)
{
    double along = 0;
    for (uint32_t i = result->first[line]; i < result->first[line + 1]; i++) {
        if (i > result->first[line]) along += step(result->points[i - 1], result->points[i]);
        gd__output_integer(output, line);
        gd__output_text(output, ",");
        gd__output_integer(output, i - result->first[line]);
        write_place(output, result->points[i], along);
        if (result->levels) gd__output_text(output, ",");
        if (result->levels) gd__output_double(output, result->levels[line]);
        gd__output_text(output, "\r\n");
    }
}

static enum gd_status write_csv(struct gd__output *output, const struct gd_result *result)
{
    if (!result->line_count && !(result->mesh && result->distances)) return GD_INVALID_ARGUMENT;
    gd__output_text(output, !result->line_count ? "vertex,x,y,z,distance\r\n"
                            : result->levels    ? "line,point,x,y,z,along,level\r\n"
                                                : "line,point,x,y,z,along\r\n");
    for (uint32_t line = 0; line < result->line_count; line++)
        write_line_rows(output, result, line);
    for (uint32_t i = 0; !result->line_count && i < result->mesh->position_count; i++) {
        gd__output_integer(output, i);
        write_place(output, result->mesh->positions[i], result->distances[i]);
        gd__output_text(output, "\r\n");
    }
    return GD_OK;
}

/* --- all formats ------------------------------------------------------------------------------ */

static enum gd_status write_glb(struct gd__output *output, const struct gd_result *result)
{
    return gd__glb_write(output, result);
}

static enum gd_status write_format(struct gd__output *output, const struct gd_result *result,
                                   enum gd_result_format format)
{
    switch (format) {
#define WRITER_CASE(NAME, name, media)                                                             \
    case GD_RESULT_##NAME:                                                                         \
        return write_##name(output, result);
        GD_RESULT_FORMAT_MAP(WRITER_CASE)
#undef WRITER_CASE
    }
    return GD_INVALID_ARGUMENT;
}

enum gd_status gd_write_result(const struct gd_result *result, enum gd_result_format format,
                               char **out, size_t *size)
{
    struct gd__output output = {0};
    enum gd_status status = write_format(&output, result, format);
    return gd__output_finish(&output, status, out, size);
}

/* A number has at most GD_NUMBER_SIZE characters, and an index has at most 11. The output grows by
 * half. While it is copied, the old and the new buffer together take up to 2.5 times the old
 * size. */
#define ROW_BYTES    (5 * (GD_NUMBER_SIZE + 1) + 2 * 11)
#define CORNER_BYTES 11
#define LAYER_ROWS   8 /* the members of a layer in the document, in rows */
#define GROWTH       2.5

size_t gd_result_cost(const struct gd_result *result)
{
    double rows = result->mesh ? result->mesh->position_count : 0;
    if (result->line_count) rows += result->first[result->line_count] + (double)result->line_count;
    rows += result->pose_count;
    for (uint32_t i = 0; i < result->layer_count; i++)
        rows += (double)gd__gltf_layer_points(&result->layers[i]) + LAYER_ROWS;
    double corners =
        result->mesh ? gd_polygons_corner_count(result->mesh) + (double)result->mesh->polygon_count
                     : 0;
    return (size_t)(GROWTH * (rows * ROW_BYTES + corners * CORNER_BYTES + 4096));
}
