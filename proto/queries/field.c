#include "proto/queries/field.h"

#include <math.h>

#include "proto/json/decode.h"
#include "proto/queries/evaluation.h"
#include "proto/json/member.h"
#include "proto/json/number.h"

/* --- descriptions ----------------------------------------------------------------------------- */

static void encode_field(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct proto_field_description *description,
                         enum proto_field_field field)
{
    switch (field) {
    case PROTO_FIELD_FIELD_ID:
        proto_write_string(writer, description->id);
        break;
    case PROTO_FIELD_FIELD_WEDGES:
        proto_write_uint(writer, description->wedges);
        break;
    case PROTO_FIELD_FIELD_BYTES:
        proto_write_uint(writer, description->bytes);
        break;
    case PROTO_FIELD_FIELD_BUILD_MS:
        proto_write_number(writer, description->build_ms);
        break;
    case PROTO_FIELD_FIELD_MAX:
        proto_write_number(writer, description->max);
        proto_reason_encode(writer, description->max);
        break;
    case PROTO_FIELD_FIELD_FARTHEST:
        if (isnan(description->max))
            proto_write_null(writer);
        else
            proto_point_encode(writer, mesh, &description->farthest, NAN);
        break;
    case PROTO_FIELD_FIELD_MEMBERS:
        proto_write_uint(writer, description->members);
        break;
    case PROTO_FIELD_FIELD_MAX_DISTANCE:
        proto_write_number(writer, description->max_distance > 0 ? description->max_distance : NAN);
        break;
    case PROTO_FIELD_FIELD_ALL:
        break; /* a mask, no field */
    }
}

void proto_field_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct proto_field_description *description, uint32_t wanted)
{
    proto_write_object_begin(writer);
    for (unsigned i = 0; proto_field_fields[i]; i++) {
        if (!(wanted >> i & 1)) continue;
        proto_write_key(writer, proto_field_fields[i]);
        encode_field(writer, mesh, description, (enum proto_field_field)(1u << i));
    }
    proto_write_object_end(writer);
}

/* --- values and wedges ------------------------------------------------------------------------ */

void proto_values_encode(struct proto_writer *writer, const double *values, size_t count)
{
    proto_write_object_begin(writer);
    proto_write_key(writer, "values");
    proto_write_numbers(writer, values, count);
    proto_write_object_end(writer);
}

const char *const proto_wedges_parameters[] = {"edge", NULL};

/* An index at the start of `*text`, which moves past it. */
static bool take_index(const char **text, uint32_t *out)
{
    uint64_t value;
    size_t length = proto_integer_parse(*text, &value);
    if (length == 0 || value >= UINT32_MAX) return false;
    *text += length;
    *out = (uint32_t)value;
    return true;
}

bool proto_wedges_parse(const struct proto_parameters *parameters, struct gd_vertex ends[2],
                        struct proto_problem *problem)
{
    uint32_t a, b;
    const char *text = proto_parameters_require(parameters, "edge", problem);
    if (!text) return false;
    if (!take_index(&text, &a) || *text++ != '-' || !take_index(&text, &b) || *text)
        return proto_problem_refuse(problem, "edge", "expected an edge by its two vertices: 3-9");
    ends[0].index = a < b ? a : b;
    ends[1].index = a < b ? b : a;
    return true;
}

static void encode_wedge(struct proto_writer *writer, const struct gd_wedge *wedge)
{
    proto_write_object_begin(writer);
    proto_member_number(writer, "b0", wedge->b0);
    proto_member_number(writer, "b1", wedge->b1);
    proto_member_number(writer, "d0", wedge->d0);
    proto_member_number(writer, "d1", wedge->d1);
    proto_member_number(writer, "sigma", wedge->sigma);
    proto_member_bool(writer, "tau", wedge->tau);
    if (wedge->linear) proto_member_bool(writer, "linear", true);
    proto_write_key(writer, "source");
    proto_write_object_begin(writer);
    proto_member_uint(writer, wedge->at_vertex ? "vertex" : "member", wedge->source);
    proto_write_object_end(writer);
    proto_write_object_end(writer);
}

static void encode_edge(struct proto_writer *writer, const struct gd_vertex ends[2])
{
    proto_write_key(writer, "edge");
    proto_write_array_begin(writer);
    proto_write_uint(writer, ends[0].index);
    proto_write_uint(writer, ends[1].index);
    proto_write_array_end(writer);
}

void proto_wedges_encode(struct proto_writer *writer, const struct gd_vertex ends[2],
                         const struct gd_wedge *wedges, uint32_t count, uint32_t wanted)
{
    proto_write_object_begin(writer);
    if (wanted & PROTO_WEDGES_FIELD_EDGE) encode_edge(writer, ends);
    if (wanted & PROTO_WEDGES_FIELD_WEDGES) {
        proto_write_key(writer, "wedges");
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < count; i++) encode_wedge(writer, &wedges[i]);
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
}
