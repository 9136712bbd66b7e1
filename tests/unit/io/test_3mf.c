#include "tests/unit/io/reading.h"
#include "tests/unit/io/zip_text.h"

#define CORE "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
#define MODEL                                                                                      \
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?><model unit=\"millimeter\" xmlns=\"" CORE "\">"
#define VERTICES                                                                                   \
    "<vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>"                 \
    "<vertex x=\"0\" y=\"1\" z=\"0\"/></vertices>"
#define TRIANGLES   "<triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\"/></triangles>"
#define MESH        "<mesh>" VERTICES TRIANGLES "</mesh>"
#define OBJECT(id)  "<object id=\"" id "\" type=\"model\">" MESH "</object>"
#define ITEM(rest)  "<item objectid=" rest "/>"
#define BUILD(what) "<build>" what "</build></model>"
#define ONE         MODEL "<resources>" OBJECT("1") "</resources>" BUILD(ITEM("\"1\""))

#define PRODUCTION "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
#define WITH_PATHS "<model unit=\"centimeter\" xmlns=\"" CORE "\" xmlns:p=\"" PRODUCTION "\">"

#define RELS(target)                                                                               \
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"       \
    "<Relationship Id=\"a\" Type=\"x/thumbnail\" Target=\"/a.png\"/><Relationship Id=\"b\" "       \
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\" Target=\"" target       \
    "\"/></Relationships>"

#define TRIANGLE_MESH "0 0 0; 1 0 0; 0 1 0 | 0 1 2"
#define PART          "3D/3dmodel.model"

struct good_package {
    struct zip_file files[ZIP_FILES];
    const char *mesh;
};

static const struct good_package good[] = {
    {{{PART, ONE}}, TRIANGLE_MESH},
    {{{"_rels/.rels", RELS("/3D/other.model")}, {"3D/other.model", ONE}}, TRIANGLE_MESH},
    {{{"_rels/.rels", RELS("3d/OTHER.model")}, {"3D/other.model", ONE}}, TRIANGLE_MESH},
    /* an item is placed by a quarter turn about z and then a translation */
    {{{PART, MODEL "<resources>" OBJECT("7") "</resources>" BUILD(
                 ITEM("\"7\" transform=\" 0 1 0 -1 0 0\n 0 0 1 5 6 7 \""))}},
     "5 6 7; 5 7 7; 4 6 7 | 0 1 2"},
    /* an item is mirrored, so the face's orientation is reversed */
    {{{PART, MODEL "<resources>" OBJECT("7") "</resources>" BUILD(
                 ITEM("\"7\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\""))}},
     "0 0 0; -1 0 0; 0 1 0 | 0 2 1"},
    /* an item whose object has two components of another object */
    {{{PART, MODEL "<resources>" OBJECT(
                 "1") "<object id=\"2\"><components><component objectid=\"1\"/><component "
                      "objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0 1\"/></components>"
                      "</object></resources>" BUILD(
                          ITEM("\"2\" transform=\"2 0 0 0 2 0 0 0 2 0 0 0\""))}},
     "0 0 0; 2 0 0; 0 2 0; 0 0 2; 2 0 2; 0 2 2 | 0 1 2; 3 4 5"},
    /* the reader ignores supports, objects without an item, and elements of other namespaces */
    {{{PART, "<model xmlns=\"" CORE "\" xmlns:b=\"beams\"><resources><object id=\"3\" "
             "type=\"support\">" MESH "</object>" OBJECT("1") OBJECT(
                 "2") "<object id=\"4\"><mesh>" VERTICES "<b:triangle v1=\"9\"/></mesh></object>"
                      "</resources>" BUILD(ITEM("\"3\"") ITEM("\"1\"") ITEM("\"4\""))}},
     TRIANGLE_MESH},
    /* one prefix belongs to an unknown namespace, and one to the core namespace */
    {{{PART, MODEL
       "<resources><m:colorgroup m:id=\"4\"/>" OBJECT("1") "</resources>" BUILD(ITEM("\"1\""))}},
     TRIANGLE_MESH},
    {{{PART, "<c:model xmlns:c=\"" CORE "\"><c:object id=\"1\"><c:vertex x=\"0\" y=\"0\" z=\"0\"/>"
             "<c:vertex x=\"1\" y=\"0\" z=\"0\"/><c:vertex x=\"0\" y=\"1\" z=\"0\"/>"
             "<vertex/><c:triangle v1=\"0\" v2=\"1\" v3=\"2\"/></c:object>"
             "<c:item objectid=\"1\"/></c:model>"}},
     TRIANGLE_MESH},
    /* the component is in another part, which has another unit */
    {{{PART, WITH_PATHS "<resources><object id=\"1\"><components><component p:path=\"/3D/a.model\" "
                        "objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0 4\"/></components>"
                        "</object></resources>" BUILD(ITEM("\"1\""))},
      {"3D/a.model",
       "<model unit=\"meter\" xmlns=\"" CORE "\"><resources>" OBJECT("1") "</resources></model>"}},
     "0 0 4; 100 0 4; 0 100 4 | 0 1 2"},
};

