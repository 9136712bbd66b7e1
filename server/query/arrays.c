#include "server/query/arrays.h"

#include <endian.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "server/base/gzip.h"

#define MAGIC       "GDARRAYS"
#define VERSION     1
#define HEAD_BYTES  16
#define ENTRY_BYTES 64
#define NAME_BYTES  (SERVER_ARRAYS_NAME + 1)
#define PIECE       1024 /* numbers written at a time */

void server_arrays_add(struct server_arrays *arrays, const struct server_array *array)
{
    arrays->list[arrays->count++] = *array;
}

void server_arrays_add_numbers(struct server_arrays *arrays, const char *name, uint32_t columns,
                               uint64_t rows, const double *numbers)
{
    server_arrays_add(arrays, &(struct server_array){.name = name,
                                                     .type = SERVER_ARRAY_NUMBERS,
                                                     .columns = columns,
                                                     .rows = rows,
                                                     .source = numbers});
}

void server_arrays_add_indices(struct server_arrays *arrays, const char *name, uint32_t columns,
                               uint64_t rows, const uint32_t *indices)
{
    server_arrays_add(arrays, &(struct server_array){.name = name,
                                                     .type = SERVER_ARRAY_INDICES,
                                                     .columns = columns,
                                                     .rows = rows,
                                                     .source = indices});
}

void server_arrays_add_member(struct server_arrays *arrays, const char *name, uint64_t rows,
                              const double *first, size_t stride)
{
    server_arrays_add_numbers(arrays, name, 0, rows, first);
    arrays->list[arrays->count - 1].stride = stride;
}

static uint64_t array_numbers(const struct server_array *array)
{
    return array->rows * (array->columns ? array->columns : 1);
}

/* --- polylines -------------------------------------------------------------------------------- */

static const struct gd_path *lines_path(const struct server_lines *lines, uint32_t line)
{
    return (const struct gd_path *)((const char *)lines->paths + line * lines->stride);
}

bool server_lines_count(struct server_lines *lines)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < lines->count; i++) {
        lines->first[i] = (uint32_t)sum;
        sum += lines_path(lines, i)->count;
        if (sum > UINT32_MAX) return false;
    }
    lines->first[lines->count] = (uint32_t)sum;
    return true;
}

