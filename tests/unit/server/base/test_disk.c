#include "tests/unit/server/folder.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>

static int set_up(void **state)
{
    char *folder = malloc(FOLDER_PATH);
    folder_make(folder);
    *state = folder;
    return 0;
}

/* Forbids opening files. Returns the old limit. */
static struct rlimit use_up_descriptors(void)
{
    struct rlimit limit, none;
    int next = open("/", O_RDONLY);
    close(next);
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &limit), 0);
    none = (struct rlimit){.rlim_cur = (rlim_t)next, .rlim_max = limit.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
    return limit;
}

static int tear_down(void **state)
{
    folder_remove(*state);
    free(*state);
    return 0;
}

static void path_in(const char *folder, char path[SERVER_DISK_PATH], const char *name)
{
    snprintf(path, SERVER_DISK_PATH, "%s/%s", folder, name);
}

/* Writes the text to the file with that name in the folder. */
static enum server_outcome write_text(const char *folder, const char *name, const char *text)
{
    char path[SERVER_DISK_PATH], temporary[SERVER_DISK_PATH];
    path_in(folder, path, name);
    path_in(folder, temporary, "temporary");
    return server_disk_write(path, temporary, text, strlen(text));
}

static void assert_text(const char *folder, const char *name, const char *text)
{
    char path[SERVER_DISK_PATH];
    void *bytes;
    size_t size;
    path_in(folder, path, name);
    assert_int_equal(server_disk_read(path, &bytes, &size), SERVER_STORE_DONE);
    assert_int_equal(size, strlen(text));
    assert_string_equal(bytes, text);
    free(bytes);
}

static void files_are_written_whole(void **state)
{
    const char *folder = *state;
    assert_int_equal(write_text(folder, "a", "first"), SERVER_STORE_DONE);
    assert_int_equal(write_text(folder, "a", ""), SERVER_STORE_DONE);
    assert_text(folder, "a", "");
    assert_int_equal(write_text(folder, "a", "second"), SERVER_STORE_DONE);
    assert_text(folder, "a", "second");
}

static void a_failed_write_leaves_no_file(void **state)
{
    const char *folder = *state;
    char path[SERVER_DISK_PATH];
    path_in(folder, path, "taken");
    assert_int_equal(server_disk_make_folder(path), SERVER_STORE_DONE);
    assert_int_equal(write_text(folder, "taken", "x"), SERVER_STORE_REFUSED);
    path_in(folder, path, "temporary");
    assert_int_not_equal(access(path, F_OK), 0);
    assert_int_equal(write_text("/nowhere/at/all", "a", "x"), SERVER_STORE_REFUSED);
}

static void missing_files_are_absent(void **state)
{
    const char *folder = *state;
    char path[SERVER_DISK_PATH];
    void *bytes;
    size_t size;
    path_in(folder, path, "nothing");
    assert_int_equal(server_disk_read(path, &bytes, &size), SERVER_STORE_ABSENT);
    assert_int_equal(server_disk_remove(path), SERVER_STORE_ABSENT);
    assert_int_equal(server_disk_sync_folder(path), SERVER_STORE_ABSENT);
    assert_int_equal(server_disk_link(path, "/nowhere"), SERVER_STORE_ABSENT);
    /* a folder is not a file */
    assert_int_equal(server_disk_read(folder, &bytes, &size), SERVER_STORE_REFUSED);
}

static void links_are_second_names(void **state)
{
    const char *folder = *state;
    char path[SERVER_DISK_PATH], second[SERVER_DISK_PATH];
    path_in(folder, path, "a");
    path_in(folder, second, "b");
    write_text(folder, "a", "text");
    assert_int_equal(server_disk_link(path, second), SERVER_STORE_DONE);
    assert_int_equal(server_disk_link(path, second), SERVER_STORE_REFUSED);
    assert_int_equal(server_disk_remove(path), SERVER_STORE_DONE);
    assert_text(folder, "b", "text");
}

