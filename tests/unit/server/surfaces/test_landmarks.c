/* Tests how the landmarks of a surface are built, stored and evicted. */
#include "tests/unit/server/folder.h"

#include <glob.h>
#include <sched.h>
#include <sys/stat.h>

#include "server/surfaces/field_store.h"
#include "server/surfaces/landmarks.h"
#include "server/server.h"

static struct server server;
static struct server_surface *surface;
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

static enum server_outcome remove_sphere(uint32_t level)
{
    char name[2] = {(char)('0' + level), '\0'};
    const struct server_key key = mesh_key(name);
    return server_registry_remove(server.api.registry, &key, &(struct server_precondition){0});
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

static struct server_background *create_landmarks(uint32_t count)
{
    const struct server_background_parts parts = {.workers = server.host.workers,
                                                  .workspaces = server.host.workspaces,
                                                  .registry = server.api.registry,
                                                  .field_store = server.field_store};
    return server_landmarks_create(&parts, server.host.metrics, count);
}

static int set_up(void **state)
{
    (void)state;
    memset(&server, 0, sizeof server);
    server.config = (struct server_config){.landmarks = 3};
    server_budget_init(&server.budget, 256 << 20);
    server.host.workspaces = server_workspaces_create(&server.budget, 1);
    server.host.workers = server_workers_create(1, 10);
    server.api.cache = server_cache_create(&server.budget, server.host.workers);
    server.api.registry = server_registry_create(server_store_memory_create(), &server.budget);
    server.host.metrics = server_metrics_create(proto_routes, proto_route_count);
    folder_make(folder);
    server.field_store = server_field_store_open(folder, &server.budget);
    server_field_store_follow(server.field_store, server.api.registry);
    server.api.landmarks = create_landmarks(3);
    surface = put_sphere(4);
    return 0;
}

static bool is_building(void)
{
    return server_background_is_busy(server.api.landmarks);
}

static void wait_for_background(void)
{
    while (is_building()) sched_yield();
}

static int tear_down(void **state)
{
    (void)state;
    server_workers_cancel(server.host.workers);
    server_background_stop(server.api.landmarks);
    server_surface_release(surface);
    server_registry_destroy(server.api.registry);
    server_background_destroy(server.api.landmarks);
    server_field_store_close(server.field_store);
    server_cache_destroy(server.api.cache);
    server_workers_destroy(server.host.workers);
    server_workspaces_destroy(server.host.workspaces);
    server_metrics_destroy(server.host.metrics);
    folder_remove(folder);
    assert_int_equal(server.budget.total, 0); /* all counted bytes were returned to the budget */
    return 0;
}

static size_t counted(enum server_budget_class class)
{
    return atomic_load(&server.budget.used[class]);
}

static bool has_landmarks(struct server_surface *of)
{
    struct server_landmark_set *set = server_landmarks_find(server.api.landmarks, of);
    server_landmark_set_release(set);
    return set != NULL;
}

/* Queries until the landmarks exist. */
static struct server_landmark_set *await(struct server_surface *of)
{
    struct server_landmark_set *set;
    while (!(set = server_landmarks_find(server.api.landmarks, of))) sched_yield();
    return set;
}

static void assert_statistics(uint64_t built, uint64_t loaded, uint64_t dropped)
{
    struct server_landmarks_statistics statistics =
        server_landmarks_statistics(server.api.landmarks);
    assert_int_equal(statistics.built, built);
    assert_int_equal(statistics.loaded, loaded);
    assert_int_equal(statistics.dropped, dropped);
}

static void reclaim(size_t bytes)
{
    const struct server_reclaimer *reclaimer = &server.budget.reclaimers[SERVER_RECLAIM_LANDMARKS];
    reclaimer->reclaim(reclaimer->user, bytes);
}

/* Reserves all available memory of the budget, and then returns it. */
static void press(void)
{
    size_t bytes = server_budget_available(&server.budget);
    assert_true(server_budget_take(&server.budget, SERVER_BUDGET_FLIGHT, bytes));
    server_budget_give(&server.budget, SERVER_BUDGET_FLIGHT, bytes);
}

/* Returns the only stored file of landmarks, or "" if there is none. */
static const char *stored_file(void)
{
    static char path[SERVER_DISK_PATH];
    char pattern[SERVER_DISK_PATH];
    glob_t found;
    snprintf(pattern, sizeof pattern, "%s/fields/*/*.landmarks", folder);
    path[0] = '\0';
    if (glob(pattern, 0, NULL, &found) == 0) {
        assert_int_equal(found.gl_pathc, 1);
        snprintf(path, sizeof path, "%s", found.gl_pathv[0]);
    }
    globfree(&found);
    return path;
}

/* --- in memory -------------------------------------------------------------------------------- */

static void landmarks_are_built_in_the_background_and_counted(void **state)
{
    (void)state;
    assert_null(server_landmarks_find(server.api.landmarks, surface));
    struct server_landmark_set *set = await(surface);
    assert_int_equal(gd_landmarks_count(set->landmarks), 3);
    assert_int_equal(counted(SERVER_BUDGET_LANDMARKS), gd_landmarks_memsize(set->landmarks));
    wait_for_background();
    assert_int_equal(counted(SERVER_BUDGET_FLIGHT), 0);
    assert_statistics(1, 0, 0);
    server_surface_retire(surface);
    assert_false(has_landmarks(surface));
    assert_true(counted(SERVER_BUDGET_LANDMARKS) > 0);
    server_landmark_set_release(set); /* releases the last reference to the evicted set */
    assert_int_equal(counted(SERVER_BUDGET_LANDMARKS), 0);
}

static void small_meshes_get_no_landmarks(void **state)
{
    (void)state;
    struct server_surface *small = put_sphere(3);
    assert_false(has_landmarks(small));
    wait_for_background();
    assert_false(has_landmarks(small));
    assert_statistics(0, 0, 0);
    assert_null(server_landmarks_find(NULL, surface));
    server_surface_release(small);
}

static void short_memory_evicts_the_least_recently_used_first(void **state)
{
    (void)state;
    struct server_surface *other = put_sphere(5);
    server_landmark_set_release(await(surface));
    server_landmark_set_release(await(other));
    /* uses this set, so that the other set is the least recently used */
    assert_true(has_landmarks(surface));
    reclaim(1);
    assert_true(has_landmarks(surface));
    assert_false(has_landmarks(other));
    assert_statistics(2, 0, 1);
    press();
    assert_false(has_landmarks(surface));
    assert_int_equal(counted(SERVER_BUDGET_LANDMARKS), 0);
    server_landmark_set_release(await(surface)); /* after the pause they are read from the disk */
    assert_statistics(2, 1, 2);
    server_surface_release(other);
}

/* Makes the thread build the landmarks of a large surface. This build takes longer than a test. */
static struct server_surface *occupy_thread(void)
{
    struct server_surface *large = put_sphere(6);
    assert_false(has_landmarks(large));
    while (atomic_load(&large->references) < 3) sched_yield(); /* waits until the build has begun */
    return large;
}

static void short_memory_ends_the_running_build(void **state)
{
    (void)state;
    struct server_surface *large = occupy_thread();
    assert_false(has_landmarks(surface));
    assert_true(is_building());
    assert_int_equal(surface->references, 2); /* the queued build holds no reference */
    reclaim(1);
    server_landmark_set_release(await(surface)); /* the next build */
    assert_false(has_landmarks(large));
    assert_statistics(1, 0, 0);
    server_surface_release(large);
}

static void retired_surfaces_get_no_landmarks(void **state)
{
    (void)state;
    struct server_surface *large = occupy_thread();
    assert_false(has_landmarks(surface));
    assert_true(is_building());
    assert_int_equal(remove_sphere(4), SERVER_STORE_DONE);
    /* the reference ends immediately, because a queued slot holds no reference */
    assert_int_equal(surface->references, 1);
    assert_int_equal(remove_sphere(6), SERVER_STORE_DONE);
    wait_for_background();
    /* The build under way was ended, too. Its thread releases the surface last. */
    while (atomic_load(&large->references) != 1) sched_yield();
    assert_false(has_landmarks(surface));
    assert_int_equal(counted(SERVER_BUDGET_LANDMARKS), 0);
    assert_string_equal(stored_file(), "");
    server_surface_release(large);
}

static void a_build_waits_for_free_memory(void **state)
{
    (void)state;
    size_t taken = server.budget.limit - server.budget.total - 1000;
    assert_true(server_budget_take(&server.budget, SERVER_BUDGET_FLIGHT, taken));
    assert_false(has_landmarks(surface));
    wait_for_background();
    assert_statistics(0, 0, 0);
    server_budget_give(&server.budget, SERVER_BUDGET_FLIGHT, taken);
    server_landmark_set_release(await(surface));
    assert_statistics(1, 0, 0);
}

static void a_too_expensive_build_is_not_begun(void **state)
{
    (void)state;
    struct server_landmark_slot *slot = &surface->landmarks;
    size_t limit = server.budget.limit;
    server.budget.limit = server.budget.total + (4 << 20); /* a build of this mesh takes 2.7 MB */
    assert_false(has_landmarks(surface));
    wait_for_background();
    assert_int_equal(slot->not_before_ns, UINT64_MAX);
    assert_statistics(0, 0, 0);
    server.budget.limit = limit;
}

/* --- on the disk ------------------------------------------------------------------------------ */

/* Loads the surface again. */
static void reload(void)
{
    server_surface_release(surface);
    assert_int_equal(remove_sphere(4), SERVER_STORE_DONE);
    surface = put_sphere(4);
}

/* Loads the surface again. Keeps the stored file, which is deleted when the surface is removed. */
static void reload_with_file(void)
{
    char path[SERVER_DISK_PATH], kept[SERVER_DISK_PATH], parent[SERVER_DISK_PATH];
    snprintf(path, sizeof path, "%s", stored_file());
    snprintf(kept, sizeof kept, "%s/kept", folder);
    snprintf(parent, sizeof parent, "%.*s", (int)(strrchr(path, '/') - path), path);
    assert_int_equal(rename(path, kept), 0);
    reload();
    assert_int_equal(mkdir(parent, 0700), 0);
    assert_int_equal(rename(kept, path), 0);
}

static void stored_landmarks_are_read(void **state)
{
    (void)state;
    server_landmark_set_release(await(surface));
    reload_with_file();
    struct server_landmark_set *set = await(surface);
    assert_int_equal(gd_landmarks_count(set->landmarks), 3);
    assert_int_equal(counted(SERVER_BUDGET_LANDMARKS), set->item.bytes);
    server_landmark_set_release(set);
    assert_statistics(1, 1, 0);
}

static void damaged_landmarks_are_rebuilt(void **state)
{
    (void)state;
    server_landmark_set_release(await(surface));
    reload_with_file();
    FILE *file = fopen(stored_file(), "r+b");
    assert_non_null(file);
    fseek(file, 5000, SEEK_SET);
    int byte = fgetc(file);
    fseek(file, 5000, SEEK_SET);
    fputc(byte ^ 1, file);
    fclose(file);
    server_landmark_set_release(await(surface));
    assert_statistics(2, 0, 0);
    reload_with_file(); /* the new file is complete */
    server_landmark_set_release(await(surface));
    assert_statistics(2, 1, 0);
}

static void a_changed_number_of_landmarks_causes_a_rebuild(void **state)
{
    (void)state;
    server_landmark_set_release(await(surface));
    reload_with_file();
    server_background_destroy(server.api.landmarks);
    server.api.landmarks = create_landmarks(2);
    struct server_landmark_set *set = await(surface);
    assert_int_equal(gd_landmarks_count(set->landmarks), 2);
    server_landmark_set_release(set);
    assert_statistics(1, 0, 0);
    assert_string_not_equal(stored_file(), ""); /* only one file */
}

static void the_file_is_deleted_with_the_mesh(void **state)
{
    (void)state;
    server_landmark_set_release(await(surface));
    assert_string_not_equal(stored_file(), "");
    reload();
    assert_string_equal(stored_file(), "");
}

/* --- all at once ------------------------------------------------------------------------------ */

static void *find_and_press(void *user)
{
    for (int i = 0; i < 3000; i++) {
        struct server_landmark_set *set = server_landmarks_find(server.api.landmarks, surface);
        if (set) assert_int_equal(gd_landmarks_count(set->landmarks), 3);
        server_landmark_set_release(set);
        if (user && i % 200 == 0) reclaim(1);
        sched_yield();
    }
    return NULL;
}

static void many_threads_at_once(void **state)
{
    (void)state;
    pthread_t threads[4];
    for (size_t i = 0; i < COUNT(threads); i++)
        pthread_create(&threads[i], NULL, find_and_press, i ? NULL : threads);
    for (size_t i = 0; i < COUNT(threads); i++) pthread_join(threads[i], NULL);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(landmarks_are_built_in_the_background_and_counted),
        TEST(small_meshes_get_no_landmarks),
        TEST(short_memory_evicts_the_least_recently_used_first),
        TEST(short_memory_ends_the_running_build),
        TEST(retired_surfaces_get_no_landmarks),
        TEST(a_build_waits_for_free_memory),
        TEST(a_too_expensive_build_is_not_begun),
        TEST(stored_landmarks_are_read),
        TEST(damaged_landmarks_are_rebuilt),
        TEST(a_changed_number_of_landmarks_causes_a_rebuild),
        TEST(the_file_is_deleted_with_the_mesh),
        TEST(many_threads_at_once),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