struct bad_package {
    struct zip_file files[ZIP_FILES];
    enum gd_status status;
    uint64_t line;
    const char *says;
};

#define WITH_OBJECT(inner)                                                                         \
    {                                                                                              \
        PART, MODEL "\n<resources>\n" inner "</resources>" BUILD(ITEM("\"1\""))                    \
    }

static const struct bad_package bad[] = {
    {{{"readme.txt", "hello"}}, GD_SYNTAX, 0, "lacks the part '3D/3dmodel.model'"},
    {{{"_rels/.rels", RELS("/../../etc/passwd")}, {PART, ONE}}, GD_SYNTAX, 0, "lacks the part"},
    {{{"_rels/.rels", RELS("http://elsewhere/a.model")}, {PART, ONE}},
     GD_SYNTAX,
     0,
     "lacks the part"},
    {{{"_rels/.rels", "<a>"}, {PART, ONE}},
     GD_SYNTAX,
     1,
     "_rels/.rels, line 1: the XML is not well-formed"},
    {{{PART, "<model"}}, GD_SYNTAX, 1, "the XML is not well-formed"},
    {{{PART, "no XML"}}, GD_SYNTAX, 1, NULL},
    {{{PART, "<!DOCTYPE a [<!ENTITY b \"bbbb\"><!ENTITY c \"&b;&b;&b;&b;\">]>" ONE}},
     GD_UNSUPPORTED,
     1,
     "document type"},
    {{{PART, "<!DOCTYPE model SYSTEM \"file:///etc/passwd\"><model/>"}}, GD_UNSUPPORTED, 1, NULL},
    {{{PART, MODEL "<resources/>" BUILD("")}}, GD_EMPTY, 0, "0 items"},
    {{{PART, MODEL "<resources>" OBJECT("2") "</resources>" BUILD(ITEM("\"1\""))}},
     GD_SYNTAX,
     0,
     "object 1, which the file does not define"},
    {{{PART, MODEL "<resources>" OBJECT("1") OBJECT("1") "</resources>" BUILD(ITEM("\"1\""))}},
     GD_SYNTAX,
     0,
     "object 1 is defined twice"},
    {{{PART, "<model unit=\"cubit\"/>"}}, GD_SYNTAX, 1, "unit"},
    {{WITH_OBJECT("<object id=\"one\"/>")}, GD_SYNTAX, 3, "attribute id"},
    {{WITH_OBJECT("<object id=\"-1\"/>")}, GD_SYNTAX, 3, NULL},
    {{WITH_OBJECT("<object id=\"1\"><mesh><vertex x=\"0\" y=\"0\"/></mesh></object>")},
     GD_SYNTAX,
     3,
     "the attribute z is not a number"},
    {{WITH_OBJECT("<object id=\"1\"><mesh><vertex x=\"0\" y=\"0\" z=\"1e999\"/></mesh></object>")},
     GD_NON_FINITE,
     3,
     "z is not a finite number"},
    {{WITH_OBJECT("<object id=\"1\"><mesh>" VERTICES
                  "<triangle v1=\"0\" v2=\"1\" v3=\"3\"/></mesh></object>")},
     GD_INDEX,
     3,
     "refers to vertex 3, but its object has 3 vertices"},
    {{WITH_OBJECT("<object id=\"1\"><mesh>" VERTICES
                  "<triangle v1=\"0\" v2=\"1\" v3=\"0.5\"/></mesh></object>")},
     GD_SYNTAX,
     3,
     "v3"},
    {{WITH_OBJECT("<object id=\"1\"><components><component objectid=\"1\"/></components>"
                  "</object>")},
     GD_SYNTAX,
     0,
     "not defined before it"},
    {{WITH_OBJECT("<object id=\"1\"><components><component objectid=\"1\" transform=\"1 0 0\"/>"
                  "</components></object>")},
     GD_SYNTAX,
     3,
     "twelve numbers"},
    {{WITH_OBJECT("<object id=\"1\"><components><component objectid=\"1\" "
                  "transform=\"1 0 0 0 1 0 0 0 1 0 0 inf\"/></components></object>")},
     GD_NON_FINITE,
     3,
     NULL},
    {{{PART, WITH_PATHS "<resources><object id=\"1\"><components><component p:path=\"/gone.model\" "
                        "objectid=\"1\"/></components></object></resources>" BUILD(ITEM("\"1\""))}},
     GD_SYNTAX,
     0,
     "lacks the part 'gone.model'"},
};

