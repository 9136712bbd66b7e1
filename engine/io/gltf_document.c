#include "io/gltf_document.h"

#include <math.h>

const struct gd__gltf_box gd__gltf_empty_box = {{INFINITY, INFINITY, INFINITY},
                                                {-INFINITY, -INFINITY, -INFINITY}};

void gd__gltf_widen(struct gd__gltf_box *box, const double (*positions)[3], size_t count)
{
    for (size_t i = 0; i < count; i++) {
        for (int axis = 0; axis < 3; axis++) {
            box->min[axis] = fmin(box->min[axis], positions[i][axis]);
            box->max[axis] = fmax(box->max[axis], positions[i][axis]);
        }
    }
}

static float from_origin(const struct gd__gltf_writing *writing, const double position[3], int axis)
{
    return (float)(position[axis] - writing->origin[axis]);
}

/* Computes the box of the positions after they are rounded to floats. Returns false if a position
 * is beyond the range of floats. */
static bool float_box(const struct gd__gltf_writing *writing, const double (*positions)[3],
                      size_t count, struct gd__gltf_box *out)
{
    struct gd__gltf_box box = gd__gltf_empty_box;
    for (size_t i = 0; i < count; i++) {
        double written[1][3];
        for (int axis = 0; axis < 3; axis++) {
            written[0][axis] = (double)from_origin(writing, positions[i], axis);
            if (!isfinite(written[0][axis] + writing->origin[axis])) return false;
        }
        gd__gltf_widen(&box, (const double(*)[3])written, 1);
    }
    *out = box;
    return true;
}

void gd__gltf_write_positions(const struct gd__gltf_writing *writing, const double (*positions)[3],
                              size_t count)
{
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++)
            gd__output_f32(writing->binary, from_origin(writing, positions[i], axis));
}

void gd__gltf_text(struct gd__gltf_writing *writing, const char *text)
{
    gd__output_text(writing->json, text);
}

void gd__gltf_member(struct gd__gltf_writing *writing, const char *key, uint64_t value)
{
    gd__gltf_text(writing, key);
    gd__output_integer(writing->json, value);
}

void gd__gltf_triple(struct gd__gltf_writing *writing, const char *key, const double values[3])
{
    gd__gltf_text(writing, key);
    for (int axis = 0; axis < 3; axis++) {
        gd__gltf_text(writing, axis ? "," : "[");
        gd__output_double(writing->json, values[axis]);
    }
    gd__gltf_text(writing, "]");
}

void gd__gltf_colour(struct gd__gltf_writing *writing, const struct gd_colour *colour)
{
    const double components[] = {colour->red, colour->green, colour->blue};
    gd__gltf_text(writing, "\"baseColorFactor\":[");
    for (int i = 0; i < 3; i++) {
        gd__output_double(writing->json, components[i]);
        gd__gltf_text(writing, ",");
    }
    gd__gltf_text(writing, "1]");
}

void gd__gltf_view(struct gd__gltf_writing *writing, uint64_t size, unsigned stride,
                   unsigned target)
{
    gd__gltf_text(writing, writing->views++ ? ",{\"buffer\":0" : "{\"buffer\":0");
    gd__gltf_member(writing, ",\"byteOffset\":", writing->bytes);
    gd__gltf_member(writing, ",\"byteLength\":", size);
    if (stride) gd__gltf_member(writing, ",\"byteStride\":", stride);
    if (target) gd__gltf_member(writing, ",\"target\":", target);
    gd__gltf_text(writing, "}");
    writing->bytes += size;
}

void gd__gltf_accessor_begin(struct gd__gltf_writing *writing, uint32_t view, uint64_t offset,
                             unsigned type, uint64_t count)
{
    gd__gltf_text(writing, writing->accessors++ ? ",{" : "{");
    gd__gltf_member(writing, "\"bufferView\":", view);
    if (offset) gd__gltf_member(writing, ",\"byteOffset\":", offset);
    gd__gltf_member(writing, ",\"componentType\":", type);
    gd__gltf_member(writing, ",\"count\":", count);
}

bool gd__gltf_positions(struct gd__gltf_writing *writing, uint32_t view, uint64_t offset,
                        const double (*positions)[3], size_t count, size_t written)
{
    struct gd__gltf_box box;
    if (!float_box(writing, positions, count, &box)) return false;
    gd__gltf_accessor_begin(writing, view, offset, GD__GLTF_FLOAT, written);
    gd__gltf_text(writing, ",\"type\":\"VEC3\"");
    gd__gltf_triple(writing, ",\"min\":", box.min);
    gd__gltf_triple(writing, ",\"max\":", box.max);
    gd__gltf_text(writing, "}");
    return true;
}
