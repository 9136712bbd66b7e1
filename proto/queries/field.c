#include "proto/queries/field.h"

#include <math.h>
#include <string.h>

#include "generated/answers.h"
#include "proto/json/writer.h"
#include "proto/json/number.h"
#include "proto/queries/evaluation.h"

/* --- descriptions ----------------------------------------------------------------------------- */

bool proto_field_write_set(const json_t *set, char **out)
{
    struct proto_writer writer;
    size_t size;
    proto_writer_init(&writer, PROTO_FIELD_SET + 1);
    proto_write_document(&writer, set);
    proto_append(&writer, "", 1); /* the NUL */
    bool is_long = writer.failure == PROTO_WRITER_TOO_LARGE;
    *out = proto_writer_take(&writer, &size);
    proto_writer_free(&writer);
    return *out || is_long;
}

static void encode_members(struct proto_writer *writer, const struct gd_mesh *mesh,
                           const struct proto_field_description *description, uint32_t wanted)
{
    const struct proto_options options = {.fields = wanted, .names = proto_field_fields};
    if (proto_field(writer, &options, PROTO_FIELD_FIELD_ID))
        proto_write_string(writer, description->id);
    proto_field_uint(writer, &options, PROTO_FIELD_FIELD_WEDGES, description->wedges);
    proto_field_uint(writer, &options, PROTO_FIELD_FIELD_BYTES, description->bytes);
    proto_field_number(writer, &options, PROTO_FIELD_FIELD_BUILD_MS, description->build_ms);
    proto_field_number(writer, &options, PROTO_FIELD_FIELD_MAX, description->max);
    if (wanted & PROTO_FIELD_FIELD_MAX) proto_reason_encode(writer, description->max);
    if (proto_field(writer, &options, PROTO_FIELD_FIELD_FARTHEST)) {
        if (isnan(description->max))
            proto_write_null(writer);
        else
            proto_point_encode(writer, mesh, &description->farthest, NAN);
    }
    proto_field_uint(writer, &options, PROTO_FIELD_FIELD_MEMBERS, description->members);
    proto_field_number(writer, &options, PROTO_FIELD_FIELD_MAX_DISTANCE,
                       description->max_distance > 0 ? description->max_distance : NAN);
    if (proto_field(writer, &options, PROTO_FIELD_FIELD_SET)) {
        if (description->set)
            proto_write_raw(writer, description->set, strlen(description->set));
        else
            proto_write_null(writer);
    }
    if (proto_field(writer, &options, PROTO_FIELD_FIELD_CREATED))
        proto_write_time(writer, description->created);
}

void proto_field_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct proto_field_description *description, uint32_t wanted)
{
    proto_write_object_begin(writer);
    encode_members(writer, mesh, description, wanted);
    proto_write_object_end(writer);
}

void proto_field_encode_listed(struct proto_writer *writer, const struct gd_mesh *mesh,
                               const struct proto_field_description *description)
{
    proto_write_object_begin(writer);
    encode_members(writer, mesh, description, PROTO_FIELD_FIELD_ALL);
    proto_member_uint(writer, "uses", description->uses);
    proto_write_object_end(writer);
}

/* --- values and wedges ------------------------------------------------------------------------ */

void proto_values_encode(struct proto_writer *writer, const double *values, size_t count)
{
    proto_write_object_begin(writer);
    proto_member_numbers(writer, "values", values, count);
    proto_write_object_end(writer);
}

/* Reads an index at the start of `*text` and advances `*text` past it. */
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

void proto_wedges_encode(struct proto_writer *writer, const struct gd_vertex ends[2],
                         const struct gd_wedge *wedges, uint32_t count, uint32_t wanted)
{
    proto_write_object_begin(writer);
    if (wanted & PROTO_WEDGES_FIELD_EDGE) proto_member_indices(writer, "edge", &ends->index, 2);
    if (wanted & PROTO_WEDGES_FIELD_WEDGES) {
        proto_member_array(writer, "wedges");
        for (uint32_t i = 0; i < count; i++) proto_wedge_encode(writer, &wedges[i]);
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
}
