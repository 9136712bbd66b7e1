#include "support.h"

#include <string.h>

#include "proto/values/bulk_points.h"
#include "proto/values/point.h"

static const char *const names[] = {"from", "to", NULL};

static struct proto_bulk_text text_of(const char *text)
{
    return (struct proto_bulk_text){text, text + strlen(text)};
}

/* Reads a list in pieces of at most `most` points. Returns the number of points, or 0 if the text
 * is not in the plain form that this reader supports. */
static uint32_t read_list(struct proto_bulk_text *text, uint32_t most, struct proto_point *out)
{
    uint32_t count = 0;
    bool is_last = false;
    while (!is_last) {
        struct proto_bulk_text piece;
        uint32_t some = proto_bulk_split(text, most, &piece, &is_last);
        if (!some) return 0;
        for (uint32_t i = 0; i < some; i++)
            if (!proto_bulk_point(&piece, &out[count++])) return 0;
        if (piece.at != piece.end) return 0;
    }
    return count;
}

/* Returns whether the reader reads a text that has the single list `from`. */
static bool reads(const char *text, struct proto_point *out)
{
    struct proto_bulk_text rest = text_of(text);
    return proto_bulk_open(&rest, names, true) == 0 && read_list(&rest, 2, out) > 0 &&
           proto_bulk_end(&rest);
}

static void test_points_are_those_of_the_document(void **state)
{
    (void)state;
    static const char list[] =
        "[{\"vertex\":12},\t{ \"vertex\" : 0 }, {\"face\": 4294967294,\n\"barycentric\": "
        "[0.2, 0.30000000000000004,5E-1]},{\"xyz\":[-1e-3,-0,123456789.0123456789]}]";
    struct proto_point read[8], wanted;
    struct proto_problem problem;
    char text[400];
    for (uint32_t most = 1; most < 6; most++) {
        struct proto_bulk_text rest;
        snprintf(text, sizeof text, " {\"to\":%s ,\"from\": %s} \n", list, list);
        rest = text_of(text);
        assert_int_equal(proto_bulk_open(&rest, names, true), 1);
        assert_int_equal(read_list(&rest, most, read), 4);
        assert_int_equal(proto_bulk_open(&rest, names, false), 0);
        assert_int_equal(read_list(&rest, most, read + 4), 4);
        assert_true(proto_bulk_end(&rest));
    }
    json_t *document = proto_decode_document(list, strlen(list), &problem);
    for (size_t i = 0; i < 8; i++) {
        assert_true(proto_point_decode(json_array_get(document, i % 4), "", &wanted, &problem));
        assert_int_equal(read[i].form, wanted.form);
        if (wanted.form == PROTO_POINT_VERTEX) assert_int_equal(read[i].vertex, wanted.vertex);
        if (wanted.form == PROTO_POINT_FACE) {
            assert_int_equal(read[i].face, wanted.face);
            assert_memory_equal(read[i].barycentric, wanted.barycentric, sizeof wanted.barycentric);
        }
        if (wanted.form == PROTO_POINT_XYZ)
            assert_memory_equal(read[i].xyz, wanted.xyz, sizeof wanted.xyz);
    }
    json_decref(document);
}

static void test_other_texts_are_left_to_the_document(void **state)
{
    (void)state;
    static const char *const others[] = {
        "",
        "{",
        "[]",
        "{}",
        "{\"from\":",
        "{\"from\":[]}",
        "{\"from\":[",
        "{\"from\":[{\"vertex\":1}",
        "{\"from\":[{\"vertex\":1}]",
        "{\"from\":[{\"vertex\":1}]} 1",
        "{\"from\":[{\"vertex\":1},]}",
        "{\"from\":[{\"vertex\":1} {\"vertex\":1}]}",
        "{\"from\":[{\"vertex\":01}]}",
        "{\"from\":[{\"vertex\":-1}]}",
        "{\"from\":[{\"vertex\":1.5}]}",
        "{\"from\":[{\"vertex\":4294967295}]}",
        "{\"from\":[{\"vertex\":99999999999}]}",
        "{\"from\":[{\"vertex\":\"1\"}]}",
        "{\"from\":[{\"vertex\":1,\"vertex\":2}]}",
        "{\"from\":[{\"vertex\":1}, \"v:1\"]}",
        "{\"from\":[{\"vertices\":1}]}",
        "{\"from\":[{\"face\":1,\"barycentric\":[0.2,0.3]}]}",
        "{\"from\":[{\"face\":1,\"barycentric\":[0.2,0.3,.5]}]}",
        "{\"from\":[{\"face\":1,\"barycentric\":[0.2,0.3,5.]}]}",
        "{\"from\":[{\"face\":1,\"barycentric\":[0.2,0.3,+0.5]}]}",
        "{\"from\":[{\"face\":1,\"barycentric\":[0.2,0.3,0.5,0]}]}",
        "{\"from\":[{\"face\":1,\"barycentric\":[0.2,0.3,1e400]}]}",
        "{\"from\":[{\"face\":1,\"barycentric\":[0.2,0.3,inf]}]}",
        "{\"from\":[{\"face\":1,\"barycentric\":[0.2,0.3,0x1]}]}",
        "{\"from\":[{\"face\":1}]}",
        "{\"from\":[{\"xyz\":[1,2,3],\"max_snap\":1}]}",
        "{\"from\":[{\"xyz\":[1,2,3]]}",
    };
    struct proto_point read[8];
    assert_true(reads("{\"from\":[{\"vertex\":1}]}", read));
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (reads(others[i], read)) fail_msg("%s", others[i]);
}

/* The reader must not look beyond the end of the text. */
static void test_texts_that_end_early(void **state)
{
    (void)state;
    static const char whole[] = "{\"from\":[{\"face\":12,\"barycentric\":[-1e-3,2E+1,0.5]}]}";
    struct proto_point read[8];
    assert_true(reads(whole, read));
    for (size_t size = 0; size < sizeof whole - 1; size++) {
        char *text = malloc(size + 1); /* AddressSanitizer detects reads beyond it */
        memcpy(text, whole, size);
        struct proto_bulk_text rest = {text, text + size};
        assert_false(proto_bulk_open(&rest, names, true) == 0 && read_list(&rest, 2, read) > 0 &&
                     proto_bulk_end(&rest));
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points_are_those_of_the_document),
        cmocka_unit_test(test_other_texts_are_left_to_the_document),
        cmocka_unit_test(test_texts_that_end_early),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