static enum gd_status read_package(const struct zip_file files[ZIP_FILES], size_t size,
                                   const struct gd_read_options *options, struct gd_polygons *out,
                                   struct gd_detail *detail)
{
    static struct zip_bytes zip;
    zip_write(files, &zip);
    return read_copy(zip.bytes, size < zip.size ? size : zip.size, GD_FORMAT_ANY, options, out,
                     detail);
}

static void reads_packages(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(good); i++) {
        struct gd_polygons polygons;
        struct gd_detail detail = {.text = ""};
        enum gd_status status = read_package(good[i].files, SIZE_MAX, NULL, &polygons, &detail);
        if (status != GD_OK) fail_msg("%zu: %s: %s", i, gd_status_name(status), detail.text);
        char *text = mesh_text(&polygons);
        if (strcmp(text, good[i].mesh) != 0)
            fail_msg("%zu: read '%s', not '%s'", i, text, good[i].mesh);
        free(text);
        gd_polygons_free(&polygons);
    }
}

static void refuses_packages(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        struct gd_polygons untouched = {.position_count = 77}, polygons = untouched;
        struct gd_detail detail = {.text = ""};
        enum gd_status status = read_package(bad[i].files, SIZE_MAX, NULL, &polygons, &detail);
        if (status != bad[i].status)
            fail_msg("%zu: %s ('%s')", i, gd_status_name(status), detail.text);
        assert_memory_equal(&polygons, &untouched, sizeof polygons);
        if (bad[i].line && (detail.total != 1 || detail.elements[0][0] != bad[i].line))
            fail_msg("%zu: '%s'", i, detail.text);
        if (bad[i].says && !strstr(detail.text, bad[i].says))
            fail_msg("%zu: '%s' should say '%s'", i, detail.text, bad[i].says);
    }
}

/* Reads small files in Zip64 format, whose sizes are in extra fields. Checksums are verified
 * too. */
static void reads_zip64(void **state)
{
    (void)state;
    static struct zip_bytes zip = {.is_zip64 = true};
    struct gd_polygons polygons;
    struct gd_detail detail = {.text = ""};
    zip_write(good[1].files, &zip);
    assert_int_equal(read_copy(zip.bytes, zip.size, GD_FORMAT_ANY, NULL, &polygons, &detail),
                     GD_OK);
    char *text = mesh_text(&polygons);
    assert_string_equal(text, good[1].mesh);
    free(text);
    gd_polygons_free(&polygons);
    size_t at = 0;
    while (memcmp(zip.bytes + at, "y=\"1\"", 5)) at++;
    zip.bytes[at + 3] = '2';
    assert_int_not_equal(read_copy(zip.bytes, zip.size, GD_FORMAT_ANY, NULL, &polygons, &detail),
                         GD_OK);
    assert_non_null(strstr(detail.text, "checksum"));
}

