/* Member: a key of an object and its value, written at once. What is asked of values is in
 * writer.h. */
#ifndef PROTO_MEMBER_H
#define PROTO_MEMBER_H

#include "proto/json/writer.h"

void proto_member_string(struct proto_writer *writer, const char *key, const char *text);
/* not finite: null */
void proto_member_number(struct proto_writer *writer, const char *key, double value);
void proto_member_uint(struct proto_writer *writer, const char *key, uint64_t value);
void proto_member_int(struct proto_writer *writer, const char *key, int64_t value);
void proto_member_bool(struct proto_writer *writer, const char *key, bool value);
void proto_member_time(struct proto_writer *writer, const char *key, int64_t seconds);
void proto_member_numbers(struct proto_writer *writer, const char *key, const double *values,
                          size_t count);
/* A key, and the beginning of an array or an object. */
void proto_member_array(struct proto_writer *writer, const char *key);
void proto_member_object(struct proto_writer *writer, const char *key);
void proto_member_null(struct proto_writer *writer, const char *key);

#endif
