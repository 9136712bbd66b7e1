#include "support.h"

#include "proto/queries/curves.h"

DECODER(decode, struct proto_cut_request, proto_cut_request_decode)

#define CURVE "\"curve\":{\"boundary\":0}"

static void takes_all_members(void **state)
{
    (void)state;
    struct proto_problem problem;
    struct proto_cut_request cut;
    assert_true(
        decode("{" CURVE ",\"inside\":{\"vertex\":2},\"names\":[\"a\",\"b.c\"]}", &cut, &problem));
    assert_true(cut.has_inside && !cut.select_only);
    assert_int_equal(cut.inside.vertex, 2);
    assert_int_equal(cut.names.count, 2);
    assert_string_equal(cut.names.items[1].text, "b.c");
    proto_cut_request_free(&cut);
    proto_cut_request_free(&cut);
    assert_true(decode("{" CURVE ",\"select_only\":true}", &cut, &problem));
    assert_true(cut.select_only && !cut.has_inside && !cut.names.count);
    proto_cut_request_free(&cut);
}

static void refuses_invalid_cuts(void **state)
{
    (void)state;
    static const struct {
        const char *text, *pointer;
    } wrong[] = {
        {"{}", "/curve"},
        {"{" CURVE ",\"name\":\"a\"}", "/name"},
        {"{" CURVE ",\"inside\":{}}", "/inside"},
        {"{" CURVE ",\"select_only\":1}", "/select_only"},
        {"{" CURVE ",\"names\":[]}", "/names"},
        {"{" CURVE ",\"names\":{\"a\":1}}", "/names"},
        {"{" CURVE ",\"names\":[\"a\",\"\"]}", "/names/1"},
        {"{" CURVE ",\"names\":[\"a\"],\"select_only\":true}", "/names"},
    };
    for (size_t i = 0; i < COUNT(wrong); i++) {
        struct proto_problem problem;
        struct proto_cut_request cut;
        assert_false(decode(wrong[i].text, &cut, &problem));
        assert_int_equal(problem.code, PROTO_PROBLEM_INVALID_REQUEST);
        assert_string_equal(problem.pointer, wrong[i].pointer);
    }
}

/* Checks the text of a cut of one piece with these fields. */
static void check_text(uint32_t fields, const char *name, const char *expected)
{
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    uint32_t corners[] = {0, 1, 2}, vertex_map[] = {4, 7, GD_NONE}, face_map[] = {9};
    struct gd_cut_piece piece = {
        .polygons = {.positions = positions, .position_count = 3, .corners = corners},
        .vertex_map = vertex_map,
        .face_map = face_map,
        .face_count = 1,
        .area = 0.5};
    const struct gd_cut cut = {
        .separates = true, .piece_count = 1, .pieces = &piece, .largest_shift = 0.25};
    struct proto_writer writer;
    proto_writer_init(&writer, 4096);
    proto_cut_begin(&writer, &cut, fields);
    proto_cut_piece_encode(&writer, &piece, name, fields);
    proto_cut_end(&writer, &cut, fields);
    assert_written(&writer, expected);
}

static void writes_selected_fields(void **state)
{
    (void)state;
    check_text(PROTO_CUT_FIELD_ALL, "p",
               "{\"separates\":true,\"pieces\":[{\"name\":\"p\",\"vertices\":3,\"faces\":1,"
               "\"area\":0.5,\"vertex_map\":[4,7,"
               "null],\"face_map\":[9]}],\"largest_shift\":0.25}");
    check_text(PROTO_CUT_FIELD_ALL, NULL,
               "{\"separates\":true,\"pieces\":[{\"faces\":1,\"area\":0.5,\"face_map\":[9]}],"
               "\"largest_shift\":0.25}");
    check_text(PROTO_CUT_FIELD_NAME | PROTO_CUT_FIELD_AREA, "p",
               "{\"pieces\":[{\"name\":\"p\",\"area\":0.5}]}");
    check_text(PROTO_CUT_FIELD_PIECES, NULL,
               "{\"pieces\":[{\"faces\":1,\"area\":0.5,\"face_map\":[9]}]}");
    check_text(PROTO_CUT_FIELD_LARGEST_SHIFT, "p", "{\"largest_shift\":0.25}");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(takes_all_members),
        cmocka_unit_test(refuses_invalid_cuts),
        cmocka_unit_test(writes_selected_fields),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
