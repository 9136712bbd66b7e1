#include "tests/unit/server/folder.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "gd/control.h"
#include "server/surfaces/field_store.h"

#define FIELDS 3

struct fixture {
    char folder[FOLDER_PATH];
    struct server_budget budget;
    struct server_workers *workers;
    struct server_cache *cache;
    struct server_registry *registry;
    struct server_field_store *store;
    struct server_surface *surface;
};

static struct server_surface *new_surface(struct fixture *fixture)
{
    struct gd_mesh *mesh = new_mesh();
    struct server_record *record = new_record("ball", "bytes of a ball");
    assert_true(server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, gd_mesh_memsize(mesh)));
    struct server_surface *surface = server_surface_create(record, mesh, gd_mesh_memsize(mesh),
                                                           &fixture->budget, fixture->cache);
    server_record_release(record);
    return surface;
}

/* Adds the field of that vertex to the surface's mesh cache. */
static void compute(struct fixture *fixture, struct server_surface *surface, uint32_t vertex)
{
    struct gd_point source = vertex_point(surface->mesh, vertex);
    struct gd_field *field = new_field(surface->mesh, &source);
    assert_true(
        server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, gd_field_memsize(field)));
    server_cache_restore(surface->fields, field);
}

/* Stores FIELDS fields, and creates a surface without any of them. */
static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    folder_make(fixture->folder);
    server_budget_init(&fixture->budget, (size_t)1 << 30);
    fixture->workers = server_workers_create(1, 1);
    fixture->cache = server_cache_create(&fixture->budget, fixture->workers);
    fixture->registry = server_registry_create(server_store_memory_create(), &fixture->budget);
    fixture->store = server_field_store_open(fixture->folder, &fixture->budget);
    struct server_surface *first = new_surface(fixture);
    for (uint32_t i = 0; i < FIELDS; i++) compute(fixture, first, i);
    server_registry_put(fixture->registry, first, "bytes of a ball",
                        &(struct server_precondition){0});
    server_field_store_save(fixture->store, fixture->registry, UINT64_MAX);
    server_surface_release(first);
    fixture->surface = new_surface(fixture);
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    server_surface_release(fixture->surface);
    server_field_store_close(fixture->store);
    server_registry_destroy(fixture->registry);
    server_cache_destroy(fixture->cache);
    server_workers_destroy(fixture->workers);
    assert_int_equal(fixture->budget.total, 0);
    folder_remove(fixture->folder);
    free(fixture);
    return 0;
}

struct files {
    void (*act)(const char *path);
    uint32_t count;
};

static void on_file(void *user, const char *path, const char *name)
{
    struct files *files = user;
    (void)name;
    if (files->act) files->act(path);
    files->count++;
}

static void on_folder(void *user, const char *path, const char *name)
{
    (void)name;
    assert_true(folder_each(path, on_file, user));
}

/* Calls `act`, unless it is NULL, for each stored file. Returns the number of files. */
static uint32_t each_file(const struct fixture *fixture, void (*act)(const char *path))
{
    struct files files = {.act = act};
    char path[SERVER_DISK_PATH];
    snprintf(path, sizeof path, "%s/fields", fixture->folder);
    assert_true(folder_each(path, on_folder, &files));
    return files.count;
}

static void restore(struct fixture *fixture, const struct gd_control *control)
{
    server_field_store_restore(fixture->store, fixture->surface, control);
}

static uint32_t restored(const struct fixture *fixture)
{
    return server_mesh_cache_count(fixture->surface->fields);
}

static void fields_are_restored(void **state)
{
    struct fixture *fixture = *state;
    assert_int_equal(each_file(fixture, NULL), FIELDS);
    restore(fixture, NULL);
    assert_int_equal(restored(fixture), FIELDS);
    assert_int_equal(fixture->budget.used[SERVER_BUDGET_FLIGHT], 0);
}

static void cut_off(const char *path)
{
    assert_int_equal(truncate(path, 0), 0);
}

static void later_changes_of_files_do_no_harm(void **state)
{
    struct fixture *fixture = *state;
    uint32_t count;
    restore(fixture, NULL);
    each_file(fixture, cut_off);
    const struct server_cached **fields =
        server_mesh_cache_pin_points(fixture->surface->fields, &count);
    assert_int_equal(count, FIELDS);
    for (uint32_t i = 0; i < count; i++) {
        struct gd_point target = vertex_point(fixture->surface->mesh, 50);
        double distance = 0;
        assert_int_equal(gd_field_distance(fields[i]->field, &target, &distance), GD_OK);
        assert_true(distance > 0);
        server_cache_unpin(fields[i]);
    }
    free(fields);
}

static void change_a_byte(const char *path)
{
    FILE *file = fopen(path, "r+e");
    assert_non_null(file);
    assert_int_equal(fseek(file, 100, SEEK_SET), 0);
    int byte = fgetc(file);
    assert_int_equal(fseek(file, 100, SEEK_SET), 0);
    fputc(byte ^ 1, file);
    fclose(file);
}

static void a_damaged_file_is_deleted(void **state)
{
    struct fixture *fixture = *state;
    each_file(fixture, change_a_byte);
    restore(fixture, NULL);
    assert_int_equal(restored(fixture), 0);
    assert_int_equal(each_file(fixture, NULL), 0);
}

static void an_unreadable_file_is_kept(void **state)
{
    struct fixture *fixture = *state;
    struct rlimit before, none;
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    none = before;
    int next = dup(0); /* the folder gets this descriptor, and no descriptor is left for files */
    close(next);
    none.rlim_cur = (rlim_t)next + 1;
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
    restore(fixture, NULL);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
    assert_int_equal(restored(fixture), 0);
    assert_int_equal(each_file(fixture, NULL), FIELDS);
    restore(fixture, NULL);
    assert_int_equal(restored(fixture), FIELDS);
}

static void change_the_access_time(const char *path)
{
    const struct timespec times[2] = {{.tv_sec = 1}, {.tv_sec = 2}};
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
}

static void assert_never_read(const char *path)
{
    struct stat facts;
    assert_int_equal(stat(path, &facts), 0);
    assert_int_equal(facts.st_atim.tv_sec, 1);
}

static void without_memory_no_file_is_read(void **state)
{
    struct fixture *fixture = *state;
    each_file(fixture, change_the_access_time);
    fixture->budget.limit = fixture->budget.total + 1000;
    restore(fixture, NULL);
    fixture->budget.limit = (size_t)1 << 30;
    assert_int_equal(restored(fixture), 0);
    each_file(fixture, assert_never_read);
}

static bool cancel(void *user, double fraction)
{
    int *left = user;
    (void)fraction;
    return (*left)-- > 0;
}

static void the_control_ends_restoring(void **state)
{
    struct fixture *fixture = *state;
    int files = 1;
    restore(fixture, &(struct gd_control){.deadline_ns = 1});
    assert_int_equal(restored(fixture), 0);
    restore(fixture, &(struct gd_control){.progress = cancel, .user = &files});
    assert_int_equal(restored(fixture), 1);
    assert_int_equal(each_file(fixture, NULL), FIELDS);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(fields_are_restored),
        TEST(later_changes_of_files_do_no_harm),
        TEST(a_damaged_file_is_deleted),
        TEST(an_unreadable_file_is_kept),
        TEST(without_memory_no_file_is_read),
        TEST(the_control_ends_restoring),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
