#include "tests/unit/io/reading.h"

static void knows_names(void **state)
{
    (void)state;
    assert_int_equal(gd_format_by_name("obj"), GD_FORMAT_OBJ);
    assert_int_equal(gd_format_by_name("json"), GD_FORMAT_JSON);
    assert_int_equal(gd_format_by_name("gltf"), GD_FORMAT_GLTF);
    assert_int_equal(gd_format_by_name("3mf"), GD_FORMAT_3MF);
    static const char *const unknown[] = {"", "OBJ", "any", "objx", "3MF"};
    for (size_t i = 0; i < COUNT_OF(unknown); i++)
        assert_int_equal(gd_format_by_name(unknown[i]), GD_FORMAT_ANY);
    assert_int_equal(gd_format_by_name(NULL), GD_FORMAT_ANY);
    for (enum gd_format format = GD_FORMAT_OBJ; format <= GD_FORMAT_3MF; format++) {
        assert_int_equal(gd_format_by_name(gd_format_name(format)), format);
        assert_int_equal(gd_format_by_media_type(gd_format_media_type(format)), format);
    }
    assert_string_equal(gd_format_name(GD_FORMAT_ANY), "any");
    assert_string_equal(gd_format_media_type(GD_FORMAT_ANY), "application/octet-stream");
}

static void knows_media_types(void **state)
{
    (void)state;
    assert_int_equal(gd_format_by_media_type("model/obj"), GD_FORMAT_OBJ);
    assert_int_equal(gd_format_by_media_type("MODEL/Stl; charset=utf-8"), GD_FORMAT_STL);
    assert_int_equal(gd_format_by_media_type(" application/json ; a=b"), GD_FORMAT_JSON);
    static const char *const unknown[] = {"",         ";",          "model/",     "model/objx",
                                          "model/ob", "text/plain", "x model/obj"};
    for (size_t i = 0; i < COUNT_OF(unknown); i++)
        assert_int_equal(gd_format_by_media_type(unknown[i]), GD_FORMAT_ANY);
    assert_int_equal(gd_format_by_media_type(NULL), GD_FORMAT_ANY);
}

#define ZERO_20   "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"
#define SPACES_20 "                    "

static void recognises_content(void **state)
{
    (void)state;
    static const struct {
        const char *bytes;
        size_t size;
        enum gd_format format;
    } cases[] = {
        {BYTES("v 0 0 0\n"), GD_FORMAT_OBJ},
        {BYTES("\n# comment\r\n\r\n  mtllib x.mtl\n"), GD_FORMAT_OBJ},
        {BYTES("\xEF\xBB\xBFo thing\n"), GD_FORMAT_OBJ},
        {BYTES("f 1 2 3\n"), GD_FORMAT_OBJ},
        {BYTES("# cow\n$ by ftp\n\nother words\n  v 1 -2.5 3e0 1\n"), GD_FORMAT_OBJ},
        {BYTES("# cow\n$ by ftp\nv 1 two 3\nv 1 2\nvertex 1 2 3\n"), GD_FORMAT_ANY},
        {BYTES("\xFF\xFEv\0 \0"), GD_FORMAT_OBJ},
        {BYTES("\xFE\xFF\0O\0F\0F\0\r\0\n"), GD_FORMAT_OFF},
        {BYTES("\xFE\xFF\0h\0i"), GD_FORMAT_ANY},
        {BYTES("\xFE\xFF"), GD_FORMAT_ANY},
        {BYTES("\xFF\xFE" ZERO_20 ZERO_20 ZERO_20 SPACES_20 "\0\0"), GD_FORMAT_ANY},
        {BYTES(" \n  OFF3 1 0\n"), GD_FORMAT_OFF},
        {BYTES("ply\nformat"), GD_FORMAT_PLY},
        {BYTES("ply\r\n"), GD_FORMAT_PLY},
        {BYTES("OFF\n1 2 3"), GD_FORMAT_OFF},
        {BYTES("# comment\nSTCN4nOFF 3 1 0\n"), GD_FORMAT_OFF},
        {BYTES("OFF BINARY\n"), GD_FORMAT_OFF},
        {BYTES(" \n{\"faces\""), GD_FORMAT_JSON},
        {BYTES("{\"vertices\":["), GD_FORMAT_JSON},
        {BYTES("{\"asset\":{"), GD_FORMAT_GLTF},
        {BYTES("\r\n {\t\"extensionsUsed\" :"), GD_FORMAT_GLTF},
        {BYTES("{\"\\u0061sset\":{"), GD_FORMAT_GLTF},
        {BYTES("{\"assets\":{"), GD_FORMAT_JSON},
        {BYTES("{\"asset"), GD_FORMAT_JSON},
        {BYTES("glTF\2\0\0\0"), GD_FORMAT_GLB},
        {BYTES("glTF"), GD_FORMAT_GLB},
        {BYTES("glT"), GD_FORMAT_ANY},
        {BYTES("PK\3\4\24\0"), GD_FORMAT_3MF},
        {BYTES("PK\5\6"), GD_FORMAT_ANY},
        {BYTES("solid\nfacet"), GD_FORMAT_STL},
        {BYTES("  Solid x\n"), GD_FORMAT_STL},
        {BYTES(ZERO_20 ZERO_20 ZERO_20 ZERO_20 "\0\0\0\0"), GD_FORMAT_STL},
        {BYTES(ZERO_20 ZERO_20 ZERO_20 ZERO_20 "\0\0\0\0\0"), GD_FORMAT_ANY},
        {BYTES("v 0 0 0             " SPACES_20 SPACES_20 SPACES_20 "\1\0\0\0" ZERO_20 ZERO_20
               "0123456789"),
         GD_FORMAT_STL},
        {BYTES(SPACES_20 SPACES_20 SPACES_20 SPACES_20 "\1\0\0\0" ZERO_20 ZERO_20 "012345678"),
         GD_FORMAT_ANY},
        {BYTES(SPACES_20 SPACES_20 SPACES_20 SPACES_20 "\1\0\0\0" ZERO_20 ZERO_20 ZERO_20 ZERO_20
                                                       "0123456789012345678"),
         GD_FORMAT_STL},
        {BYTES(SPACES_20 SPACES_20 SPACES_20 SPACES_20 "\1\0\0\0" ZERO_20 ZERO_20 ZERO_20 ZERO_20
                                                       "01234567890123456789"),
         GD_FORMAT_ANY},
        {BYTES(""), GD_FORMAT_ANY},
        {BYTES("  \n\n"), GD_FORMAT_ANY},
        {BYTES("# nothing but a comment\n"), GD_FORMAT_ANY},
        {BYTES("hello world\n"), GD_FORMAT_ANY},
        {BYTES("vertex 0 0 0\n"), GD_FORMAT_ANY},
        {BYTES("ply"), GD_FORMAT_ANY},
        {BYTES("plywood\n"), GD_FORMAT_ANY},
        {BYTES("OFFSET\n"), GD_FORMAT_ANY},
        {BYTES("solidity\n"), GD_FORMAT_ANY},
        {BYTES("[[0,0,0]]"), GD_FORMAT_ANY},
        {BYTES("<html>"), GD_FORMAT_ANY},
        {BYTES("\0\0\0\0"), GD_FORMAT_ANY},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        enum gd_format format = gd_format_recognise(cases[i].bytes, cases[i].size);
        if (format != cases[i].format) {
            fail_msg("input %zu is %s, not %s", i, gd_format_name(format),
                     gd_format_name(cases[i].format));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(knows_names),
        cmocka_unit_test(knows_media_types),
        cmocka_unit_test(recognises_content),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
