#include "edits.h"

#include "gd/query.h"
#include "tests/support/laws.h"

static struct gd_edited filled(const struct gd_mesh *mesh, uint32_t max_edges)
{
    struct gd_edited edited;
    struct gd_detail detail = {0};
    check_ok(gd_fill(mesh, &(struct gd_fill_options){max_edges}, NULL, &edited, &detail), &detail);
    return edited;
}

/* Checks that the faces of the mesh come first and are unchanged. */
static void check_old_faces(const struct gd_mesh *mesh, const struct gd_edited *edited)
{
    struct gd_polygons before;
    check_ok(gd_mesh_polygons(mesh, &before), NULL);
    for (uint32_t i = 0; i < 3 * before.polygon_count; i++)
        assert_memory_equal(edited->polygons.positions[edited->polygons.corners[i]],
                            before.positions[before.corners[i]], sizeof(double[3]));
    gd_polygons_free(&before);
}

static void a_tube_becomes_closed(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("cylinder", (double[SAMPLE_PARAMETERS]){1, 2, 40, 10}, NULL);
    struct gd_edited edited = filled(mesh, GD_FILL_EDGES);
    struct gd_mesh *made = test_mesh(&edited.polygons);
    const struct gd_mesh_summary *before = gd_mesh_summary(mesh), *after = gd_mesh_summary(made);
    assert_int_equal(after->boundaries, 0);
    assert_int_equal(after->euler_characteristic, 2);
    assert_int_equal(after->flipped_faces, 0);
    assert_int_equal(after->degenerate_faces, 0);
    /* the filled holes are two regular polygons with 40 corners */
    check_close(after->area, before->area + 2 * 20 * sin(acos(-1) / 20), 1e-9);
    assert_true(after->vertices > before->vertices);
    check_old_faces(mesh, &edited);
    assert_true(farthest_origin(mesh, &edited) < 1.01);
    gd_mesh_release(made);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

static void long_loops_stay_open(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("cylinder", (double[SAMPLE_PARAMETERS]){1, 2, 40, 10}, NULL);
    struct gd_edited edited = filled(mesh, 39);
    assert_int_equal(edited.polygons.polygon_count, gd_mesh_summary(mesh)->faces);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

/* Fills the hole of a tetrahedron that lacks one face. The filling is a single triangle. */
static void the_smallest_hole(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    uint32_t corners[] = {0, 2, 1, 0, 1, 3, 0, 3, 2};
    const struct gd_polygons polygons = {positions, 4, 3, corners, NULL};
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_edited edited = filled(mesh, 3);
    struct gd_mesh *made = test_mesh(&edited.polygons);
    assert_int_equal(gd_mesh_summary(made)->boundaries, 0);
    gd_mesh_release(made);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

/* Returns whether an edge passes through the inside of a face with which it shares no corner. */
static bool crosses(const struct gd_polygons *p, const uint32_t *edge, const uint32_t *face)
{
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 3; k++) {
            if (edge[i] == face[k]) return false;
        }
    }
    struct gd_vec3 a = position_at(p, edge[0]), way = gd_vec3_sub(position_at(p, edge[1]), a);
    struct gd_vec3 c[3], normal;
    for (int k = 0; k < 3; k++) c[k] = position_at(p, face[k]);
    normal = gd_vec3_cross(gd_vec3_sub(c[1], c[0]), gd_vec3_sub(c[2], c[0]));
    double slope = gd_vec3_dot(way, normal);
    double t = gd_vec3_dot(gd_vec3_sub(c[0], a), normal) / slope;
    if (slope == 0 || !(t > 1e-9 && t < 1 - 1e-9)) return false;
    struct gd_vec3 hit = gd_vec3_add(a, gd_vec3_scale(way, t));
    for (int k = 0; k < 3; k++) {
        struct gd_vec3 side = gd_vec3_sub(c[(k + 1) % 3], c[k]);
        if (gd_vec3_dot(gd_vec3_cross(side, gd_vec3_sub(hit, c[k])), normal) <= 0) return false;
    }
    return true;
}

static void check_no_overlap(const struct gd_polygons *p, uint32_t first_new)
{
    for (uint32_t f = first_new; f < p->polygon_count; f++) {
        for (uint32_t g = first_new; g < p->polygon_count; g++) {
            for (uint32_t k = 0; k < 3; k++) {
                const uint32_t edge[2] = {p->corners[3 * f + k], p->corners[3 * f + (k + 1) % 3]};
                assert_false(f != g && crosses(p, edge, &p->corners[3 * g]));
            }
        }
    }
}

/* Fills the bunny's holes. */
static void the_holes_of_a_scan(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_shared_mesh("stanford-bunny");
    const struct gd_mesh_summary *before = gd_mesh_summary(mesh);
    struct gd_edited edited = filled(mesh, GD_FILL_EDGES);
    struct gd_mesh *made = test_mesh(&edited.polygons);
    const struct gd_mesh_summary *after = gd_mesh_summary(made);
    assert_true(before->boundaries > 0);
    assert_int_equal(after->boundaries, 0);
    assert_int_equal(after->components, before->components);
    assert_int_equal(after->flipped_faces, 0);
    check_no_overlap(&edited.polygons, before->faces);
    /* between corners of two new faces the distance is finite */
    for (uint32_t f = before->faces; f + 7 < after->faces;
         f += (after->faces - before->faces) / 5) {
        struct gd_point from = test_vertex(made, edited.polygons.corners[3 * f]);
        struct gd_point to = test_vertex(made, edited.polygons.corners[3 * (f + 7)]);
        assert_true(isfinite(law_distance(made, from, to)));
    }
    gd_mesh_release(made);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

enum { BAND = 60 }; /* number of vertices of each border of a band */

/* Writes a band between a closed curve and a copy of the curve that is moved by `way`. */
static void band_write(struct gd_vec3 (*curve)(double angle), struct gd_vec3 way,
                       struct gd_polygons *out)
{
    uint32_t first = out->position_count;
    for (uint32_t i = 0; i < BAND; i++) {
        const struct gd_vec3 p = curve(2 * acos(-1) * i / BAND), q = gd_vec3_add(p, way);
        const uint32_t a = first + 2 * i, b = first + 2 * ((i + 1) % BAND);
        const uint32_t faces[6] = {a, b, b + 1, a, b + 1, a + 1};
        memcpy(out->positions[out->position_count++], &p, sizeof p);
        memcpy(out->positions[out->position_count++], &q, sizeof q);
        memcpy(&out->corners[3 * out->polygon_count], faces, sizeof faces);
        out->polygon_count += 2;
    }
}

static struct gd_vec3 trefoil(double t)
{
    double radius = 2 + cos(3 * t);
    return (struct gd_vec3){radius * cos(2 * t), radius * sin(2 * t), sin(3 * t)};
}

static struct gd_vec3 ring(double t)
{
    return (struct gd_vec3){cos(t), sin(t), 0};
}

static struct gd_vec3 ring_through_it(double t)
{
    return (struct gd_vec3){1 + cos(t), 0.01, 0.05 + sin(t)};
}

/* The two borders of the band are trefoil knots. A disc whose border is a knot crosses itself, so
 * neither hole can be filled. In the second case, faces to a far vertex already close one of the
 * borders. */
static void a_knotted_hole_stays_open(void **state)
{
    (void)state;
    double positions[2 * BAND + 1][3];
    uint32_t corners[9 * BAND];
    struct gd_polygons polygons = {.positions = positions, .corners = corners};
    band_write(trefoil, (struct gd_vec3){0, 0, 0.1}, &polygons);
    for (int is_closed = 0; is_closed < 2; is_closed++) {
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct gd_edited edited = {.bytes = 7};
        struct gd_detail detail = {.text = ""};
        enum gd_status status =
            gd_fill(mesh, &(struct gd_fill_options){GD_FILL_EDGES}, NULL, &edited, &detail);
        assert_int_equal(status, GD_NOT_TRIANGULABLE);
        assert_non_null(strstr(detail.text, "triangles that do not cross"));
        assert_int_equal(detail.kind, GD_ELEMENT_VERTEX);
        assert_int_equal(edited.bytes, 7);
        gd_mesh_release(mesh);
        if (is_closed) break;
        memcpy(positions[polygons.position_count++], (double[3]){0, 0, 20}, sizeof *positions);
        for (uint32_t i = 0; i < BAND; i++) {
            const uint32_t face[3] = {2 * i + 1, 2 * ((i + 1) % BAND) + 1, 2 * BAND};
            memcpy(&corners[3 * polygons.polygon_count++], face, sizeof face);
        }
    }
}

/* Two bands are linked like the rings of a chain. The discs that would fill one band cross the
 * discs of the other band, so only two of the four holes are filled. */
static void holes_that_cross_another_stay_open(void **state)
{
    (void)state;
    double positions[4 * BAND][3];
    uint32_t corners[12 * BAND];
    struct gd_polygons polygons = {.positions = positions, .corners = corners};
    band_write(ring, (struct gd_vec3){0, 0, 0.1}, &polygons);
    band_write(ring_through_it, (struct gd_vec3){0, 0.1, 0}, &polygons);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_edited edited = filled(mesh, GD_FILL_EDGES);
    struct gd_mesh *made = test_mesh(&edited.polygons);
    assert_int_equal(gd_mesh_summary(mesh)->boundaries, 4);
    assert_int_equal(gd_mesh_summary(made)->boundaries, 2);
    check_no_overlap(&edited.polygons, polygons.polygon_count);
    gd_mesh_release(made);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

/* The mesh has a slit, as at a seam of texture coordinates: the vertices of the slit exist twice,
 * at the same positions. The error names these vertices. */
static void a_pinched_hole_is_named(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0},    {1, 0, 0.3}, {2, 0, -0.3}, {3, 0, 0},    {0, 1, 0},
                             {1.5, 3, 0},  {3, 1, 0},   {1, 0, 0.3},  {2, 0, -0.3}, {0, -1, 0},
                             {1.5, -3, 0}, {3, -1, 0},  {1.5, 0, 9}};
    uint32_t corners[] = {0,  1, 4,  1,  5,  4,  1,  2,  5,  2,  6,  5, 2,  3, 6, 0,  9, 7,
                          7,  9, 10, 7,  10, 8,  8,  10, 11, 8,  11, 3, 12, 4, 5, 12, 5, 6,
                          12, 6, 3,  12, 3,  11, 12, 11, 10, 12, 10, 9, 12, 9, 0, 12, 0, 4};
    const struct gd_polygons polygons = {.positions = positions,
                                         .position_count = 13,
                                         .polygon_count = sizeof corners / sizeof *corners / 3,
                                         .corners = corners};
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_edited edited;
    struct gd_detail detail = {.text = ""};
    assert_int_equal(gd_mesh_summary(mesh)->boundaries, 1);
    assert_int_equal(
        gd_fill(mesh, &(struct gd_fill_options){GD_FILL_EDGES}, NULL, &edited, &detail),
        GD_NOT_TRIANGULABLE);
    assert_non_null(strstr(detail.text, "at the same place"));
    gd_mesh_release(mesh);
}

/* The boundary of a single face is not filled, because the filling would be the same face again. */
static void the_boundary_of_a_single_face_stays_open(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0},
                             {6, 0, 0}, {5, 1, 0}, {6, 1, 1}};
    uint32_t corners[] = {0, 1, 2, 3, 4, 5, 5, 4, 6};
    const struct gd_polygons polygons = {
        .positions = positions, .position_count = 7, .corners = corners, .polygon_count = 3};
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_edited edited = filled(mesh, GD_FILL_EDGES);
    struct gd_mesh *made = test_mesh(&edited.polygons);
    assert_int_equal(gd_mesh_summary(made)->boundaries, 1);
    assert_int_equal(gd_mesh_boundary(made, 0).vertices, 3);
    gd_mesh_release(made);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

