#include "support.h"

#include <math.h>

#include "proto/values/point.h"

/* --- from JSON -------------------------------------------------------------------------------- */

static bool decode(const char *text, struct proto_point *out, struct proto_problem *problem)
{
    json_t *document = parse(text);
    bool decoded = proto_point_decode(json_object_get(document, "p"), "/p", out, problem);
    json_decref(document);
    return decoded;
}

static void decodes_the_five_forms(void **state)
{
    (void)state;
    struct proto_point p;
    struct proto_problem problem;
    assert_true(decode("{\"p\":{\"vertex\":12}}", &p, &problem));
    assert_true(p.form == PROTO_POINT_VERTEX && p.vertex == 12);
    assert_string_equal(p.place, "/p");
    assert_true(decode("{\"p\":{\"edge\":[3,9],\"t\":0.25}}", &p, &problem));
    assert_true(p.form == PROTO_POINT_EDGE && p.edge[0] == 3 && p.edge[1] == 9 && p.t == 0.25);
    assert_true(decode("{\"p\":{\"face\":34,\"barycentric\":[0.2,0.3,0.5]}}", &p, &problem));
    assert_true(p.form == PROTO_POINT_FACE && p.face == 34 && p.barycentric[2] == 0.5);
    assert_true(decode("{\"p\":{\"xyz\":[1,2,3]}}", &p, &problem));
    assert_true(p.form == PROTO_POINT_XYZ && p.xyz[1] == 2 && !p.has_max_snap);
    assert_true(decode("{\"p\":{\"xyz\":[1,2,3],\"max_snap\":0}}", &p, &problem));
    assert_true(p.form == PROTO_POINT_XYZ && p.has_max_snap && p.max_snap == 0);
    assert_true(
        decode("{\"p\":{\"ray\":{\"origin\":[0,0,5],\"direction\":[0,0,-1]}}}", &p, &problem));
    assert_true(p.form == PROTO_POINT_RAY && p.ray.origin[2] == 5 && p.ray.direction[2] == -1);
}

struct refused {
    const char *point, *pointer;
};

static const struct refused no_form[] = {
    {"12", "/p"},
    {"\"v12\"", "/p"},
    {"null", "/p"},
    {"true", "/p"},
    {"[1,2,3]", "/p"},
    {"{}", "/p"},
    {"{\"t\":0.5}", "/p"},
    {"{\"barycentric\":[1,0,0]}", "/p"},
    {"{\"max_snap\":1}", "/p"},
    {"{\"vertex\":1,\"xyz\":[0,0,0]}", "/p"},
    {"{\"vertex\":1,\"face\":1,\"barycentric\":[1,0,0]}", "/p"},
    {"{\"vertx\":1}", "/p/vertx"},
};

static const struct refused bad_vertices[] = {
    {"{\"vertex\":1,\"a/b~\":2}", "/p/a~1b~0"},
    {"{\"vertex\":1,\"t\":0.5}", "/p/t"},
    {"{\"vertex\":-1}", "/p/vertex"},
    {"{\"vertex\":1.5}", "/p/vertex"},
    {"{\"vertex\":4294967295}", "/p/vertex"},
    {"{\"vertex\":1e300}", "/p/vertex"},
    {"{\"vertex\":99999999999999999999999}", "/p/vertex"},
    {"{\"vertex\":\"1\"}", "/p/vertex"},
    {"{\"vertex\":null}", "/p/vertex"},
    {"{\"vertex\":[1]}", "/p/vertex"},
};

static const struct refused bad_edges[] = {
    {"{\"edge\":[3,9]}", "/p/t"},
    {"{\"edge\":[3],\"t\":0}", "/p/edge"},
    {"{\"edge\":[3,9,1],\"t\":0}", "/p/edge"},
    {"{\"edge\":\"3-9\",\"t\":0}", "/p/edge"},
    {"{\"edge\":[3,-9],\"t\":0}", "/p/edge/1"},
    {"{\"edge\":[3,9],\"t\":\"0\"}", "/p/t"},
    {"{\"edge\":[3,9],\"t\":0,\"max_snap\":1}", "/p/max_snap"},
};

