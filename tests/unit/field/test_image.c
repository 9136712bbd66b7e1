#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "field/layout.h"
#include "tests/samples/samples.h"

static struct gd_polygons polygons;
static struct gd_mesh *mesh;
static struct gd_field *field;
static char *image;
static size_t size;
static int released;

static void count_release(void *user)
{
    ++*(int *)user;
}

static int make_image(void **state)
{
    (void)state;
    check_ok(sample_terrain(12, 0.3, 7, &polygons), NULL);
    mesh = test_mesh(&polygons);
    struct rng rng = {4};
    struct gd_seed seeds[2] = {
        {.point = test_point(mesh, test_random_place(&polygons, &rng))},
        {.point = test_point(mesh, test_random_place(&polygons, &rng)), .offset = 0.25}};
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = seeds, .seed_count = 2}, NULL,
                            &field, NULL),
             NULL);
    size = gd_field_image_size(field);
    image = malloc(size);
    gd_field_write_image(field, image);
    released = 0;
    return 0;
}

static int drop_image(void **state)
{
    (void)state;
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
    free(image);
    return 0;
}

static void answers_like_the_field(void **state)
{
    (void)state;
    struct gd_field *opened;
    struct gd_detail detail;
    check_ok(gd_field_open_image(mesh,
                                 &(struct gd_field_image){image, size, count_release, &released},
                                 &opened, &detail),
             &detail);
    assert_int_equal(gd_field_memsize(opened), gd_field_memsize(field));
    struct rng rng = {8};
    for (int i = 0; i < 500; i++) {
        struct gd_point point = test_point(mesh, test_random_place(&polygons, &rng));
        double a, b;
        struct gd_path p, q;
        check_ok(gd_field_distance(field, &point, &a), NULL);
        check_ok(gd_field_distance(opened, &point, &b), NULL);
        assert_true(a == b);
        check_ok(gd_field_path(field, &point, &p), NULL);
        check_ok(gd_field_path(opened, &point, &q), NULL);
        assert_int_equal(p.count, q.count);
        assert_true(p.length == q.length);
        gd_path_free(&p);
        gd_path_free(&q);
    }
    char *again = malloc(size);
    gd_field_write_image(opened, again);
    assert_memory_equal(again, image, size);
    free(again);
    assert_int_equal(released, 0);
    gd_field_release(opened);
    assert_int_equal(released, 1);
}

