/* Tests how the preview of a surface is built, stored and evicted. */
#include "tests/unit/server/folder.h"

#include <sched.h>

#include "server/server.h"
#include "server/surfaces/field_store.h"
#include "server/surfaces/previews.h"

enum { FACES = 400 };

static struct server server;
static struct server_surface *surface; /* of 5,120 faces */
static char folder[FOLDER_PATH];

static struct gd_mesh *sphere(uint32_t level)
{
    struct gd_polygons polygons;
    struct gd_mesh *mesh = NULL;
    assert_int_equal(sample_icosphere(level, 1.0, &polygons), GD_OK);
    assert_int_equal(gd_mesh_build(&polygons, NULL, NULL, &mesh, NULL), GD_OK);
    gd_polygons_free(&polygons);
    return mesh;
}

/* Adds a sphere to the registry. Its level is its name. */
static struct server_surface *put_sphere(uint32_t level)
{
    char name[2] = {(char)('0' + level), '\0'};
    struct gd_mesh *mesh = sphere(level);
    struct server_record *record = new_record(name, name);
    assert_true(server_budget_take(&server.budget, SERVER_BUDGET_FLIGHT, gd_mesh_memsize(mesh)));
    struct server_surface *made = server_surface_create(record, mesh, gd_mesh_memsize(mesh),
                                                        &server.budget, server.api.cache);
    server_record_release(record);
    assert_true(server_registry_put(server.api.registry, made, name,
                                    &(struct server_precondition){0}) <= SERVER_STORE_REPLACED);
    return made;
}

static int set_up(void **state)
{
    (void)state;
    memset(&server, 0, sizeof server);
    server_budget_init(&server.budget, 256 << 20);
    server.host.workspaces = server_workspaces_create(&server.budget, 1);
    server.host.workers = server_workers_create(1, 10);
    server.api.cache = server_cache_create(&server.budget, server.host.workers);
    server.api.registry = server_registry_create(server_store_memory_create(), &server.budget);
    folder_make(folder);
    server.field_store = server_field_store_open(folder, &server.budget);
    server_field_store_follow(server.field_store, server.api.registry);
    server.api.previews = server_previews_create(
        &(struct server_background_parts){.workers = server.host.workers,
                                          .workspaces = server.host.workspaces,
                                          .registry = server.api.registry,
                                          .field_store = server.field_store});
    surface = put_sphere(4);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    server_workers_cancel(server.host.workers);
    server_background_stop(server.api.previews);
    server_surface_release(surface);
    server_registry_destroy(server.api.registry);
    server_background_destroy(server.api.previews);
    server_field_store_close(server.field_store);
    server_cache_destroy(server.api.cache);
    server_workers_destroy(server.host.workers);
    server_workspaces_destroy(server.host.workspaces);
    folder_remove(folder);
    assert_int_equal(server.budget.total, 0); /* all counted bytes were returned to the budget */
    return 0;
}

static size_t counted(enum server_budget_class class)
{
    return atomic_load(&server.budget.used[class]);
}

/* Repeats the request until the preview exists or the build has failed; asserts that the progress
 * stays within [0, 1]. */
static enum gd_status await(uint32_t faces, struct server_preview **out)
{
    double progress = 0;
    enum gd_status status;
    *out = NULL;
    while (!(status = server_previews_find(server.api.previews, surface, faces, out, &progress)) &&
           !*out) {
        assert_true(progress >= 0 && progress <= 1);
        sched_yield();
    }
    return status;
}

static struct server_preview *made(uint32_t faces)
{
    struct server_preview *preview;
    assert_int_equal(await(faces, &preview), GD_OK);
    return preview;
}

static void reclaim(size_t bytes)
{
    const struct server_reclaimer *reclaimer = &server.budget.reclaimers[SERVER_RECLAIM_PREVIEWS];
    reclaimer->reclaim(reclaimer->user, bytes);
}

static void wait_for_background(void)
{
    while (server_background_is_busy(server.api.previews)) sched_yield();
}