static void options_budget_and_cancel(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("cylinder", (double[SAMPLE_PARAMETERS]){1, 2, 200, 1}, NULL);
    const struct gd_fill_options good = {GD_FILL_EDGES};
    const struct gd_control small = {.budget_bytes = 1000}, late = {.deadline_ns = 1};
    struct gd_edited edited;
    for (uint32_t most = 2; most <= GD_FILL_EDGES_MOST + 1; most += GD_FILL_EDGES_MOST - 1)
        assert_int_equal(gd_fill(mesh, &(struct gd_fill_options){most}, NULL, &edited, NULL),
                         GD_INVALID_ARGUMENT);
    assert_int_equal(gd_fill(mesh, &good, &small, &edited, NULL), GD_BUDGET);
    assert_int_equal(gd_fill(mesh, &good, &late, &edited, NULL), GD_DEADLINE);
    enum gd_status status = GD_CANCELLED;
    for (uint32_t calls = 1; status == GD_CANCELLED; calls = 2 * calls + 1) {
        struct test_watch watch = {.most = calls};
        const struct gd_control control = {.progress = test_watch, .user = &watch};
        status = gd_fill(mesh, &good, &control, &edited, NULL);
        assert_true(status == GD_OK || status == GD_CANCELLED);
    }
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tube_becomes_closed),
        cmocka_unit_test(long_loops_stay_open),
        cmocka_unit_test(the_smallest_hole),
        cmocka_unit_test(the_holes_of_a_scan),
        cmocka_unit_test(options_budget_and_cancel),
        cmocka_unit_test(the_boundary_of_a_single_face_stays_open),
        cmocka_unit_test(a_knotted_hole_stays_open),
        cmocka_unit_test(holes_that_cross_another_stay_open),
        cmocka_unit_test(a_pinched_hole_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
