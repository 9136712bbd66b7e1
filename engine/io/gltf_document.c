#include "io/gltf_document.h"

#include <math.h>

const struct gd__gltf_box gd__gltf_empty_box = {{INFINITY, INFINITY, INFINITY},
                                                {-INFINITY, -INFINITY, -INFINITY}};

void gd__gltf_widen(struct gd__gltf_box *box, const double position[3])
{
    for (int axis = 0; axis < 3; axis++) {
        if (position[axis] <= box->min[axis]) box->min[axis] = position[axis];
        if (position[axis] >= box->max[axis]) box->max[axis] = position[axis];
    }
}

void gd__gltf_member(struct gd__output *json, const char *key, uint64_t value)
{
    gd__output_text(json, key);
    gd__output_integer(json, value);
}

void gd__gltf_triple(struct gd__output *json, const char *key, const double values[3])
{
    gd__output_text(json, key);
    for (int axis = 0; axis < 3; axis++) {
        gd__output_text(json, axis ? "," : "[");
        gd__output_double(json, values[axis]);
    }
    gd__output_text(json, "]");
}

void gd__gltf_colour(struct gd__output *json, const struct gd_colour *colour)
{
    const double components[] = {colour->red, colour->green, colour->blue};
    gd__output_text(json, "\"baseColorFactor\":[");
    for (int i = 0; i < 3; i++) {
        gd__output_double(json, components[i]);
        gd__output_text(json, ",");
    }
    gd__output_text(json, "1]");
}

void gd__gltf_view(struct gd__gltf_writing *writing, size_t begin, unsigned stride, unsigned target)
{
    struct gd__output *json = &writing->view_list;
    gd__output_text(json, writing->views++ ? ",{\"buffer\":0" : "{\"buffer\":0");
    gd__gltf_member(json, ",\"byteOffset\":", begin);
    gd__gltf_member(json, ",\"byteLength\":", writing->binary.size - begin);
    if (stride) gd__gltf_member(json, ",\"byteStride\":", stride);
    if (target) gd__gltf_member(json, ",\"target\":", target);
    gd__output_text(json, "}");
}

void gd__gltf_accessor(struct gd__gltf_writing *writing, uint32_t view, size_t offset,
                       unsigned type, uint64_t count, const char *end)
{
    struct gd__output *json = &writing->accessor_list;
    gd__output_text(json, writing->accessors++ ? ",{" : "{");
    gd__gltf_member(json, "\"bufferView\":", view);
    if (offset) gd__gltf_member(json, ",\"byteOffset\":", offset);
    gd__gltf_member(json, ",\"componentType\":", type);
    gd__gltf_member(json, ",\"count\":", count);
    gd__output_text(json, end);
}

void gd__gltf_positions(struct gd__gltf_writing *writing, size_t begin,
                        const double (*positions)[3], size_t count, size_t least)
{
    struct gd__gltf_box box = gd__gltf_empty_box;
    size_t offset = writing->binary.size - begin, written = count > least ? count : least;
    for (size_t i = 0; i < written; i++) {
        const double *position = positions[i < count ? i : count - 1];
        double rounded[3];
        for (int axis = 0; axis < 3; axis++) {
            float value = (float)(position[axis] - writing->origin[axis]);
            rounded[axis] = (double)value;
            writing->fits &= isfinite(rounded[axis] + writing->origin[axis]);
            gd__output_f32(&writing->binary, value);
        }
        gd__gltf_widen(&box, rounded);
    }
    if (!writing->fits) return; /* the file is rejected, and JSON has no infinite numbers */
    gd__gltf_accessor(writing, writing->views, offset, GD__GLTF_FLOAT, written,
                      ",\"type\":\"VEC3\"");
    gd__gltf_triple(&writing->accessor_list, ",\"min\":", box.min);
    gd__gltf_triple(&writing->accessor_list, ",\"max\":", box.max);
    gd__output_text(&writing->accessor_list, "}");
}
