/* Writer: writes JSON into a bounded, growable text buffer.
 *
 *     struct proto_writer writer;
 *     proto_writer_init(&writer, 64 << 20);
 *     proto_write_object_begin(&writer);
 *     proto_write_key(&writer, "distance");
 *     proto_write_number(&writer, 0.25);
 *     proto_write_object_end(&writer);
 *     if (!proto_writer_check(&writer, problem)) …
 *     proto_writer_free(&writer);
 *
 * The writer adds commas. The caller matches begins with ends and keys with values. A failed writer
 * ignores further text, so one check at the end suffices. One writer belongs to one thread at a
 * time.
 *
 * A writer with a sink keeps a bounded buffer: it passes the buffer to the sink when more text
 * would not fit into `block` bytes. The buffer grows further only for a single piece of text that
 * is larger than a block.
 *
 * A writer with an account takes bytes from the account before its buffer grows, and returns them
 * when the text is freed. Buffers up to PROTO_WRITER_SMALL bytes are not counted. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PROTO_WRITER_SMALL 8192

/* Limits the memory of all writers that share it. Thread-safe. */
struct proto_writer_account {
    /* returns false if there is too little room for `bytes` more */
    bool (*take)(void *user, size_t bytes);
    void (*give)(void *user, size_t bytes);
    void *user;
    size_t most; /* more than these bytes never fit, however long one waits */
};

/* Receives a writer's text, block by block. */
struct proto_writer_sink {
    /* returns false to make the writer fail */
    bool (*write)(void *user, const char *text, size_t size);
    void *user;
    size_t block; /* bytes */
};

enum proto_writer_failure {
    PROTO_WRITER_FINE,
    PROTO_WRITER_NO_MEMORY, /* the system has no memory */
    PROTO_WRITER_NO_ROOM,   /* the account is full at the moment */
    PROTO_WRITER_TOO_LARGE, /* the text exceeds the maximum */
    PROTO_WRITER_STOPPED    /* the sink stopped the writer */
};

struct proto_writer {
    char *data;      /* the text so far, not NUL-terminated; NULL while empty */
    size_t size;     /* bytes of the text */
    size_t capacity; /* <= maximum */
    size_t maximum;  /* limit of size + flushed */
    /* borrowed; NULL means that memory is not counted */
    const struct proto_writer_account *account;
    size_t counted;                       /* bytes taken from the account: 0 or the capacity */
    const struct proto_writer_sink *sink; /* borrowed; NULL means `data` holds the whole text */
    size_t flushed;                       /* bytes that the sink has received */
    enum proto_writer_failure failure;
    bool comma; /* true if a value was just written, so the next one needs a comma */
};

/* Initializes an empty writer for at most `maximum` bytes. Allocates nothing. */
void proto_writer_init(struct proto_writer *writer, size_t maximum);
void proto_writer_free(struct proto_writer *writer); /* may be called repeatedly */

/* Reserves room for about `more` bytes at once, instead of growing step by step. */
void proto_writer_expect(struct proto_writer *writer, size_t more);

/* Passes the buffer to the sink. Fails the writer (proto_writer_check) if the text exceeds the
 * maximum or the sink stops. */
void proto_writer_flush(struct proto_writer *writer);

/* Moves the text, of *size bytes, to the caller, who frees it by free(). Leaves the writer empty.
 * Returns NULL if the writer failed or is empty. With an account the buffer is shrunk to the text,
 * and the caller returns proto_writer_counted(*size) bytes to the account on free. */
char *proto_writer_take(struct proto_writer *writer, size_t *size);

/* Returns the bytes that an account counts for a buffer of that capacity. */
size_t proto_writer_counted(size_t capacity);

void proto_write_object_begin(struct proto_writer *writer);
void proto_write_object_end(struct proto_writer *writer);
void proto_write_array_begin(struct proto_writer *writer);
void proto_write_array_end(struct proto_writer *writer);

/* `key` is written unescaped. */
void proto_write_key(struct proto_writer *writer, const char *key);

/* Writes an escaped string. Bytes that are not UTF-8 become U+FFFD. NULL becomes null. */
void proto_write_string(struct proto_writer *writer, const char *text);

/* Writes the shortest text that reads back as the same double; null for NaN and infinities. */
void proto_write_number(struct proto_writer *writer, double value);
/* writes an array of numbers */
void proto_write_numbers(struct proto_writer *writer, const double *values, size_t count);
void proto_write_triples(struct proto_writer *writer, const double (*values)[3],
                         size_t count); /* an array of arrays of 3 */
void proto_write_uint(struct proto_writer *writer, uint64_t value);
void proto_write_int(struct proto_writer *writer, int64_t value);
void proto_write_bool(struct proto_writer *writer, bool value);
void proto_write_null(struct proto_writer *writer);

/* Writes an array of indices; UINT32_MAX becomes null. */
void proto_write_indices(struct proto_writer *writer, const uint32_t *values, size_t count);

/* Writes a time in seconds since 1970 as "2026-01-01T00:00:00Z"; null if no calendar date can hold
 * it. */
void proto_write_time(struct proto_writer *writer, int64_t seconds);

/* Writes a value that is already JSON. */
void proto_write_raw(struct proto_writer *writer, const char *json, size_t size);

/* Write a member of an object: a key and its value. */
void proto_member_string(struct proto_writer *writer, const char *key, const char *text);
/* a value that is not finite becomes null */
void proto_member_number(struct proto_writer *writer, const char *key, double value);
void proto_member_uint(struct proto_writer *writer, const char *key, uint64_t value);
void proto_member_bool(struct proto_writer *writer, const char *key, bool value);
void proto_member_time(struct proto_writer *writer, const char *key, int64_t seconds);
void proto_member_numbers(struct proto_writer *writer, const char *key, const double *values,
                          size_t count);
void proto_member_indices(struct proto_writer *writer, const char *key, const uint32_t *values,
                          size_t count);
/* Write a key and begin an array or an object. */
void proto_member_array(struct proto_writer *writer, const char *key);
void proto_member_object(struct proto_writer *writer, const char *key);
void proto_member_null(struct proto_writer *writer, const char *key);

/* Appends text of any kind (metrics, newlines between records) without commas and escapes. */
void proto_append(struct proto_writer *writer, const char *text, size_t size);
void proto_append_format(struct proto_writer *writer, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
