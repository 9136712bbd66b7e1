/* Tests builds of surfaces within a byte budget, in particular meshes that repair splits into more
 * vertices than expected. */
#include "tests/unit/server/folder.h"

#include <math.h>

#include "server/surfaces/surface.h"

static struct server_budget budget;
static struct server_cache *cache;
static struct proto_problem problem;

static int set_up(void **state)
{
    (void)state;
    server_budget_init(&budget, (size_t)1 << 30);
    cache = server_cache_create(&budget, NULL);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    server_cache_destroy(cache);
    assert_int_equal(budget.total, 0); /* all counted bytes were returned to the budget */
    return 0;
}

/* Builds the surface of an OBJ file. The control must have no budget. Returns NULL if there is a
 * problem. */
static struct server_surface *build_under(struct gd_control control, const char *file,
                                          const char *options)
{
    struct server_record *record = new_record_of(mesh_key("it"), options, file, NULL);
    const struct server_builder builder = {.budget = &budget,
                                           .cache = cache,
                                           .max_faces = 1000000,
                                           .control = control,
                                           .record = record,
                                           .bytes = file,
                                           .problem = &problem};
    struct server_surface *surface = NULL;
    enum gd_status status = server_build_surface(&builder, &surface);
    assert_int_equal(status == GD_OK, surface != NULL);
    server_record_release(record);
    return surface;
}

static struct server_surface *build(const char *file, const char *options)
{
    return build_under((struct gd_control){0}, file, options);
}

static const char split[] = MESH_OPTIONS "&repair=split",
                  weld_and_split[] = MESH_OPTIONS "&repair=split&weld=0";

static void assert_mended(const char *file, const char *options, uint32_t faces,
                          uint32_t components)
{
    struct server_surface *surface = build(file, options);
    if (!surface) fail_msg("%s", problem.detail);
    assert_int_equal(gd_mesh_summary(surface->mesh)->faces, faces);
    assert_int_equal(gd_mesh_summary(surface->mesh)->components, components);
    assert_int_equal(budget.total, surface->bytes);
    server_surface_release(surface);
}

static void smallest_meshes_that_repair_splits(void **state)
{
    (void)state;
    static const char bow_tie[] =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\nf 1 2 3\nf 1 4 5\n";
    static const char three_on_an_edge[] =
        "v 0 0 0\nv 0 0 1\nv 1 0 0\nv -1 1 0\nv -1 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
    assert_mended(bow_tie, split, 2, 2);
    assert_mended(three_on_an_edge, split, 3, 3);
}

/* Returns an OBJ file of `pages` triangles around one edge. All triangles run along the edge in the
 * same direction, so no two triangles can be joined. */
static char *new_book(uint32_t pages)
{
    size_t capacity = 64 + 96 * (size_t)pages, size = 0;
    char *file = malloc(capacity);
    size += (size_t)sprintf(file, "v 0 0 0\nv 0 0 1\n");
    for (uint32_t i = 0; i < pages; i++)
        size += (size_t)sprintf(file + size, "v %.17g %.17g 0\nf 1 2 %u\n",
                                cos(6 * i / (double)pages), sin(6 * i / (double)pages), i + 3);
    assert_true(size < capacity);
    return file;
}

static void books_of_any_number_of_pages(void **state)
{
    (void)state;
    for (uint32_t pages = 3; pages <= 8192; pages = pages * 2 - pages / 3) {
        char *book = new_book(pages);
        assert_mended(book, split, pages, pages);
        free(book);
    }
}

/* Returns an OBJ file of triangles that all share one position. Some triangles share two
 * positions. */
static char *new_soup(uint32_t triangles)
{
    size_t capacity = 128 * (size_t)triangles, size = 0;
    char *file = malloc(capacity);
    for (uint32_t i = 0; i < triangles; i++)
        size += (size_t)sprintf(file + size, "v 0 0 0\nv %u 1 0\nv %u 0 1\nf %u %u %u\n", i % 97,
                                i / 97, 3 * i + 1, 3 * i + 2, 3 * i + 3);
    assert_true(size < capacity);
    return file;
}

static void a_soup_that_is_welded_and_split(void **state)
{
    (void)state;
    char *soup = new_soup(9000);
    assert_mended(soup, weld_and_split, 9000, 9000);
    free(soup);
}

static void a_refusal_for_memory_names_the_numbers(void **state)
{
    (void)state;
    char *book = new_book(4096);
    budget.limit = (size_t)7 << 19;
    assert_null(build(book, split));
    assert_int_equal(problem.code, PROTO_PROBLEM_INSUFFICIENT_MEMORY);
    assert_int_equal(problem.limit, budget.limit);
    assert_non_null(strstr(problem.detail, "3670016"));
    budget.limit = (size_t)1 << 23;
    assert_mended(book, split, 4096, 4096);
    free(book);
}

/* --- control ---------------------------------------------------------------------------------- */

struct watch {
    double last, end_at; /* the call is cancelled at the progress `end_at` */
};

static bool on_progress(void *user, double fraction)
{
    struct watch *watch = user;
    assert_true(fraction >= watch->last && fraction <= 1);
    watch->last = fraction;
    return fraction < watch->end_at;
}

static void progress_covers_reading_and_building(void **state)
{
    (void)state;
    char *soup = new_soup(9000);
    struct watch watch = {.end_at = 2};
    const struct gd_control control = {.progress = on_progress, .user = &watch};
    struct server_surface *surface = build_under(control, soup, MESH_OPTIONS);
    assert_non_null(surface);
    assert_true(watch.last == 1);
    server_surface_release(surface);
    free(soup);
}

static void reading_and_building_can_be_cancelled(void **state)
{
    (void)state;
    char *soup = new_soup(9000);
    for (int i = 0; i < 2; i++) {
        struct watch watch = {.end_at = i ? 0.5 : 0.1};
        const struct gd_control control = {.progress = on_progress, .user = &watch};
        assert_null(build_under(control, soup, MESH_OPTIONS));
        assert_int_equal(problem.code, PROTO_PROBLEM_DRAINING);
        assert_true(watch.last < (i ? 0.7 : 0.2));
    }
    struct watch watch = {.end_at = 2};
    const struct gd_control late = {.progress = on_progress, .user = &watch, .deadline_ns = 1};
    assert_null(build_under(late, soup, MESH_OPTIONS));
    assert_int_equal(problem.code, PROTO_PROBLEM_DEADLINE_EXCEEDED);
    assert_true(watch.last == 0);
    free(soup);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(smallest_meshes_that_repair_splits),   TEST(books_of_any_number_of_pages),
        TEST(a_soup_that_is_welded_and_split),      TEST(a_refusal_for_memory_names_the_numbers),
        TEST(progress_covers_reading_and_building), TEST(reading_and_building_can_be_cancelled),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