static const struct refused bad_faces[] = {
    {"{\"face\":3}", "/p/barycentric"},
    {"{\"face\":0.5,\"barycentric\":[1,0,0]}", "/p/face"},
    {"{\"face\":3,\"barycentric\":[0.5,0.5]}", "/p/barycentric"},
    {"{\"face\":3,\"barycentric\":[1,0,\"0\"]}", "/p/barycentric/2"},
};

static const struct refused bad_positions[] = {
    {"{\"xyz\":[1,2]}", "/p/xyz"},
    {"{\"xyz\":[1,2,3,4]}", "/p/xyz"},
    {"{\"xyz\":{\"x\":1}}", "/p/xyz"},
    {"{\"xyz\":[1,null,3]}", "/p/xyz/1"},
    {"{\"xyz\":[1,2,3],\"max_snap\":-0.1}", "/p/max_snap"},
    {"{\"xyz\":[1,2,3],\"max_snap\":null}", "/p/max_snap"},
};

static const struct refused bad_rays[] = {
    {"{\"ray\":[0,0,1]}", "/p/ray"},
    {"{\"ray\":{\"origin\":[0,0,0]}}", "/p/ray/direction"},
    {"{\"ray\":{\"direction\":[0,0,0]}}", "/p/ray/origin"},
    {"{\"ray\":{\"origin\":[0,0],\"direction\":[0,0,1]}}", "/p/ray/origin"},
    {"{\"ray\":{\"origin\":[0,0,0],\"direction\":[0,0,true]}}", "/p/ray/direction/2"},
    {"{\"ray\":{\"origin\":[0,0,0],\"direction\":[0,0,1],\"length\":3}}", "/p/ray/length"},
};

static void assert_refused(const struct refused *cases, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        struct proto_point point = {.form = PROTO_POINT_RAY, .place = "untouched"};
        struct proto_problem problem;
        char text[200] = "{\"p\":";
        strcat(strcat(text, cases[i].point), "}");
        assert_false(decode(text, &point, &problem));
        assert_pointer(&problem, cases[i].pointer);
        assert_string_equal(point.place, "untouched");
    }
}

static void refuses_points_without_exactly_one_form(void **state)
{
    (void)state;
    assert_refused(no_form, COUNT(no_form));
}

static void refuses_malformed_members(void **state)
{
    (void)state;
    assert_refused(bad_vertices, COUNT(bad_vertices));
    assert_refused(bad_edges, COUNT(bad_edges));
    assert_refused(bad_faces, COUNT(bad_faces));
    assert_refused(bad_positions, COUNT(bad_positions));
    assert_refused(bad_rays, COUNT(bad_rays));
}

/* --- from compact text ------------------------------------------------------------------------ */

static void parses_compact_points(void **state)
{
    (void)state;
    struct proto_point p;
    struct proto_problem problem;
    assert_true(proto_point_parse("v:12", "from", &p, &problem));
    assert_true(p.form == PROTO_POINT_VERTEX && p.vertex == 12);
    assert_string_equal(p.place, "from");
    assert_true(proto_point_parse("v:0", "from", &p, &problem));
    assert_true(proto_point_parse("v:4294967294", "from", &p, &problem));
    assert_true(p.vertex == 4294967294u);
    assert_true(proto_point_parse("e:3-9:0.25", "from", &p, &problem));
    assert_true(p.form == PROTO_POINT_EDGE && p.edge[0] == 3 && p.edge[1] == 9 && p.t == 0.25);
    assert_true(proto_point_parse("e:9-3:1e-3", "from", &p, &problem));
    assert_true(p.edge[0] == 9 && p.t == 0.001);
    assert_true(proto_point_parse("f:34:0.2,0.3,0.5", "from", &p, &problem));
    assert_true(p.form == PROTO_POINT_FACE && p.face == 34 && p.barycentric[0] == 0.2 &&
                p.barycentric[2] == 0.5);
    assert_true(proto_point_parse("p:1.0,-2.5,3e2", "from", &p, &problem));
    assert_true(p.form == PROTO_POINT_XYZ && p.xyz[0] == 1 && p.xyz[1] == -2.5 && p.xyz[2] == 300 &&
                !p.has_max_snap);
}

static const char *const no_compact_form[] = {"", "v", ":12", "12", "v12", "x:12", "V:12", " v:1"};

