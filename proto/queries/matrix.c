#include "proto/queries/matrix.h"

#include <endian.h>
#include <math.h>
#include <string.h>

#include "proto/json/decode.h"
#include "proto/queries/evaluation.h"

const char *const proto_matrix_fields[] = {"distances", "reasons", NULL};

/* --- the request ------------------------------------------------------------------------------ */

void proto_matrix_free(struct proto_matrix *matrix)
{
    proto_points_free(&matrix->sources);
    proto_points_free(&matrix->targets);
}

static bool decode_points(const json_t *document, const char *pointer, struct proto_points *out,
                          struct proto_problem *problem)
{
    const json_t *value = proto_decode_member(document, "", pointer + 1, problem);
    if (!value || !proto_points_decode(out, value, pointer, PROTO_MATRIX_ENTRIES, problem))
        return false;
    return out->count || proto_problem_refuse(problem, pointer, "name at least one point");
}

static bool check_size(const struct proto_matrix *matrix, struct proto_problem *problem)
{
    uint64_t entries = (uint64_t)matrix->sources.count * matrix->targets.count;
    if (entries <= PROTO_MATRIX_ENTRIES) return true;
    proto_problem_set(
        problem, PROTO_PROBLEM_TOO_LARGE,
        "%u sources and %u targets make %llu distances, more than %d; ask for the matrix in parts",
        matrix->sources.count, matrix->targets.count, (unsigned long long)entries,
        PROTO_MATRIX_ENTRIES);
    proto_problem_at(problem, "");
    return proto_problem_limit(problem, PROTO_MATRIX_ENTRIES);
}

static bool decode(const json_t *document, struct proto_matrix *matrix,
                   struct proto_problem *problem)
{
    if (!proto_decode_max_distance(document, &matrix->max_distance, problem)) return false;
    if (!matrix->max_distance) matrix->max_distance = INFINITY;
    return decode_points(document, "/sources", &matrix->sources, problem) &&
           decode_points(document, "/targets", &matrix->targets, problem) &&
           check_size(matrix, problem);
}

bool proto_matrix_decode(const json_t *document, struct proto_matrix *out,
                         struct proto_problem *problem)
{
    static const char *const members[] = {"sources", "targets", "max_distance", NULL};
    struct proto_matrix matrix = {0};
    if (!proto_decode_object(document, "", members, problem)) return false;
    if (decode(document, &matrix, problem)) {
        *out = matrix;
        return true;
    }
    proto_matrix_free(&matrix);
    return false;
}

/* --- the answer ------------------------------------------------------------------------------- */

static bool has_nulls(const struct proto_matrix_answer *answer)
{
    size_t count = (size_t)answer->rows * answer->columns, i = 0;
    while (i < count && isfinite(answer->distances[i])) i++;
    return i < count;
}

static void write_reasons(struct proto_writer *writer, const double *distances, size_t count)
{
    proto_write_array_begin(writer);
    for (size_t i = 0; i < count; i++) {
        if (isfinite(distances[i]))
            proto_write_null(writer);
        else
            proto_write_string(writer, proto_reason(distances[i]));
    }
    proto_write_array_end(writer);
}

static void
write_rows(struct proto_writer *writer, const char *key, const struct proto_matrix_answer *answer,
           void (*write_row)(struct proto_writer *writer, const double *distances, size_t count))
{
    proto_write_key(writer, key);
    proto_write_array_begin(writer);
    for (size_t row = 0; row < answer->rows; row++)
        write_row(writer, answer->distances + row * answer->columns, answer->columns);
    proto_write_array_end(writer);
}

void proto_matrix_encode(struct proto_writer *writer, const struct proto_matrix_answer *answer,
                         const struct proto_options *options)
{
    proto_write_object_begin(writer);
    if (options->fields & PROTO_MATRIX_FIELD_DISTANCES)
        write_rows(writer, "distances", answer, proto_write_numbers);
    if (options->fields && has_nulls(answer)) write_rows(writer, "reasons", answer, write_reasons);
    proto_write_object_end(writer);
}

size_t proto_matrix_bytes(const struct proto_matrix_answer *answer, void *out)
{
    size_t count = (size_t)answer->rows * answer->columns;
    uint64_t *bytes = out;
    for (size_t i = 0; i < count && bytes; i++) {
        double value = isfinite(answer->distances[i]) ? answer->distances[i] : NAN;
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        bytes[i] = htole64(bits);
    }
    return count * sizeof *bytes;
}