static void the_preview_is_built_in_the_background_and_counted(void **state)
{
    (void)state;
    struct server_preview *preview = made(FACES), *again = made(FACES);
    assert_ptr_equal(preview, again);
    assert_int_equal(preview->polygons.polygon_count, FACES);
    assert_true(preview->largest_distance > 0 && preview->largest_distance < 0.2);
    assert_int_equal(counted(SERVER_BUDGET_PREVIEWS), preview->item.bytes);
    server_preview_release(again);
    server_surface_retire(surface);
    assert_int_equal(counted(SERVER_BUDGET_PREVIEWS), preview->item.bytes);
    server_preview_release(preview); /* releases the last reference to the evicted preview */
    assert_int_equal(counted(SERVER_BUDGET_PREVIEWS), 0);
}

static void another_number_of_faces_replaces_the_preview(void **state)
{
    (void)state;
    server_preview_release(made(FACES));
    struct server_preview *preview = made(2 * FACES);
    assert_int_equal(preview->polygons.polygon_count, 2 * FACES);
    wait_for_background(); /* the background thread may still hold the replaced surface */
    assert_int_equal(counted(SERVER_BUDGET_PREVIEWS), preview->item.bytes);
    server_preview_release(preview);
}

/* After eviction the preview is read from the store, equal to the last bit. */
static void an_evicted_preview_is_read_again(void **state)
{
    (void)state;
    struct server_preview *before = made(FACES), *after;
    wait_for_background();
    reclaim(1);
    after = made(FACES);
    assert_ptr_not_equal(before, after);
    assert_true(before->largest_distance == after->largest_distance);
    assert_int_equal(before->polygons.polygon_count, after->polygons.polygon_count);
    assert_memory_equal(before->polygons.positions, after->polygons.positions,
                        before->polygons.position_count * sizeof(double[3]));
    server_preview_release(before);
    server_preview_release(after);
}

static void without_memory_one_request_gets_the_error(void **state)
{
    (void)state;
    struct server_preview *preview;
    size_t taken = server.budget.limit - server.budget.total - 1000;
    assert_true(server_budget_take(&server.budget, SERVER_BUDGET_FLIGHT, taken));
    assert_int_equal(await(FACES, &preview), GD_BUDGET);
    wait_for_background();
    server_budget_give(&server.budget, SERVER_BUDGET_FLIGHT, taken);
    server_preview_release(made(FACES));
}

/* An upload queues a preview only of a large mesh. */
static void small_meshes_get_no_preview(void **state)
{
    (void)state;
    server_previews_expect(server.api.previews, surface);
    assert_false(surface->preview.base.is_coming);
    assert_false(server_background_is_busy(server.api.previews));
    assert_false(server_background_is_busy(NULL));
    server_background_stop(NULL);
    server_background_destroy(NULL);
    server_preview_release(NULL);
}

/* A surface that is retired during the build gets no preview, and no reference to it remains. */
static void a_retired_surface_gets_no_preview(void **state)
{
    (void)state;
    struct server_preview *preview = NULL;
    double progress = 0;
    server_surface_release(surface);
    surface = put_sphere(6);
    while (!preview && progress == 0)
        assert_int_equal(
            server_previews_find(server.api.previews, surface, FACES, &preview, &progress), GD_OK);
    server_preview_release(preview);
    server_surface_retire(surface);
    wait_for_background();
    /* the registry's and the test's references */
    while (atomic_load(&surface->references) > 2) sched_yield();
    assert_int_equal(server_previews_find(server.api.previews, surface, FACES, &preview, &progress),
                     GD_OK);
    assert_null(preview);
    assert_int_equal(counted(SERVER_BUDGET_PREVIEWS), 0);
}

#define PREVIEW_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        PREVIEW_TEST(the_preview_is_built_in_the_background_and_counted),
        PREVIEW_TEST(another_number_of_faces_replaces_the_preview),
        PREVIEW_TEST(an_evicted_preview_is_read_again),
        PREVIEW_TEST(without_memory_one_request_gets_the_error),
        PREVIEW_TEST(small_meshes_get_no_preview),
        PREVIEW_TEST(a_retired_surface_gets_no_preview),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