static const char *const bad_compact_vertices[] = {
    "v:",   "v::12", "v:-1",  "v:+1",   "v: 1",         "v:1 ",         "v:1,",
    "v:01", "v:1.0", "v:1e3", "v:0x10", "v:4294967295", "v:4294967296", "v:18446744073709551617",
    "v:a"};

static const char *const bad_compact_edges[] = {
    "e:",         "e:3",           "e:3-9",      "e:3-9:",   "e:3-9:x",  "e:3,9:0.5",
    "e:-3-9:0.5", "e:3-9:0.5,0.5", "e:3--9:0.5", "e:3-9:.5", "e:3-9:0x1"};

static const char *const bad_compact_faces[] = {
    "f:34",       "f:34:",         "f:34:0.2,0.3",    "f:34:0.2,0.3,0.5,0", "f:34:0.2;0.3;0.5",
    "f:-1:1,0,0", "f:34:0.2,,0.5", "f:34:0,2 0,3 0,5"};

static const char *const bad_compact_positions[] = {
    "p:",        "p:1",       "p:1,2",       "p:1,2,3,4", "p:1,2,",   "p:,1,2",
    "p:1,2,nan", "p:inf,0,0", "p:1e999,0,0", "p:1,2,3x",  "p:1, 2,3", "p:+1,2,3"};

static void assert_refused_compact(const char *const *cases, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        struct proto_point point = {.form = PROTO_POINT_RAY, .place = "untouched"};
        struct proto_problem problem;
        assert_false(proto_point_parse(cases[i], "to", &point, &problem));
        assert_parameter(&problem, "to");
        assert_string_equal(point.place, "untouched");
    }
}

static void json_accepts_compact_text(void **state)
{
    struct proto_point point;
    struct proto_problem problem;
    (void)state;
    json_t *good = json_string("e:3-9:0.25"), *bad = json_string("v:+1");
    assert_true(proto_point_decode(good, "/set/points/3", &point, &problem));
    assert_true(point.form == PROTO_POINT_EDGE && point.t == 0.25);
    assert_string_equal(point.place, "/set/points/3");
    assert_false(proto_point_decode(bad, "/set/points/3", &point, &problem));
    assert_string_equal(problem.pointer, "/set/points/3");
    assert_string_equal(problem.detail,
                        "expected a point: v:12, e:3-9:0.25, f:34:0.2,0.3,0.5 or p:1.0,2.0,3.0");
    json_decref(good);
    json_decref(bad);
}

static void refuses_text_that_is_not_a_compact_point(void **state)
{
    (void)state;
    assert_refused_compact(no_compact_form, COUNT(no_compact_form));
}

static void refuses_malformed_numbers(void **state)
{
    (void)state;
    assert_refused_compact(bad_compact_vertices, COUNT(bad_compact_vertices));
    assert_refused_compact(bad_compact_edges, COUNT(bad_compact_edges));
    assert_refused_compact(bad_compact_faces, COUNT(bad_compact_faces));
    assert_refused_compact(bad_compact_positions, COUNT(bad_compact_positions));
}

/* --- onto the mesh and back ------------------------------------------------------------------- */

static void locate(const struct gd_mesh *mesh, const char *text, struct gd_point *out, double *snap)
{
    struct proto_point point;
    struct proto_problem problem;
    assert_true(decode(text, &point, &problem));
    assert_true(proto_point_locate(mesh, &point, out, snap, &problem));
}

static void encodes_all_fields(void **state)
{
    (void)state;
    static const struct {
        const char *request, *answer;
    } cases[] = {
        {"{\"vertex\":0}", "{\"face\":0,\"barycentric\":[1,0,0],\"xyz\":[0,0,0],\"vertex\":0}"},
        {"{\"edge\":[2,1],\"t\":0.25}", "{\"face\":0,\"barycentric\":[0,0.75,0.25],\"xyz\":[0.25,0."
                                        "75,0],\"edge\":[1,2],\"t\":0.75}"},
        {"{\"face\":1,\"barycentric\":[0.5,0.25,0.25]}",
         "{\"face\":1,\"barycentric\":[0.5,0.25,0.25],\"xyz\":[0.25,0,0.25]}"},
        {"{\"xyz\":[0.25,0.5,-0.5]}",
         "{\"face\":0,\"barycentric\":[0.25,0.5,0.25],\"xyz\":[0.25,0.5,0],\"snap_distance\":0.5}"},
        {"{\"xyz\":[1,0,0],\"max_snap\":0}",
         "{\"face\":0,\"barycentric\":[0,0,1],\"xyz\":[1,0,0],\"vertex\":1,\"snap_distance\":0}"},
        {"{\"ray\":{\"origin\":[0.25,0.25,-1],\"direction\":[0,0,2]}}",
         "{\"face\":0,\"barycentric\":[0.5,0.25,0.25],\"xyz\":[0.25,0.25,0]}"},
    };
    struct gd_mesh *mesh = new_tetrahedron();
    for (size_t i = 0; i < COUNT(cases); i++) {
        char text[200] = "{\"p\":";
        struct gd_point point;
        double snap = 0;
        locate(mesh, strcat(strcat(text, cases[i].request), "}"), &point, &snap);
        struct proto_writer writer = new_writer();
        proto_point_encode(&writer, mesh, &point, snap);
        assert_written(&writer, cases[i].answer);
    }
    gd_mesh_release(mesh);
}

