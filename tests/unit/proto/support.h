/* Helpers of the tests of proto: query strings, checks of written text and of problems, and a
 * mesh. */
#pragma once

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "gd/mesh.h"
#include "generated/requests.h"
#include "proto/json/decode.h"
#include "proto/http/options.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

/* Options that select these fields of an answer. */
#define FIELDS(answer, bits)                                                                       \
    &(const struct proto_options)                                                                  \
    {                                                                                              \
        .fields = (bits), .names = proto_##answer##_fields                                         \
    }

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* --- query string: names and values in turn, NULL at the end ---------------------------------- */

static inline struct proto_parameters query_of(const char *const *pairs)
{
    uint32_t count = 0;
    while (pairs[2 * count]) count++;
    return (struct proto_parameters){(const struct proto_parameter *)pairs, count};
}

#define QUERY(...) query_of((const char *const[]){__VA_ARGS__, NULL})
#define NO_QUERY   query_of((const char *const[]){NULL})

/* --- bodies ----------------------------------------------------------------------------------- */

/* Parses a document. The caller releases it by json_decref. */
static inline json_t *parse(const char *text)
{
    struct proto_problem problem;
    json_t *document = proto_decode_document(text, strlen(text), &problem);
    assert_non_null(document);
    return document;
}

/* Defines a function `name` that parses a text and decodes the document by `decode`. */
#define DECODER(name, type, decode)                                                                \
    static bool name(const char *text, type *out, struct proto_problem *problem)                   \
    {                                                                                              \
        json_t *document = parse(text);                                                            \
        bool decoded = decode(document, out, problem);                                             \
        json_decref(document);                                                                     \
        return decoded;                                                                            \
    }

/* --- results ---------------------------------------------------------------------------------- */

/* Checks that the writer holds exactly `expected`. Frees the writer. */
static inline void assert_written(struct proto_writer *writer, const char *expected)
{
    size_t size = 0;
    char *text = proto_writer_take(writer, &size);
    assert_non_null(text);
    char *copy = test_calloc(size + 1, 1);
    memcpy(copy, text, size);
    free(text);
    assert_string_equal(copy, expected);
    test_free(copy);
    proto_writer_free(writer);
}

static inline struct proto_writer new_writer(void)
{
    struct proto_writer writer;
    proto_writer_init(&writer, 1 << 20);
    return writer;
}

static inline void assert_pointer(const struct proto_problem *problem, const char *pointer)
{
    assert_int_equal(problem->code, PROTO_PROBLEM_INVALID_REQUEST);
    assert_int_equal(problem->status, 400);
    assert_true(problem->has_pointer);
    assert_string_equal(problem->pointer, pointer);
    assert_true(problem->detail[0] != '\0');
}

static inline void assert_parameter(const struct proto_problem *problem, const char *parameter)
{
    assert_int_equal(problem->code, PROTO_PROBLEM_INVALID_REQUEST);
    assert_false(problem->has_pointer);
    assert_string_equal(problem->parameter, parameter);
    assert_true(problem->detail[0] != '\0');
}

/* A body that is refused, and the JSON pointer to the wrong value. */
struct refusal {
    const char *text, *pointer;
};

/* Checks that each body is refused with its pointer. */
#define CHECK_REFUSED(decode, type, cases)                                                         \
    for (size_t i = 0; i < COUNT(cases); i++) {                                                    \
        type decoded;                                                                              \
        struct proto_problem why;                                                                  \
        assert_false(decode(cases[i].text, &decoded, &why));                                       \
        assert_pointer(&why, cases[i].pointer);                                                    \
    }

/* --- mesh ------------------------------------------------------------------------------------- */

/* Builds the example of openapi.yaml: a tetrahedron with right angles at vertex 0. */
static inline struct gd_mesh *new_tetrahedron(void)
{
    static double positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static uint32_t corners[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    const struct gd_polygons polygons = {
        .positions = positions, .position_count = 4, .polygon_count = 4, .corners = corners};
    struct gd_mesh *mesh = NULL;
    assert_int_equal(gd_mesh_build(&polygons, NULL, NULL, &mesh, NULL), GD_OK);
    return mesh;
}
