/* Tests the shared meshes (tests/support/shared.h) by known distances, which are in the folder's
 * data/reference.json, and by laws of the metric. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/field.h"
#include "tests/support/laws.h"
#include "tests/support/shared.h"

static const double promise = 1e-9;

enum { FEW = 3, MANY = 25, MAX_TARGETS = 64 };

/* --- reference.json: {"mesh": [{"source": n, "targets": [n…], "distances": [x…], "max": x,
 * "agree": x}…]…}  */

struct reference {
    uint32_t source, count;
    double targets[MAX_TARGETS], distances[MAX_TARGETS];
};

static uint32_t scan_numbers(const char *text, double *out)
{
    uint32_t count = 0;
    for (text = strchr(text, '['); text && *text != ']' && count < MAX_TARGETS; count++) {
        char *end;
        out[count] = strtod(text + 1, &end);
        text = end + strcspn(end, ",]");
    }
    return count;
}

/* Returns the bracket that closes the first bracket of the text. */
static const char *list_end(const char *text)
{
    int depth = 0;
    for (text = strchr(text, '['); *text; text++) {
        depth += (*text == '[') - (*text == ']');
        if (depth == 0) break;
    }
    return text;
}

/* Reads the next reference before `end`. Returns the position after the reference, or NULL if there
 * is no further reference. */
static const char *scan_reference(const char *text, const char *end, struct reference *out)
{
    const char *source = strstr(text, "\"source\":");
    if (!source || source >= end) return NULL;
    const char *targets = strstr(source, "\"targets\":"),
               *distances = strstr(source, "\"distances\":");
    assert_true(targets && distances);
    out->source = (uint32_t)strtoul(source + strlen("\"source\":"), NULL, 10);
    out->count = scan_numbers(targets, out->targets);
    assert_int_equal(scan_numbers(distances, out->distances), out->count);
    return distances;
}

/* --- tests ------------------------------------------------------------------------------------ */

static double compare(const struct gd_mesh *mesh, const struct reference *reference)
{
    struct gd_seed seed = {0};
    check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){reference->source}, &seed.point, NULL),
             NULL);
    struct gd_field *field = NULL;
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL,
                            &field, NULL),
             NULL);
    double worst = 0;
    for (uint32_t i = 0; i < reference->count; i++) {
        struct gd_point target = {0};
        double distance = NAN;
        check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){(uint32_t)reference->targets[i]},
                                    &target, NULL),
                 NULL);
        check_ok(gd_field_distance(field, &target, &distance), NULL);
        worst = fmax(worst, check_close(distance, reference->distances[i], promise));
        worst = fmax(worst, check_close(law_distance(mesh, target, seed.point),
                                        reference->distances[i], promise));
    }
    gd_field_release(field);
    return worst;
}

static void check_laws(const struct gd_mesh *mesh, const struct gd_polygons *polygons, int pairs)
{
    struct rng rng = {polygons->polygon_count};
    double worst = 0;
    int connected = 0;
    for (int i = 0; i < pairs; i++) {
        struct gd_point p = test_point(mesh, test_random_place(polygons, &rng));
        struct gd_point q = test_point(mesh, test_random_place(polygons, &rng));
        struct gd_point r = test_point(mesh, test_random_place(polygons, &rng));
        worst = fmax(worst, law_metric(mesh, p, q, r));
        if (isinf(law_distance(mesh, p, q))) continue;
        worst = fmax(worst, law_path(mesh, polygons, p, q));
        connected++;
    }
    print_message("#   laws to %.2g, paths between %d of %d pairs\n", worst, connected, pairs);
    assert_true(connected > 0);
}