static void encodes_selected_fields(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    struct gd_point point;
    double snap = 0;
    locate(mesh, "{\"p\":{\"vertex\":3}}", &point, &snap);
    assert_true(isnan(snap));
    struct proto_writer writer = new_writer();
    proto_point_encode_fields(&writer, mesh, &point, snap,
                              PROTO_POINT_FIELD_VERTEX | PROTO_POINT_FIELD_EDGE |
                                  PROTO_POINT_FIELD_SNAP_DISTANCE);
    assert_written(&writer, "{\"vertex\":3}");
    gd_mesh_release(mesh);
}

static void names_the_missing_point(void **state)
{
    (void)state;
    static const struct {
        const char *request;
        enum proto_problem_code code;
    } cases[] = {
        {"{\"p\":{\"vertex\":4}}", PROTO_PROBLEM_INVALID_REQUEST},
        {"{\"p\":{\"face\":4,\"barycentric\":[1,0,0]}}", PROTO_PROBLEM_INVALID_REQUEST},
        {"{\"p\":{\"edge\":[0,7],\"t\":0}}", PROTO_PROBLEM_INVALID_REQUEST},
        {"{\"p\":{\"edge\":[0,0],\"t\":0}}", PROTO_PROBLEM_INVALID_REQUEST},
        {"{\"p\":{\"edge\":[0,1],\"t\":1.5}}", PROTO_PROBLEM_POINT_NOT_ON_SURFACE},
        {"{\"p\":{\"face\":0,\"barycentric\":[1,1,0]}}", PROTO_PROBLEM_POINT_NOT_ON_SURFACE},
        {"{\"p\":{\"face\":0,\"barycentric\":[2,-1,0]}}", PROTO_PROBLEM_POINT_NOT_ON_SURFACE},
        {"{\"p\":{\"xyz\":[0,0,-1],\"max_snap\":0.5}}", PROTO_PROBLEM_POINT_NOT_ON_SURFACE},
        {"{\"p\":{\"ray\":{\"origin\":[9,9,9],\"direction\":[1,0,0]}}}",
         PROTO_PROBLEM_POINT_NOT_ON_SURFACE},
        {"{\"p\":{\"ray\":{\"origin\":[0,0,5],\"direction\":[0,0,0]}}}",
         PROTO_PROBLEM_INVALID_REQUEST},
    };
    struct gd_mesh *mesh = new_tetrahedron();
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_point point;
        struct proto_problem problem;
        struct gd_point located;
        double snap = 7;
        assert_true(decode(cases[i].request, &point, &problem));
        assert_false(proto_point_locate(mesh, &point, &located, &snap, &problem));
        assert_int_equal(problem.code, cases[i].code);
        assert_string_equal(problem.pointer, "/p");
        assert_true(snap == 7);
    }
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decodes_the_five_forms),
        cmocka_unit_test(refuses_points_without_exactly_one_form),
        cmocka_unit_test(refuses_malformed_members),
        cmocka_unit_test(parses_compact_points),
        cmocka_unit_test(json_accepts_compact_text),
        cmocka_unit_test(refuses_text_that_is_not_a_compact_point),
        cmocka_unit_test(refuses_malformed_numbers),
        cmocka_unit_test(encodes_all_fields),
        cmocka_unit_test(encodes_selected_fields),
        cmocka_unit_test(names_the_missing_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
