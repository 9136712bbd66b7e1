#include "proto/json/writer.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "gd/number.h"
#include "proto/json/number.h"
#include "proto/json/utf8.h"

#define FIRST_CAPACITY 1024
/* bytes; larger buffers grow by a quarter, smaller ones double */
#define GROWN_SLOWLY ((size_t)1 << 20)

/* --- the buffer ------------------------------------------------------------------------------- */

void proto_writer_init(struct proto_writer *writer, size_t maximum)
{
    *writer = (struct proto_writer){.maximum = maximum};
}

void proto_writer_free(struct proto_writer *writer)
{
    const struct proto_writer_account *account = writer->account;
    free(writer->data);
    if (writer->counted) account->give(account->user, writer->counted);
    proto_writer_init(writer, writer->maximum);
    writer->account = account;
}

size_t proto_writer_counted(size_t capacity)
{
    return capacity > PROTO_WRITER_SMALL ? capacity : 0;
}

/* Shrinks the buffer to the text and returns the difference to the account. */
static void cut(struct proto_writer *writer)
{
    size_t counted = proto_writer_counted(writer->size);
    char *data = realloc(writer->data, writer->size);
    /* on failure the buffer keeps its size, although no known allocator fails to shrink a block */
    if (data) writer->data = data;
    writer->account->give(writer->account->user, writer->counted - counted);
}

char *proto_writer_take(struct proto_writer *writer, size_t *size)
{
    if (writer->failure != PROTO_WRITER_FINE || writer->size == 0) return NULL;
    if (writer->counted) cut(writer);
    const struct proto_writer_account *account = writer->account;
    char *data = writer->data;
    *size = writer->size;
    proto_writer_init(writer, writer->maximum);
    writer->account = account;
    return data;
}

static bool fail(struct proto_writer *writer, enum proto_writer_failure failure)
{
    writer->failure = failure;
    return false;
}

/* Returns a capacity that has room for `more` further bytes and some reserve. The caller has
 * checked that these bytes are within the maximum. */
static size_t next_capacity(const struct proto_writer *writer, size_t more)
{
    size_t step = writer->capacity < GROWN_SLOWLY ? writer->capacity : writer->capacity / 4;
    const struct proto_writer_sink *sink = writer->sink;
    size_t most = sink && sink->block < writer->maximum ? sink->block : writer->maximum;
    if (writer->account && writer->account->most < most) most = writer->account->most;
    size_t capacity = writer->capacity > most - step ? most : writer->capacity + step;
    if (capacity < FIRST_CAPACITY) capacity = FIRST_CAPACITY;
    if (capacity > most) capacity = most;
    return capacity < writer->size + more ? writer->size + more : capacity;
}

void proto_writer_flush(struct proto_writer *writer)
{
    const struct proto_writer_sink *sink = writer->sink;
    if (writer->size == 0 || writer->failure != PROTO_WRITER_FINE) return;
    if (writer->size > writer->maximum - writer->flushed)
        fail(writer, PROTO_WRITER_TOO_LARGE);
    else if (!sink->write(sink->user, writer->data, writer->size))
        fail(writer, PROTO_WRITER_STOPPED);
    else
        writer->flushed += writer->size;
    writer->size = 0;
}

static bool grow(struct proto_writer *writer, size_t more)
{
    const struct proto_writer_account *account = writer->account;
    if (writer->failure != PROTO_WRITER_FINE) return false;
    if (more > writer->maximum - writer->flushed - writer->size)
        return fail(writer, PROTO_WRITER_TOO_LARGE);
    if (writer->sink && writer->size + more > writer->sink->block) {
        proto_writer_flush(writer);
        if (writer->failure != PROTO_WRITER_FINE) return false;
        if (more <= writer->capacity) return true;
    }
    size_t capacity = next_capacity(writer, more),
           counted = account ? proto_writer_counted(capacity) : 0;
    if (counted && counted > account->most) {
        writer->maximum = account->most;
        return fail(writer, PROTO_WRITER_TOO_LARGE);
    }
    if (counted && !account->take(account->user, counted - writer->counted))
        return fail(writer, PROTO_WRITER_NO_ROOM);
    char *data = realloc(writer->data, capacity);
    if (!data) {
        if (counted) account->give(account->user, counted - writer->counted);
        return fail(writer, PROTO_WRITER_NO_MEMORY);
    }
    writer->data = data;
    writer->capacity = capacity;
    writer->counted = counted;
    return true;
}

