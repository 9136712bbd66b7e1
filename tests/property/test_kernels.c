/* Compares whole fields of all kernels that this machine supports: distances, predecessors and all
 * bytes of wedges are equal. */
#include <stdio.h>
#include <string.h>

#include "field/layout.h"
#include "gd/cpu.h"
#include "gd/field.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

static const struct {
    const char *name;
    double values[SAMPLE_PARAMETERS];
} surfaces[] = {
    {"grid", {12, 9, 1, 1}},
    {"grid", {40, 25, 30000, 1}},
    {"box", {1, 1, 1, 6}},
    {"icosphere", {4, 1}},
    {"torus", {60, 36, 1, 0.4}},
    {"cone", {1, 0.8, 32, 10}},
    {"saddle", {1, 0.6, 24, 9}},
    {"cylinder", {0.05, 3, 24, 12}},
    {"terrain", {40, 0.3, 7}},
    {"terrain", {24, 3, 4}},
    {"terrain", {20, 10, 5}},
    {"genus2", {6, 0.05}},
    {"tetrahedron", {1, 4}},
    {"tangle", {300, 1}},
    {"tangle", {300, 2}},
    {"obstacles", {8, 2, 3}},
    {"eight", {2022, 0.6, 0, 0, 0, 1}},
    {"ball", {3996, 0.7, 0, 0, 0, 1}},
    {"pot", {3000, 1, 1, 2, 0.5, 1}},
    {"scan", {6000, 0, 0.4, 0, 0.5, 1}},
};

enum { SURFACES = sizeof surfaces / sizeof *surfaces };

static const char *names[3];
static int count;

static int find_kernels(void **state)
{
    (void)state;
    static const char *const all[] = {"baseline", "avx2", "avx512"};
    count = 0;
    for (int i = 0; i < 3; i++)
        if (gd_cpu_select(all[i]) == GD_OK) names[count++] = all[i];
    return 0;
}

static struct gd_field *field_by(const char *kernel, const struct gd_mesh *mesh,
                                 const struct gd_field_request *request)
{
    struct gd_field *field = NULL;
    check_ok(gd_cpu_select(kernel), NULL);
    check_ok(gd_field_build(mesh, request, NULL, &field, NULL), NULL);
    return field;
}

/* Returns the number of vertices and edges at which the fields differ, plus 1 if their wedges
 * differ. */
static uint64_t differences(const struct gd_field *a, const struct gd_field *b, const char *what)
{
    const struct gd_mesh *mesh = a->mesh;
    uint64_t distances = 0, predecessors = 0, chains = 0;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        distances += memcmp(&a->distance[v], &b->distance[v], sizeof *a->distance) != 0;
        predecessors += memcmp(&a->predecessor[v], &b->predecessor[v], sizeof *a->predecessor) != 0;
    }
    for (uint32_t e = 0; e < mesh->edge_count; e++) chains += a->newest[e] != b->newest[e];
    bool wedges =
        a->wedge_bytes != b->wedge_bytes || memcmp(a->wedges, b->wedges, a->wedge_bytes) != 0;
    uint64_t total = distances + predecessors + chains + wedges;
    if (total)
        print_error("%s: %llu distances, %llu predecessors, %llu chains differ, wedges %s\n", what,
                    (unsigned long long)distances, (unsigned long long)predecessors,
                    (unsigned long long)chains, wedges ? "too" : "do not");
    return total;
}

/* Compares a whole field, a field with a radius and a field with a target. Returns the number of
 * wedges. */
static uint64_t compare(const struct gd_mesh *mesh, const char *name, struct gd_point source,
                        struct gd_point target)
{
    struct gd_seed seed = {.point = source};
    double far = mesh->summary.edge_length.max * 5;
    struct gd_field_request requests[3] = {{.seeds = &seed, .seed_count = 1},
                                           {.seeds = &seed, .seed_count = 1, .radius = far},
                                           {.seeds = &seed, .seed_count = 1, .target = &target}};
    uint64_t wedges = 0, differ = 0;
    for (int i = 0; i < 3; i++) {
        struct gd_field *plain = field_by(names[0], mesh, &requests[i]);
        wedges += plain->statistics.wedges;
        for (int k = 1; k < count; k++) {
            struct gd_field *other = field_by(names[k], mesh, &requests[i]);
            char what[64];
            snprintf(what, sizeof what, "%s, %s, request %d", name, names[k], i);
            differ += differences(plain, other, what);
            gd_field_release(other);
        }
        gd_field_release(plain);
    }
    assert_int_equal(differ, 0);
    return wedges;
}

static struct test_place place_of_kind(const struct gd_polygons *polygons, struct rng *rng,
                                       int corners)
{
    for (;;) {
        struct test_place place = test_random_place(polygons, rng);
        if ((place.weight[0] != 0) + (place.weight[1] != 0) + (place.weight[2] != 0) == corners)
            return place;
    }
}

static void test_kernels_agree(void **state)
{
    (void)state;
    uint64_t wedges = 0;
    for (int i = 0; i < SURFACES; i++) {
        struct rng rng = {(uint64_t)i};
        struct gd_polygons polygons;
        const struct sample *sample = sample_find(surfaces[i].name);
        assert_non_null(sample);
        assert_int_equal(sample->generate(surfaces[i].values, &polygons), GD_OK);
        struct gd_mesh *mesh = test_mesh(&polygons);
        /* the source is at a vertex, on an edge, or in a face */
        for (int corners = 1; corners <= 3; corners++) {
            struct gd_point source = test_point(mesh, place_of_kind(&polygons, &rng, corners));
            struct gd_point target = test_point(mesh, test_random_place(&polygons, &rng));
            wedges += compare(mesh, surfaces[i].name, source, target);
        }
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    print_message(
        "# %d kernels, %d surfaces, 9 fields each, %llu wedges: the same to the last bit\n", count,
        SURFACES, (unsigned long long)wedges);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kernels_agree),
    };
    return cmocka_run_group_tests(tests, find_kernels, NULL);
}
