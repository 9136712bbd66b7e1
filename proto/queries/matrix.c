#include "proto/json/writer.h"
#include "proto/queries/matrix.h"

#include <math.h>

#include "proto/queries/evaluation.h"

bool proto_matrix_check(const struct proto_matrix_request *request, struct proto_problem *problem)
{
    uint64_t entries = (uint64_t)request->sources.count * request->targets.count;
    if (entries <= PROTO_MATRIX_ENTRIES) return true;
    return proto_problem_exceed(
        problem, "", PROTO_MATRIX_ENTRIES,
        "%u sources and %u targets make %llu distances, more than %d; ask for the matrix in parts",
        request->sources.count, request->targets.count, (unsigned long long)entries,
        PROTO_MATRIX_ENTRIES);
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
    proto_member_array(writer, key);
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