/* Makes room for `more` bytes at the end. Returns false if the writer has failed. */
static inline bool reserve(struct proto_writer *writer, size_t more)
{
    if (writer->failure == PROTO_WRITER_FINE && more <= writer->capacity - writer->size)
        return true;
    return grow(writer, more);
}

void proto_writer_expect(struct proto_writer *writer, size_t more)
{
    if (writer->sink && more > writer->sink->block) more = writer->sink->block;
    if (more <= writer->maximum - writer->flushed - writer->size) (void)reserve(writer, more);
}

void proto_append(struct proto_writer *writer, const char *text, size_t size)
{
    if (size == 0 || !reserve(writer, size)) return;
    memcpy(writer->data + writer->size, text, size);
    writer->size += size;
}

void proto_append_format(struct proto_writer *writer, const char *format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int size = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    if (size > 0 && reserve(writer, (size_t)size + 1)) {
        vsnprintf(writer->data + writer->size, (size_t)size + 1, format, again);
        writer->size += (size_t)size;
    }
    va_end(again);
}

/* --- JSON ------------------------------------------------------------------------------------- */

static void append_char(struct proto_writer *writer, char character)
{
    if (reserve(writer, 1)) writer->data[writer->size++] = character;
}

static void separate(struct proto_writer *writer)
{
    if (writer->comma) append_char(writer, ',');
    writer->comma = true;
}

static void begin(struct proto_writer *writer, char bracket)
{
    if (!reserve(writer, 2)) return;
    if (writer->comma) writer->data[writer->size++] = ',';
    writer->data[writer->size++] = bracket;
    writer->comma = false;
}

static void end(struct proto_writer *writer, char bracket)
{
    append_char(writer, bracket);
    writer->comma = true;
}

void proto_write_object_begin(struct proto_writer *writer)
{
    begin(writer, '{');
}

void proto_write_object_end(struct proto_writer *writer)
{
    end(writer, '}');
}

void proto_write_array_begin(struct proto_writer *writer)
{
    begin(writer, '[');
}

void proto_write_array_end(struct proto_writer *writer)
{
    end(writer, ']');
}

void proto_write_key(struct proto_writer *writer, const char *key)
{
    size_t size = strlen(key);
    if (!reserve(writer, size + 4)) return;
    char *at = writer->data + writer->size;
    if (writer->comma) *at++ = ',';
    *at++ = '"';
    at = (char *)memcpy(at, key, size) + size;
    *at++ = '"';
    *at++ = ':';
    writer->size = (size_t)(at - writer->data);
    writer->comma = false;
}

void proto_write_raw(struct proto_writer *writer, const char *json, size_t size)
{
    separate(writer);
    proto_append(writer, json, size);
}

void proto_write_null(struct proto_writer *writer)
{
    proto_write_raw(writer, "null", 4);
}

void proto_write_bool(struct proto_writer *writer, bool value)
{
    proto_write_raw(writer, value ? "true" : "false", value ? 4 : 5);
}

/* --- strings ---------------------------------------------------------------------------------- */

static void append_escape(struct proto_writer *writer, char character)
{
    /* pairs: the character and the letter of its escape */
    static const char short_forms[] = "\"\"\\\\\bb\ff\nn\rr\tt";
    for (const char *form = short_forms; *form; form += 2) {
        if (*form != character) continue;
        proto_append(writer, (const char[]){'\\', form[1]}, 2);
        return;
    }
    proto_append_format(writer, "\\u%04x", (unsigned char)character);
}

static bool needs_escape(char character)
{
    return (unsigned char)character < 0x20 || character == '"' || character == '\\';
}

/* Returns the number of leading bytes of `text` that need no escape. */
static size_t plain_run(const char *text, size_t size)
{
    size_t run = 0;
    while (run < size && !needs_escape(text[run])) {
        size_t length = proto_utf8_length(text + run, size - run);
        if (length == 0) break;
        run += length;
    }
    return run;
}

void proto_write_string(struct proto_writer *writer, const char *text)
{
    if (!text) {
        proto_write_null(writer);
        return;
    }
    separate(writer);
    append_char(writer, '"');
    for (size_t left = strlen(text); left > 0;) {
        size_t run = plain_run(text, left);
        proto_append(writer, text, run);
        text += run;
        left -= run;
        if (left == 0) break;
        if (needs_escape(*text))
            append_escape(writer, *text);
        else
            proto_append(writer, "\xef\xbf\xbd", 3);
        text++;
        left--;
    }
    append_char(writer, '"');
}