static void test_references(void **state)
{
    (void)state;
    static const char *const names[] = {"spot", "fandisk", "homer", "rocker-arm", "stanford-bunny"};
    size_t size;
    char *json = test_shared_file("data/reference.json", &size);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char key[64];
        snprintf(key, sizeof key, "\"%s\":", names[i]);
        const char *text = strstr(json, key);
        assert_non_null(text);
        const char *end = list_end(text);
        struct gd_polygons polygons = test_shared_polygons(names[i]);
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct reference reference;
        uint32_t compared = 0;
        double worst = 0;
        for (; (text = scan_reference(text, end, &reference)); compared += reference.count)
            worst = fmax(worst, compare(mesh, &reference));
        assert_true(compared > 0);
        print_message("# %s: %u distances, worst error %.2g\n", names[i], compared, worst);
        check_laws(mesh, &polygons, FEW);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    free(json);
}

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        enum gd_status status;
    } refused[] = {{"teapot", GD_NON_MANIFOLD_VERTEX},
                   {"cow", GD_NON_MANIFOLD_VERTEX},
                   {"beetle", GD_NON_MANIFOLD_EDGE}};
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        struct gd_polygons polygons = test_shared_polygons(refused[i].name);
        struct gd_mesh *mesh = NULL;
        struct gd_detail detail = {0};
        assert_int_equal(gd_mesh_build(&polygons, NULL, NULL, &mesh, &detail), refused[i].status);
        assert_null(mesh);
        assert_true(detail.total > 0);
        gd_polygons_free(&polygons);
    }
}

/* Repairs a mesh and rebuilds it from its polygons, which then need no repair. Returns the rebuilt
 * mesh and, in `surface`, its polygons, which the caller frees. */
static struct gd_mesh *repair(const char *name, struct gd_polygons *surface)
{
    struct gd_polygons polygons = test_shared_polygons(name);
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    check_ok(gd_mesh_build(&polygons, &(struct gd_mesh_options){.repair_split = true}, NULL, &mesh,
                           &detail),
             &detail);
    const struct gd_mesh_repair *repair = gd_mesh_repair(mesh);
    print_message("# %s, repaired: %u edges and %u vertices split, %u copies, %u duplicate and %u "
                  "degenerate faces "
                  "removed, %u flat ones flipped\n",
                  name, repair->edges_split.count, repair->vertices_split.count, repair->copies,
                  repair->duplicate_faces.count, repair->degenerate_faces.count,
                  repair->edges_flipped.count);
    assert_true(gd_mesh_summary(mesh)->vertices + gd_mesh_summary(mesh)->unreferenced_vertices ==
                polygons.position_count + repair->copies);
    check_ok(gd_mesh_polygons(mesh, surface), NULL);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
    return test_mesh(surface);
}

static void test_repaired(void **state)
{
    (void)state;
    static const char *const names[] = {"teapot", "cow", "beetle"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct gd_polygons surface;
        struct gd_mesh *mesh = repair(names[i], &surface);
        check_laws(mesh, &surface, MANY);
        gd_mesh_release(mesh);
        gd_polygons_free(&surface);
    }
}

static void test_polygons(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        uint32_t faces, components;
    } accepted[] = {{"suzanne", 968, 3}, {"beast", 64618, 0}};
    for (size_t i = 0; i < sizeof accepted / sizeof *accepted; i++) {
        struct gd_polygons polygons = test_shared_polygons(accepted[i].name), triangles;
        struct gd_mesh *mesh = test_mesh(&polygons);
        assert_int_equal(gd_mesh_summary(mesh)->faces, accepted[i].faces);
        if (accepted[i].components)
            assert_int_equal(gd_mesh_summary(mesh)->components, accepted[i].components);
        check_ok(gd_mesh_polygons(mesh, &triangles), NULL);
        print_message("# %s, %u faces after triangulation\n", accepted[i].name, accepted[i].faces);
        check_laws(mesh, &triangles, i ? FEW : MANY);
        gd_mesh_release(mesh);
        gd_polygons_free(&triangles);
        gd_polygons_free(&polygons);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_references),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_repaired),
        cmocka_unit_test(test_polygons),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