static uint32_t lines_find(const struct server_lines *lines, uint32_t point)
{
    uint32_t low = 0, high = lines->count - 1;
    while (low < high) {
        uint32_t middle = low + (high - low + 1) / 2;
        if (lines->first[middle] <= point)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

static void lines_read(const void *source, uint64_t first, uint64_t count, void *out)
{
    const struct server_lines *lines = source;
    double(*at)[3] = out;
    uint32_t point = (uint32_t)first, end = (uint32_t)(first + count);
    for (uint32_t line = lines_find(lines, point); point < end; line++) {
        uint32_t stop = lines->first[line + 1] < end ? lines->first[line + 1] : end;
        if (stop == point) continue;
        const struct gd_point *points = lines_path(lines, line)->points;
        gd_points_positions(lines->mesh, points + (point - lines->first[line]), stop - point, at);
        at += stop - point;
        point = stop;
    }
}

static size_t type_bytes(enum server_array_type type)
{
    return type == SERVER_ARRAY_NUMBERS ? sizeof(double) : sizeof(uint32_t);
}

/* Copies rows of an array of doubles or indices. Without rows, nothing is read: lines_find needs a
 * line. */
static void rows_copy(const struct server_array *array, uint64_t first, uint64_t count, void *out)
{
    if (!count) return;
    size_t row = (array->columns ? array->columns : 1) * type_bytes(array->type),
           stride = array->stride ? array->stride : row;
    const char *from = (const char *)array->source + first * stride;
    if (array->read)
        array->read(array->source, first, count, out);
    else
        for (uint64_t i = 0; i < count; i++) memcpy((char *)out + i * row, from + i * stride, row);
}

void server_array_copy(const struct server_array *array, void *out)
{
    rows_copy(array, 0, array->rows, out);
}

union room {
    double numbers[PIECE], triples[PIECE / 3][3];
    uint32_t indices[PIECE];
};

/* Writes rows that are in `room`. */
static void rows_encode(const struct server_array *array, const union room *room, uint64_t count,
                        struct proto_writer *writer)
{
    uint32_t columns = array->columns;
    if (columns == 3) {
        proto_write_triples(writer, room->triples, count);
        return;
    }
    for (uint64_t i = 0; i < count; i++)
        if (array->type == SERVER_ARRAY_INDICES)
            proto_write_uint(writer, room->indices[i]);
        else if (!columns)
            proto_write_number(writer, room->numbers[i]);
        else
            proto_write_numbers(writer, room->numbers + i * columns, columns);
}

void server_array_encode(const struct server_array *array, struct proto_writer *writer)
{
    union room room;
    uint64_t step = PIECE / (array->columns ? array->columns : 1);
    proto_write_array_begin(writer);
    for (uint64_t i = 0; i < array->rows && !writer->failure; i += step) {
        uint64_t count = array->rows - i < step ? array->rows - i : step;
        rows_copy(array, i, count, &room);
        rows_encode(array, &room, count, writer);
    }
    proto_write_array_end(writer);
}

void server_arrays_add_lines(struct server_arrays *arrays, const struct server_lines *lines)
{
    server_arrays_add_named_lines(arrays, lines, "points", "first");
}

void server_arrays_add_named_lines(struct server_arrays *arrays, const struct server_lines *lines,
                                   const char *points, const char *first)
{
    server_arrays_add(arrays, &(struct server_array){.name = points,
                                                     .type = SERVER_ARRAY_NUMBERS,
                                                     .columns = 3,
                                                     .rows = lines->first[lines->count],
                                                     .read = lines_read,
                                                     .source = lines});
    server_arrays_add_indices(arrays, first, 0, lines->count + UINT64_C(1), lines->first);
}

/* --- numbers as bytes ------------------------------------------------------------------------- */

static void put16(unsigned char **at, uint16_t value)
{
    value = htole16(value);
    memcpy(*at, &value, sizeof value);
    *at += sizeof value;
}

static void put32(unsigned char **at, uint32_t value)
{
    value = htole32(value);
    memcpy(*at, &value, sizeof value);
    *at += sizeof value;
}

static void put64(unsigned char **at, uint64_t value)
{
    value = htole64(value);
    memcpy(*at, &value, sizeof value);
    *at += sizeof value;
}

static uint32_t get32(const unsigned char *at)
{
    uint32_t value;
    memcpy(&value, at, sizeof value);
    return le32toh(value);
}

static uint64_t get64(const unsigned char *at)
{
    uint64_t value;
    memcpy(&value, at, sizeof value);
    return le64toh(value);
}

static enum server_array_type written_type(const struct server_array *array,
                                           enum server_arrays_form form)
{
    return array->type == SERVER_ARRAY_NUMBERS && form == SERVER_ARRAYS_F32 ? SERVER_ARRAY_FLOATS
                                                                            : array->type;
}

static uint64_t array_bytes(const struct server_array *array, enum server_arrays_form form)
{
    return array_numbers(array) * type_bytes(written_type(array, form));
}

struct crc_writer {
    struct proto_writer *writer;
    uint32_t crc;
};

static void crc_append(struct crc_writer *out, const void *bytes, size_t size)
{
    out->crc = server_crc32(out->crc, bytes, size);
    proto_append(out->writer, bytes, size);
}

/* Converts numbers. Those that JSON writes as null become NaN. */
static size_t numbers_convert(const double *numbers, size_t count, enum server_array_type type,
                              unsigned char *out)
{
    unsigned char *at = out;
    for (size_t i = 0; i < count; i++) {
        double value = isfinite(numbers[i]) ? numbers[i] : NAN;
        if (type == SERVER_ARRAY_FLOATS) {
            float narrow = (float)value;
            uint32_t bits;
            memcpy(&bits, &narrow, sizeof bits);
            put32(&at, bits);
        } else {
            uint64_t bits;
            memcpy(&bits, &value, sizeof bits);
            put64(&at, bits);
        }
    }
    return (size_t)(at - out);
}

static size_t indices_convert(const uint32_t *indices, size_t count, unsigned char *out)
{
    unsigned char *at = out;
    for (size_t i = 0; i < count; i++) put32(&at, indices[i]);
    return (size_t)(at - out);
}

static void array_write(const struct server_array *array, enum server_arrays_form form,
                        struct crc_writer *out)
{
    union room room;
    unsigned char bytes[PIECE * sizeof(double)];
    enum server_array_type type = written_type(array, form);
    uint32_t columns = array->columns ? array->columns : 1;
    uint64_t total = array_numbers(array), step = columns < PIECE ? PIECE - PIECE % columns : PIECE;
    bool is_index = type == SERVER_ARRAY_INDICES, is_copied = array->read || array->stride;
    for (uint64_t i = 0; i < total && !out->writer->failure; i += step) {
        uint64_t count = total - i < step ? total - i : step;
        const double *numbers = is_copied ? room.numbers : (const double *)array->source + i;
        const uint32_t *indices = is_copied ? room.indices : (const uint32_t *)array->source + i;
        if (is_copied) rows_copy(array, i / columns, count / columns, &room);
        crc_append(out, bytes,
                   is_index ? indices_convert(indices, count, bytes)
                            : numbers_convert(numbers, count, type, bytes));
    }
}

/* --- the container ---------------------------------------------------------------------------- */

static uint64_t padded(uint64_t size)
{
    return (size + 7) / 8 * 8;
}

static void container_write(const struct server_arrays *arrays, enum server_arrays_form form,
                            struct proto_writer *writer)
{
    static const char zeros[8] = {0};
    unsigned char head[HEAD_BYTES + SERVER_ARRAYS_MOST * ENTRY_BYTES] = MAGIC;
    unsigned char *at = head + strlen(MAGIC);
    uint64_t offset = HEAD_BYTES + arrays->count * ENTRY_BYTES;
    struct crc_writer out = {.writer = writer};
    put32(&at, VERSION);
    put32(&at, arrays->count);
    for (uint32_t i = 0; i < arrays->count; i++) {
        const struct server_array *array = &arrays->list[i];
        uint64_t bytes = array_bytes(array, form);
        snprintf((char *)at, NAME_BYTES, "%s", array->name);
        at += NAME_BYTES;
        put32(&at, written_type(array, form));
        put32(&at, array->columns);
        put64(&at, array->rows);
        put64(&at, offset);
        put64(&at, bytes);
        offset += padded(bytes);
    }
    proto_append(writer, (const char *)head, (size_t)(at - head));
    for (uint32_t i = 0; i < arrays->count; i++) {
        uint64_t bytes = array_bytes(&arrays->list[i], form);
        array_write(&arrays->list[i], form, &out);
        proto_append(writer, zeros, padded(bytes) - bytes);
    }
}

/* --- npy and npz ------------------------------------------------------------------------------ */

#define NPY_HEAD 128 /* bytes of the head: a multiple of 64 in which the longest shape has room */

/* Writes format 1.0 of NumPy's `numpy.lib.format`. */
static void npy_write(const struct server_array *array, struct crc_writer *out)
{
    unsigned char head[NPY_HEAD] = "\x93NUMPY\x01\x00", *at = head + 8;
    char *text = (char *)head + 10, shape[64];
    put16(&at, NPY_HEAD - 10);
    snprintf(shape, sizeof shape, array->columns ? "%llu, %u" : "%llu,",
             (unsigned long long)array->rows, array->columns);
    int size =
        snprintf(text, NPY_HEAD - 10, "{'descr': '%s', 'fortran_order': False, 'shape': (%s), }",
                 array->type == SERVER_ARRAY_INDICES ? "<u4" : "<f8", shape);
    memset(text + size, ' ', NPY_HEAD - 10 - (size_t)size);
    head[NPY_HEAD - 1] = '\n';
    crc_append(out, head, NPY_HEAD);
    array_write(array, SERVER_ARRAYS_NPY, out);
}

#define ZIP_LOCAL       0x04034b50
#define ZIP_DESCRIPTOR  0x08074b50
#define ZIP_CENTRAL     0x02014b50
#define ZIP_END         0x06054b50
#define ZIP_VERSION     20
#define ZIP_SUMS_BEHIND 8    /* flag: the data descriptor has sum and sizes */
#define ZIP_DAY         0x21 /* 1980-01-01 */
#define ZIP_NAME        (NAME_BYTES + 4)
#define ZIP_HEAD        64

struct zip_entry {
    char name[ZIP_NAME];
    uint32_t crc, size, offset;
};

/* Writes the fields that both heads of an entry share. */
static void zip_put_facts(unsigned char **at, const struct zip_entry *entry, uint16_t flags)
{
    put16(at, ZIP_VERSION);
    put16(at, flags);
    put16(at, 0); /* stored */
    put16(at, 0); /* midnight */
    put16(at, ZIP_DAY);
    put32(at, entry->crc);
    put32(at, entry->size);
    put32(at, entry->size);
    put16(at, (uint16_t)strlen(entry->name));
    put16(at, 0);
}

static void zip_append(struct proto_writer *writer, unsigned char *head, unsigned char *end)
{
    proto_append(writer, (const char *)head, (size_t)(end - head));
}

static void zip_write_entry(struct zip_entry *entry, const struct server_array *array,
                            struct proto_writer *writer)
{
    struct crc_writer out = {.writer = writer};
    unsigned char head[ZIP_HEAD], *at = head;
    snprintf(entry->name, sizeof entry->name, "%s.npy", array->name);
    entry->size = NPY_HEAD + (uint32_t)array_bytes(array, SERVER_ARRAYS_NPZ);
    put32(&at, ZIP_LOCAL);
    /* readers of a stream find the sizes in this head, and the checksum in the descriptor */
    zip_put_facts(&at, entry, ZIP_SUMS_BEHIND);
    zip_append(writer, head, at);
    proto_append(writer, entry->name, strlen(entry->name));
    npy_write(array, &out);
    entry->crc = out.crc;
    at = head;
    put32(&at, ZIP_DESCRIPTOR);
    put32(&at, entry->crc);
    put32(&at, entry->size);
    put32(&at, entry->size);
    zip_append(writer, head, at);
}

static void zip_write_central(const struct zip_entry *entry, struct proto_writer *writer)
{
    unsigned char head[ZIP_HEAD], *at = head;
    put32(&at, ZIP_CENTRAL);
    put16(&at, ZIP_VERSION);
    zip_put_facts(&at, entry, ZIP_SUMS_BEHIND);
    put16(&at, 0); /* length of the comment */
    put16(&at, 0); /* disk */
    put16(&at, 0); /* attributes */
    put32(&at, 0);
    put32(&at, entry->offset);
    zip_append(writer, head, at);
    proto_append(writer, entry->name, strlen(entry->name));
}

/* Writes the archive. Fails at 4 GiB, which is four times the default limit of answers. */
static void npz_write(const struct server_arrays *arrays, struct proto_writer *writer)
{
    struct zip_entry entries[SERVER_ARRAYS_MOST] = {0};
    size_t begun = writer->flushed + writer->size;
    uint64_t sum = 0;
    for (uint32_t i = 0; i < arrays->count; i++)
        sum += array_bytes(&arrays->list[i], SERVER_ARRAYS_NPZ) + NPY_HEAD + 4 * ZIP_HEAD;
    if (sum > UINT32_MAX) {
        writer->failure = PROTO_WRITER_TOO_LARGE;
        return;
    }
    for (uint32_t i = 0; i < arrays->count; i++) {
        entries[i].offset = (uint32_t)(writer->flushed + writer->size - begun);
        zip_write_entry(&entries[i], &arrays->list[i], writer);
    }
    uint32_t central = (uint32_t)(writer->flushed + writer->size - begun);
    for (uint32_t i = 0; i < arrays->count; i++) zip_write_central(&entries[i], writer);
    unsigned char end[ZIP_HEAD], *at = end;
    put32(&at, ZIP_END);
    put32(&at, 0); /* disks */
    put16(&at, (uint16_t)arrays->count);
    put16(&at, (uint16_t)arrays->count);
    put32(&at, (uint32_t)(writer->flushed + writer->size - begun) - central);
    put32(&at, central);
    put16(&at, 0); /* length of the comment */
    zip_append(writer, end, at);
}

void server_arrays_write(const struct server_arrays *arrays, enum server_arrays_form form,
                         struct proto_writer *writer)
{
    struct crc_writer out = {.writer = writer};
    if (form == SERVER_ARRAYS_RAW)
        array_write(&arrays->list[0], SERVER_ARRAYS_F64, &out);
    else if (form == SERVER_ARRAYS_NPY)
        npy_write(&arrays->list[0], &out);
    else if (form == SERVER_ARRAYS_NPZ)
        npz_write(arrays, writer);
    else
        container_write(arrays, form, writer);
}

/* --- reading ---------------------------------------------------------------------------------- */

static bool refuse_bytes(struct proto_problem *problem, const char *why)
{
    return proto_problem_set(
        problem, PROTO_PROBLEM_INVALID_REQUEST,
        "the body is not an arrays container, version 1: %s; see the reference at /docs", why);
}

static bool entry_read(const unsigned char *bytes, size_t size, const unsigned char *entry,
                       const char *const *known, struct server_array *out,
                       struct proto_problem *problem)
{
    char name[NAME_BYTES];
    uint64_t offset = get64(entry + 48), length = get64(entry + 56);
    memcpy(name, entry, sizeof name);
    name[SERVER_ARRAYS_NAME] = '\0';
    while (*known && strcmp(*known, name) != 0) known++;
    if (!*known)
        return proto_problem_set(problem, PROTO_PROBLEM_INVALID_REQUEST,
                                 "there is no array \"%s\" in this request; see the contract",
                                 name);
    *out = (struct server_array){.name = *known,
                                 .type = (enum server_array_type)get32(entry + 32),
                                 .columns = get32(entry + 36),
                                 .rows = get64(entry + 40)};
    if (out->type < SERVER_ARRAY_NUMBERS || out->type > SERVER_ARRAY_INDICES)
        return refuse_bytes(problem, "an array has an unknown type");
    if (offset % 8 || offset > size || length > size - offset)
        return refuse_bytes(
            problem, "an array lies beyond the end or at an offset that is not a multiple of 8");
    if (out->rows > size || out->columns > size ||
        length != array_numbers(out) * type_bytes(out->type))
        return refuse_bytes(problem, "an array's number of bytes does not match its rows and "
                                     "columns");
    out->source = bytes + offset;
    return true;
}

bool server_arrays_read(const void *body, size_t size, const char *const *known,
                        struct server_arrays *out, struct proto_problem *problem)
{
    const unsigned char *bytes = body;
    struct server_arrays arrays = {0};
    if (size < HEAD_BYTES || memcmp(bytes, MAGIC, strlen(MAGIC)) != 0)
        return refuse_bytes(problem, "it does not begin with " MAGIC);
    if (get32(bytes + 8) != VERSION) return refuse_bytes(problem, "it has another version");
    uint32_t count = get32(bytes + 12);
    if (count > SERVER_ARRAYS_MOST) return refuse_bytes(problem, "it has too many arrays");
    if (size < HEAD_BYTES + (size_t)count * ENTRY_BYTES)
        return refuse_bytes(problem, "it ends within its head");
    for (uint32_t i = 0; i < count; i++) {
        struct server_array array;
        if (!entry_read(bytes, size, bytes + HEAD_BYTES + (size_t)i * ENTRY_BYTES, known, &array,
                        problem))
            return false;
        if (server_arrays_find(&arrays, array.name))
            return refuse_bytes(problem, "an array stands twice");
        server_arrays_add(&arrays, &array);
    }
    *out = arrays;
    return true;
}

const struct server_array *server_arrays_find(const struct server_arrays *arrays, const char *name)
{
    for (uint32_t i = 0; i < arrays->count; i++)
        if (strcmp(arrays->list[i].name, name) == 0) return &arrays->list[i];
    return NULL;
}

double server_array_number(const struct server_array *array, uint64_t index)
{
    const unsigned char *bytes = array->source;
    if (array->type == SERVER_ARRAY_FLOATS) {
        uint32_t bits = get32(bytes + 4 * index);
        float value;
        memcpy(&value, &bits, sizeof value);
        return value;
    }
    uint64_t bits = get64(bytes + 8 * index);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

uint32_t server_array_index(const struct server_array *array, uint64_t index)
{
    return get32((const unsigned char *)array->source + 4 * index);
}
