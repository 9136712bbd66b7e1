#include "proto/json/member.h"

void proto_member_string(struct proto_writer *writer, const char *key, const char *text)
{
    proto_write_key(writer, key);
    proto_write_string(writer, text);
}

void proto_member_number(struct proto_writer *writer, const char *key, double value)
{
    proto_write_key(writer, key);
    proto_write_number(writer, value);
}

void proto_member_uint(struct proto_writer *writer, const char *key, uint64_t value)
{
    proto_write_key(writer, key);
    proto_write_uint(writer, value);
}

void proto_member_int(struct proto_writer *writer, const char *key, int64_t value)
{
    proto_write_key(writer, key);
    proto_write_int(writer, value);
}

void proto_member_bool(struct proto_writer *writer, const char *key, bool value)
{
    proto_write_key(writer, key);
    proto_write_bool(writer, value);
}

void proto_member_time(struct proto_writer *writer, const char *key, int64_t seconds)
{
    proto_write_key(writer, key);
    proto_write_time(writer, seconds);
}

void proto_member_null(struct proto_writer *writer, const char *key)
{
    proto_write_key(writer, key);
    proto_write_null(writer);
}

void proto_member_numbers(struct proto_writer *writer, const char *key, const double *values,
                          size_t count)
{
    proto_write_key(writer, key);
    proto_write_numbers(writer, values, count);
}

void proto_member_array(struct proto_writer *writer, const char *key)
{
    proto_write_key(writer, key);
    proto_write_array_begin(writer);
}

void proto_member_object(struct proto_writer *writer, const char *key)
{
    proto_write_key(writer, key);
    proto_write_object_begin(writer);
}