/* Sums the bytes of the pieces, until there are more than 600,000. */
static bool add_up(void *user, const void *bytes, size_t size)
{
    struct scanned {
        size_t bytes, pieces;
    } *scanned = user;
    for (size_t i = 0; i < size; i++) assert_int_equal(((const char *)bytes)[i], 'x');
    scanned->bytes += size;
    scanned->pieces++;
    return scanned->bytes <= 600000;
}

static void large_files_are_read_piece_by_piece(void **state)
{
    const char *folder = *state;
    char path[SERVER_DISK_PATH], copy[SERVER_DISK_PATH], *text = malloc(1000001);
    size_t scanned[2] = {0};
    struct stat facts;
    assert_non_null(text);
    memset(text, 'x', 1000000);
    text[1000000] = '\0';
    write_text(folder, "large", text);
    text[250000] = '\0';
    write_text(folder, "small", text);
    path_in(folder, path, "large");
    assert_int_equal(server_disk_scan(path, add_up, scanned), SERVER_STORE_DONE);
    assert_int_equal(scanned[0], 3 << 18);
    assert_int_equal(scanned[1], 3);
    path_in(folder, path, "small");
    scanned[0] = 0;
    assert_int_equal(server_disk_scan(path, add_up, scanned), SERVER_STORE_DONE);
    assert_int_equal(scanned[0], 250000);
    path_in(folder, copy, "copy");
    assert_int_equal(server_disk_copy(path, copy), SERVER_STORE_DONE);
    assert_int_equal(server_disk_copy(path, copy), SERVER_STORE_REFUSED);
    assert_int_equal(server_disk_remove(path), SERVER_STORE_DONE);
    assert_int_equal(stat(copy, &facts), 0);
    assert_int_equal(facts.st_size, 250000);
    assert_int_equal(server_disk_scan(path, add_up, scanned), SERVER_STORE_ABSENT);
    assert_int_equal(server_disk_scan(folder, add_up, scanned), SERVER_STORE_REFUSED);
    free(text);
}

static void add_and_remove(void *user, const char *path, const char *name)
{
    strcat(user, name);
    assert_int_equal(remove(path), 0);
}

static void a_folder_can_be_emptied_while_it_is_listed(void **state)
{
    const char *folder = *state;
    char names[64] = "", path[SERVER_DISK_PATH];
    write_text(folder, "a", "");
    write_text(folder, ".hidden", "");
    assert_true(folder_each(folder, add_and_remove, names));
    assert_string_equal(names, "a");
    assert_true(folder_each(folder, add_and_remove, names));
    assert_string_equal(names, "a");
    path_in(folder, path, ".hidden");
    assert_int_equal(access(path, F_OK), 0);
    assert_false(folder_each(path, add_and_remove, names));
}

/* Without a descriptor a change can't be made durable, so nothing changes. */
static void without_descriptors_nothing_changes(void **state)
{
    const char *folder = *state;
    char file[SERVER_DISK_PATH], inner[SERVER_DISK_PATH];
    path_in(folder, file, "a");
    path_in(folder, inner, "inner");
    assert_int_equal(write_text(folder, "a", "first"), SERVER_STORE_DONE);
    struct rlimit limit = use_up_descriptors();
    enum server_outcome written = write_text(folder, "a", "second"),
                        removed = server_disk_remove(file), made = server_disk_make_folder(inner),
                        there = server_disk_make_folder(folder);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &limit), 0);
    assert_int_equal(written, SERVER_STORE_REFUSED);
    assert_int_equal(removed, SERVER_STORE_REFUSED);
    assert_int_equal(made, SERVER_STORE_REFUSED);
    assert_int_equal(there, SERVER_STORE_DONE);
    assert_text(folder, "a", "first");
    assert_int_not_equal(access(inner, F_OK), 0);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(files_are_written_whole),
        TEST(a_failed_write_leaves_no_file),
        TEST(missing_files_are_absent),
        TEST(links_are_second_names),
        TEST(large_files_are_read_piece_by_piece),
        TEST(a_folder_can_be_emptied_while_it_is_listed),
        TEST(without_descriptors_nothing_changes),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
