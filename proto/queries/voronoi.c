#include "proto/queries/voronoi.h"

#include "proto/json/member.h"

void proto_voronoi_begin(struct proto_writer *writer)
{
    proto_write_object_begin(writer);
}

void proto_voronoi_end(struct proto_writer *writer)
{
    proto_write_object_end(writer);
}

static void list_begin(struct proto_writer *writer, const char *name)
{
    proto_write_key(writer, name);
    proto_write_array_begin(writer);
}

void proto_voronoi_labels_begin(struct proto_writer *writer)
{
    list_begin(writer, "labels");
}

void proto_voronoi_label(struct proto_writer *writer, uint32_t label)
{
    if (label == UINT32_MAX)
        proto_write_null(writer);
    else
        proto_write_uint(writer, label);
}

void proto_voronoi_bisectors_begin(struct proto_writer *writer)
{
    list_begin(writer, "bisectors");
}

void proto_voronoi_list_end(struct proto_writer *writer)
{
    proto_write_array_end(writer);
}

void proto_bisector_begin(struct proto_writer *writer, const struct gd_bisector *bisector)
{
    proto_write_object_begin(writer);
    list_begin(writer, "members");
    for (int i = 0; i < 2; i++) proto_write_uint(writer, bisector->members[i]);
    proto_write_array_end(writer);
    proto_member_bool(writer, "closed", bisector->closed);
    proto_member_number(writer, "length", bisector->length);
}

void proto_bisector_points_begin(struct proto_writer *writer)
{
    list_begin(writer, "points");
}

void proto_bisector_end(struct proto_writer *writer)
{
    proto_write_object_end(writer);
}