static void refuses_other_images(void **state)
{
    (void)state;
    struct gd_field *opened = NULL;
    struct gd_detail detail;
    struct gd_polygons other;
    check_ok(sample_terrain(12, 0.3, 8, &other), NULL);
    struct gd_mesh *stranger = test_mesh(&other);
    assert_int_equal(gd_field_open_image(
                         stranger, &(struct gd_field_image){image, size, count_release, &released},
                         &opened, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(
        gd_field_open_image(mesh, &(struct gd_field_image){image, 50, count_release, &released},
                            &opened, &detail),
        GD_TRUNCATED);
    assert_int_equal(gd_field_open_image(
                         mesh, &(struct gd_field_image){image, size - 8, count_release, &released},
                         &opened, &detail),
                     GD_TRUNCATED);
    image[0] ^= 1;
    assert_int_equal(
        gd_field_open_image(mesh, &(struct gd_field_image){image, size, count_release, &released},
                            &opened, &detail),
        GD_UNRECOGNIZED);
    image[0] ^= 1;
    image[8] = 1; /* sets the previous version */
    assert_int_equal(
        gd_field_open_image(mesh, &(struct gd_field_image){image, size, count_release, &released},
                            &opened, &detail),
        GD_UNRECOGNIZED);
    assert_non_null(strstr(detail.text, "version 1"));
    assert_int_equal(released, 0);
    assert_null(opened);
    gd_mesh_release(stranger);
    gd_polygons_free(&other);
}

/* --- damage ----------------------------------------------------------------------------------- */

/* These functions locate the image's arrays, starting from the image's end. */
static char *image_wedges(void)
{
    return image + size - field->seed_count * sizeof *field->seeds - field->wedge_bytes;
}

static uint32_t *image_newest(void)
{
    return (uint32_t *)(image_wedges() - ((mesh->edge_count * sizeof(uint32_t) + 7) & ~(size_t)7));
}

static struct gd__chunk *image_chunk(uint32_t at)
{
    return (struct gd__chunk *)(image_wedges() + (size_t)at * GD__CHUNK_UNIT);
}

/* Queries distances, paths and wedges of a damaged field. The results may be wrong. No query may
 * read outside the image (checked by AddressSanitizer) or run forever. */
static void ask_everywhere(const struct gd_field *damaged, struct rng *rng)
{
    for (int k = 0; k < 5; k++) {
        struct gd_point point = test_point(mesh, test_random_place(&polygons, rng));
        double distance;
        struct gd_path path;
        enum gd_status status = gd_field_distance(damaged, &point, &distance);
        if (!status && gd_field_path(damaged, &point, &path) == GD_OK) gd_path_free(&path);
    }
    for (uint32_t e = 0; e < mesh->edge_count; e++) {
        struct gd_vertex a = {mesh->index_of_vertex[mesh->origin[2 * e]]},
                         b = {mesh->index_of_vertex[mesh->origin[2 * e + 1]]};
        struct gd_wedge *wedges;
        uint32_t count;
        if (gd_field_wedges(damaged, a, b, &wedges, &count) == GD_OK) free(wedges);
    }
}

/* Opens the damaged image, queries it everywhere if it opens, and restores the image. */
static enum gd_status try_damaged(struct rng *rng)
{
    struct gd_field *opened = NULL;
    struct gd_detail detail = {0};
    enum gd_status status = gd_field_open_image(
        mesh, &(struct gd_field_image){image, size, NULL, NULL}, &opened, &detail);
    if (status == GD_OK)
        ask_everywhere(opened, rng);
    else
        assert_true(detail.text[0] != '\0' && !opened);
    gd_field_release(opened);
    gd_field_write_image(field, image);
    return status;
}

/* Returns the edge with the longest chain. Sets *chunks to the chain's length. */
static uint32_t longest_chain(uint32_t *chunks)
{
    uint32_t best = 0;
    *chunks = 0;
    for (uint32_t e = 0; e < mesh->edge_count; e++) {
        uint32_t count = 0;
        for (uint32_t at = field->newest[e]; at != GD_NONE;
             at = gd__chunk_previous(gd__field_chunk(field, at)))
            count++;
        if (count > *chunks) *chunks = count, best = e;
    }
    return best;
}

static void refuses_impossible_chains(void **state)
{
    (void)state;
    struct rng rng = {16};
    uint32_t chunks, edge = longest_chain(&chunks), newest = image_newest()[edge],
                     units = (uint32_t)(field->wedge_bytes / GD__CHUNK_UNIT);
    assert_true(chunks >= 2);
    gd__chunk_link(image_chunk(newest), newest); /* makes a cycle of one chunk */
    assert_int_equal(try_damaged(&rng), GD_INDEX);
    static const uint32_t beyond[] = {0, 1, 100, 1u << 30};
    for (int i = 0; i < 4; i++) { /* makes chunks that begin beyond the wedges */
        image_newest()[edge] = units + beyond[i];
        assert_int_equal(try_damaged(&rng), GD_INDEX);
        gd__chunk_link(image_chunk(newest), units + beyond[i]);
        assert_int_equal(try_damaged(&rng), GD_INDEX);
    }
    image_newest()[edge] = units - 1; /* half of a chunk's header is beyond the array */
    assert_int_equal(try_damaged(&rng) == GD_OK, false);
    /* all edges share one chain */
    for (uint32_t e = 0; e < mesh->edge_count; e++) image_newest()[e] = newest;
    assert_int_equal(try_damaged(&rng), GD_INDEX);
}

static void refuses_impossible_counts_and_sources(void **state)
{
    (void)state;
    struct rng rng = {17};
    static const uint32_t counts[] = {GD__CHUNK_MOST, GD__CHUNK_MOST / 2, 1u << 20, 0};
    uint32_t chunks, newest = image_newest()[longest_chain(&chunks)];
    for (int i = 0; i < 4; i++) {
        image_chunk(newest)->count = counts[i];
        assert_int_equal(try_damaged(&rng), GD_INDEX);
    }
    uint32_t last = 0; /* gives the last chunk one more wedge, which lies beyond the array */
    for (uint32_t e = 0; e < mesh->edge_count; e++)
        if (field->newest[e] != GD_NONE && field->newest[e] > last) last = field->newest[e];
    image_chunk(last)->count++;
    assert_int_equal(try_damaged(&rng), GD_INDEX);
    image_chunk(newest)->form = 3;
    assert_int_equal(try_damaged(&rng), GD_INDEX);
    struct gd__wedges w = gd__chunk_wedges(image_chunk(newest));
    gd__wedge_put(&w, 0, 0, 1, 1, mesh->vertex_count + field->seed_count);
    assert_int_equal(try_damaged(&rng), GD_INDEX);
    gd__wedge_put(&w, 0, 0, 1, 1, GD_NONE); /* a gap has no source and may lie anywhere */
    assert_int_equal(try_damaged(&rng), GD_OK);
}

/* A reached vertex needs a side or a source as its predecessor. Paths are traced from this
 * predecessor. A vertex that was not reached must not be a source. */
static void refuses_impossible_predecessors(void **state)
{
    (void)state;
    struct rng rng = {19};
    uint32_t vertex = mesh->vertex_count / 2, chunks;
    struct gd__predecessor *predecessors =
        (struct gd__predecessor *)((char *)image_newest() -
                                   mesh->vertex_count * sizeof(struct gd__predecessor));
    double *distances = (double *)predecessors - mesh->vertex_count;
    assert_memory_equal(distances, field->distance, mesh->vertex_count * sizeof *distances);
    predecessors[vertex] = (struct gd__predecessor){.side = GD_NONE, .source = GD_NONE};
    assert_int_equal(try_damaged(&rng), GD_INDEX);
    predecessors[vertex] =
        (struct gd__predecessor){.side = GD_NONE, .source = mesh->vertex_count + field->seed_count};
    assert_int_equal(try_damaged(&rng), GD_INDEX);
    struct gd__wedges w = gd__chunk_wedges(image_chunk(image_newest()[longest_chain(&chunks)]));
    gd__wedge_put(&w, 0, w.start[0], 1, 1, vertex);
    assert_int_equal(try_damaged(&rng), GD_OK); /* sets a source that is wrong but valid */
    gd__wedge_put(&w, 0, w.start[0], 1, 1, vertex);
    predecessors[vertex] = (struct gd__predecessor){.side = GD_NONE, .source = GD_NONE};
    distances[vertex] = GD__FAR;
    assert_int_equal(try_damaged(&rng), GD_INDEX);
}

/* Tests chains that are valid but wrong: shared by two edges, truncated, with unordered starts, or
 * with invalid numbers. */
static void wrong_wedges_never_lead_outside(void **state)
{
    (void)state;
    struct rng rng = {18};
    int opened = 0;
    for (int i = 0; i < 300; i++) {
        uint32_t edge, other = rng_below(&rng, mesh->edge_count);
        do edge = rng_below(&rng, mesh->edge_count);
        while (image_newest()[edge] == GD_NONE);
        struct gd__chunk *chunk = image_chunk(image_newest()[edge]);
        struct gd__wedges w = gd__chunk_wedges(chunk);
        uint32_t k = rng_below(&rng, chunk->count);
        switch (i % 6) {
        case 0:
            image_newest()[other] = image_newest()[edge];
            break;
        case 1:
            chunk->count = rng_below(&rng, chunk->count);
            break;
        case 2:
            w.start[k] = (uint32_t)rng_next(&rng);
            break;
        case 3:
            w.x[k] = i % 2 ? NAN : INFINITY;
            break;
        case 4:
            w.y[k] = i % 2 ? -NAN : 1e308;
            break;
        case 5:
            for (k = 0; k < chunk->count; k++)
                gd__wedge_put(&w, k, (uint32_t)rng_next(&rng), rng_unit(&rng), rng_unit(&rng),
                              rng_below(&rng, mesh->vertex_count));
            break;
        }
        opened += try_damaged(&rng) == GD_OK;
    }
    print_message("# 300 images with wrong wedges: %d opened and asked\n", opened);
    assert_true(opened > 150);
}

/* Damages any byte. Either the engine rejects the image, or all queries stay within its arrays. */
static void damage_never_leads_outside(void **state)
{
    (void)state;
    struct rng rng = {15};
    int refused = 0;
    for (int i = 0; i < 3000; i++) {
        image[rng_below(&rng, (uint32_t)size)] ^= (char)(1 << rng_below(&rng, 8));
        refused += try_damaged(&rng) != GD_OK;
    }
    print_message("# 3000 damaged field images: %d refused by their indices\n", refused);
    assert_true(refused > 100);
}

#define WITH_IMAGE(test) cmocka_unit_test_setup_teardown(test, make_image, drop_image)

int main(void)
{
    const struct CMUnitTest tests[] = {
        WITH_IMAGE(answers_like_the_field),
        WITH_IMAGE(refuses_other_images),
        WITH_IMAGE(refuses_impossible_chains),
        WITH_IMAGE(refuses_impossible_counts_and_sources),
        WITH_IMAGE(refuses_impossible_predecessors),
        WITH_IMAGE(wrong_wedges_never_lead_outside),
        WITH_IMAGE(damage_never_leads_outside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