/* The reader rejects every truncated archive. Only an archive that lacks at most three bytes may be
 * accepted, because its last field is the length of a comment. */
static void survives_truncation(void **state)
{
    (void)state;
    static struct zip_bytes zip;
    zip_write(good[1].files, &zip);
    for (size_t size = 0; size < zip.size; size++) {
        struct gd_polygons polygons = {0};
        struct gd_detail detail = {.text = ""};
        enum gd_status status = read_package(good[1].files, size, NULL, &polygons, &detail);
        gd_polygons_free(&polygons);
        if (status == GD_OK && zip.size - size < 4) continue;
        if (status == GD_OK || status == GD_INTERNAL || detail.text[0] == '\0')
            fail_msg("%zu of %zu bytes: %s '%s'", size, zip.size, gd_status_name(status),
                     detail.text);
    }
}

/* Each object of a chain has two components, which both refer to the previous object. The last
 * object therefore has 2^30 triangles. */
static void bounds_components(void **state)
{
    (void)state;
    static char text[32768];
    size_t size = (size_t)snprintf(text, sizeof text, MODEL "<resources>" OBJECT("1"));
    for (int id = 2; id <= 31; id++)
        size += (size_t)snprintf(text + size, sizeof text - size,
                                 "<object id=\"%d\"><components><component objectid=\"%d\"/>"
                                 "<component objectid=\"%d\"/></components></object>",
                                 id, id - 1, id - 1);
    snprintf(text + size, sizeof text - size, "</resources>" BUILD(ITEM("\"31\"")));
    const struct zip_file files[ZIP_FILES] = {{PART, text}};
    const struct gd_read_options options = {.max_faces = 1 << 20};
    struct gd_polygons polygons;
    struct gd_detail detail;
    assert_int_equal(read_package(files, SIZE_MAX, &options, &polygons, &detail), GD_TOO_LARGE);
    assert_non_null(strstr(detail.text, "1048576 triangles"));
    static struct zip_bytes zip;
    zip_write(files, &zip);
    assert_true(gd_read_cost(zip.bytes, zip.size, NULL) > (size_t)12 << 30);
    assert_true(gd_read_cost(zip.bytes, zip.size, &options) < (size_t)64 << 20);
}

static void bounds_names_and_tags(void **state)
{
    (void)state;
    static char text[60000];
    size_t size = (size_t)snprintf(text, sizeof text, "%s", MODEL);
    for (int depth = 0; depth < 64; depth++) size += (size_t)sprintf(text + size, "<a>");
    const struct zip_file files[ZIP_FILES] = {{PART, text}};
    struct gd_polygons polygons;
    struct gd_detail detail;
    assert_int_equal(read_package(files, SIZE_MAX, NULL, &polygons, &detail), GD_UNSUPPORTED);
    assert_non_null(strstr(detail.text, "nested more than 64 deep"));
}

static void knows_limits(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    const struct zip_file *files = good[5].files; /* six vertices, two triangles */
    const struct gd_read_options vertices = {.max_vertices = 5}, faces = {.max_faces = 1};
    assert_int_equal(read_package(files, SIZE_MAX, &vertices, &polygons, NULL), GD_TOO_LARGE);
    assert_int_equal(read_package(files, SIZE_MAX, &faces, &polygons, NULL), GD_TOO_LARGE);
}

static bool refuse(void *user, double fraction)
{
    (void)user;
    (void)fraction;
    return false;
}

static void observes_the_control(void **state)
{
    (void)state;
    const struct gd_control control = {.progress = refuse};
    const struct gd_read_options options = {.control = &control};
    struct gd_polygons polygons;
    assert_int_equal(read_package(good[0].files, SIZE_MAX, &options, &polygons, NULL),
                     GD_CANCELLED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_packages),    cmocka_unit_test(refuses_packages),
        cmocka_unit_test(reads_zip64),       cmocka_unit_test(survives_truncation),
        cmocka_unit_test(bounds_components), cmocka_unit_test(bounds_names_and_tags),
        cmocka_unit_test(knows_limits),      cmocka_unit_test(observes_the_control),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
