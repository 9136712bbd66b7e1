/* Writer: a bounded, growable text buffer that writes JSON as it goes.
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
 * Commas are the writer's business, matching begins with ends and keys with values the caller's.
 * Failure is sticky: after the first one nothing more is written, so that it is checked once, at
 * the end. One writer belongs to one thread at a time.
 *
 * A writer with a sink keeps a bounded buffer: it hands the buffer to the sink when more text would
 * not fit into `block` bytes. Text of more than a block at once still grows the buffer.
 *
 * A writer with an account takes the bytes of its buffer from it before the buffer grows, and gives
 * them back when the text is freed. Buffers up to PROTO_WRITER_SMALL bytes are not counted. */
#ifndef PROTO_WRITER_H
#define PROTO_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PROTO_WRITER_SMALL 8192

/* Counts the memory of texts. Thread-safe. */
struct proto_writer_account {
    bool (*take)(void *user, size_t bytes); /* false: there is no room for so many more */
    void (*give)(void *user, size_t bytes);
    void *user;
};

/* Receives the text of a writer, block by block. */
struct proto_writer_sink {
    bool (*write)(void *user, const char *text, size_t size); /* false: the writer fails */
    void *user;
    size_t block; /* bytes */
};

enum proto_writer_failure {
    PROTO_WRITER_FINE,
    PROTO_WRITER_NO_MEMORY, /* of the system */
    PROTO_WRITER_NO_ROOM,   /* in the account, for now */
    PROTO_WRITER_TOO_LARGE, /* over the maximum */
    PROTO_WRITER_STOPPED    /* by the sink */
};

struct proto_writer {
    char *data;      /* the text so far, not NUL-terminated; NULL while empty */
    size_t size;     /* bytes of it */
    size_t capacity; /* <= maximum */
    size_t maximum;  /* of size + flushed */
    const struct proto_writer_account *account; /* borrowed; NULL: nothing is counted */
    size_t counted;                             /* bytes taken from it: 0 or the capacity */
    const struct proto_writer_sink *sink;       /* borrowed; NULL: `data` is all of the text */
    size_t flushed;                             /* bytes that the sink has received */
    enum proto_writer_failure failure;
    bool comma; /* a value stands before: the next one needs a comma */
};

/* An empty writer that will hold at most `maximum` bytes. Allocates nothing. */
void proto_writer_init(struct proto_writer *writer, size_t maximum);
void proto_writer_free(struct proto_writer *writer); /* a second time is harmless */

/* Makes room at once for about so many bytes that are to come, instead of now and then. */
void proto_writer_expect(struct proto_writer *writer, size_t more);

/* Hands what the buffer holds to the sink: the text is within the maximum only if that succeeds. */
void proto_writer_flush(struct proto_writer *writer);

/* Gives the text to the caller, who frees it by free(); *size bytes. Leaves the writer empty. NULL
 * if the writer failed or is empty. Of a writer with an account the buffer is cut to the text, and
 * the caller gives back proto_writer_counted(*size) bytes when it frees it. */
char *proto_writer_take(struct proto_writer *writer, size_t *size);

/* Bytes that an account counts for a buffer of that capacity. */
size_t proto_writer_counted(size_t capacity);

void proto_write_object_begin(struct proto_writer *writer);
void proto_write_object_end(struct proto_writer *writer);
void proto_write_array_begin(struct proto_writer *writer);
void proto_write_array_end(struct proto_writer *writer);

/* `key` is written as it is: it holds nothing that needs escaping. */
void proto_write_key(struct proto_writer *writer, const char *key);

/* Escaped; bytes that are not UTF-8 become U+FFFD. NULL: null. */
void proto_write_string(struct proto_writer *writer, const char *text);

/* Shortest text that reads back as the same double; NaN and infinities: null. */
void proto_write_number(struct proto_writer *writer, double value);
/* an array of them */
void proto_write_numbers(struct proto_writer *writer, const double *values, size_t count);
void proto_write_triples(struct proto_writer *writer, const double (*values)[3],
                         size_t count); /* an array of each three */
void proto_write_uint(struct proto_writer *writer, uint64_t value);
void proto_write_int(struct proto_writer *writer, int64_t value);
void proto_write_bool(struct proto_writer *writer, bool value);
void proto_write_null(struct proto_writer *writer);

/* A time in seconds since 1970 as "2026-01-01T00:00:00Z"; null beyond what a calendar holds. */
void proto_write_time(struct proto_writer *writer, int64_t seconds);

/* A value that is JSON already. */
void proto_write_raw(struct proto_writer *writer, const char *json, size_t size);

/* Text of any kind (metrics, newlines between records): no commas, no escapes. */
void proto_append(struct proto_writer *writer, const char *text, size_t size);
void proto_append_format(struct proto_writer *writer, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