/* --- numbers ---------------------------------------------------------------------------------- */

/* Writes the number or null; there must be room for the longest number. Returns its end. */
static inline char *put_number(char *at, double value)
{
    if (isfinite(value)) return gd_number_format(at, value);
    memcpy(at, "null", 4);
    return at + 4;
}

void proto_write_number(struct proto_writer *writer, double value)
{
    if (!reserve(writer, 1 + GD_NUMBER_SIZE)) return;
    char *at = writer->data + writer->size;
    if (writer->comma) *at++ = ',';
    writer->size = (size_t)(put_number(at, value) - writer->data);
    writer->comma = true;
}

#define RUN 96 /* number of numbers or triples for which room is made at a time */

/* Writes each number with a comma after it. */
static void append_numbers(struct proto_writer *writer, const double *values, size_t count)
{
    if (!reserve(writer, GD_NUMBERS_SIZE(count))) return;
    writer->size =
        (size_t)(gd_numbers_format(writer->data + writer->size, values, count) - writer->data);
}

static void append_triples(struct proto_writer *writer, const double (*values)[3], size_t count)
{
    if (!reserve(writer, GD_TRIPLES_SIZE(count))) return;
    writer->size =
        (size_t)(gd_triples_format(writer->data + writer->size, values, count) - writer->data);
}

void proto_write_numbers(struct proto_writer *writer, const double *values, size_t count)
{
    proto_write_array_begin(writer);
    for (size_t i = 0; i < count; i += RUN)
        append_numbers(writer, values + i, count - i < RUN ? count - i : RUN);
    if (count && writer->failure == PROTO_WRITER_FINE) writer->size--; /* the last comma */
    proto_write_array_end(writer);
}

void proto_write_triples(struct proto_writer *writer, const double (*values)[3], size_t count)
{
    if (!count) return;
    separate(writer);
    for (size_t i = 0; i < count; i += RUN)
        append_triples(writer, values + i, count - i < RUN ? count - i : RUN);
    if (writer->failure == PROTO_WRITER_FINE) writer->size--; /* the last comma */
}

void proto_write_indices(struct proto_writer *writer, const uint32_t *values, size_t count)
{
    proto_write_array_begin(writer);
    for (size_t i = 0; i < count; i++) {
        if (values[i] == UINT32_MAX)
            proto_write_null(writer);
        else
            proto_write_uint(writer, values[i]);
    }
    proto_write_array_end(writer);
}

void proto_write_uint(struct proto_writer *writer, uint64_t value)
{
    char text[PROTO_INTEGER_SIZE];
    proto_write_raw(writer, text, proto_integer_print(value, text));
}

void proto_write_int(struct proto_writer *writer, int64_t value)
{
    char text[PROTO_INTEGER_SIZE + 1] = "-";
    bool negative = value < 0;
    size_t length =
        proto_integer_print(negative ? 0 - (uint64_t)value : (uint64_t)value, text + negative);
    proto_write_raw(writer, text, length + negative);
}

void proto_write_time(struct proto_writer *writer, int64_t seconds)
{
    char text[32];
    struct tm tm;
    time_t time = (time_t)seconds;
    size_t size = gmtime_r(&time, &tm) ? strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &tm) : 0;
    proto_write_string(writer, size ? text : NULL);
}

/* --- members ---------------------------------------------------------------------------------- */

#define MEMBER(kind, type)                                                                         \
    void proto_member_##kind(struct proto_writer *writer, const char *key, type value)             \
    {                                                                                              \
        proto_write_key(writer, key);                                                              \
        proto_write_##kind(writer, value);                                                         \
    }
MEMBER(string, const char *)
MEMBER(number, double)
MEMBER(uint, uint64_t)
MEMBER(bool, bool)
MEMBER(time, int64_t)
#undef MEMBER

#define MEMBER(kind, type)                                                                         \
    void proto_member_##kind(struct proto_writer *writer, const char *key, const type *values,     \
                             size_t count)                                                         \
    {                                                                                              \
        proto_write_key(writer, key);                                                              \
        proto_write_##kind(writer, values, count);                                                 \
    }
MEMBER(numbers, double)
MEMBER(indices, uint32_t)
#undef MEMBER

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

void proto_member_null(struct proto_writer *writer, const char *key)
{
    proto_write_key(writer, key);
    proto_write_null(writer);
}
