#include "folder.h"

#include <sys/stat.h>

static int set_up(void **state)
{
    char *folder = malloc(FOLDER_PATH);
    folder_make(folder);
    *state = folder;
    return 0;
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

/* Writes the text as that file of the folder. */
static enum server_disk_result write_text(const char *folder, const char *name, const char *text)
{
    char path[SERVER_DISK_PATH], temporary[SERVER_DISK_PATH];
    path_in(folder, path, name);
    path_in(folder, temporary, "temporary");
    return server_disk_write(folder, path, temporary, text, strlen(text));
}

static void assert_text(const char *folder, const char *name, const char *text)
{
    char path[SERVER_DISK_PATH];
    void *bytes;
    size_t size;
    path_in(folder, path, name);
    assert_int_equal(server_disk_read(path, &bytes, &size), SERVER_DISK_DONE);
    assert_int_equal(size, strlen(text));
    assert_string_equal(bytes, text);
    free(bytes);
    assert_int_equal(server_disk_size(path, &size), SERVER_DISK_DONE);
    assert_int_equal(size, strlen(text));
}

static void files_are_written_whole(void **state)
{
    const char *folder = *state;
    assert_int_equal(write_text(folder, "a", "first"), SERVER_DISK_DONE);
    assert_int_equal(write_text(folder, "a", ""), SERVER_DISK_DONE);
    assert_text(folder, "a", "");
    assert_int_equal(write_text(folder, "a", "second"), SERVER_DISK_DONE);
    assert_text(folder, "a", "second");
}

static void a_file_that_cant_be_written_leaves_nothing(void **state)
{
    const char *folder = *state;
    char path[SERVER_DISK_PATH];
    path_in(folder, path, "taken");
    assert_int_equal(server_disk_make_folder(path), SERVER_DISK_DONE);
    assert_int_equal(write_text(folder, "taken", "x"), SERVER_DISK_REFUSED);
    path_in(folder, path, "temporary");
    assert_int_not_equal(access(path, F_OK), 0);
    assert_int_equal(write_text("/nowhere/at/all", "a", "x"), SERVER_DISK_ABSENT);
}

static void what_is_absent_is_told(void **state)
{
    const char *folder = *state;
    char path[SERVER_DISK_PATH];
    void *bytes;
    size_t size;
    path_in(folder, path, "nothing");
    assert_int_equal(server_disk_read(path, &bytes, &size), SERVER_DISK_ABSENT);
    assert_int_equal(server_disk_size(path, &size), SERVER_DISK_ABSENT);
    assert_int_equal(server_disk_remove(folder, path), SERVER_DISK_ABSENT);
    assert_int_equal(server_disk_sync_folder(path), SERVER_DISK_ABSENT);
    assert_int_equal(server_disk_link(path, "/nowhere"), SERVER_DISK_ABSENT);
    assert_int_equal(server_disk_read(folder, &bytes, &size), SERVER_DISK_REFUSED); /* a folder is no file */
}

static void links_are_second_names(void **state)
{
    const char *folder = *state;
    char path[SERVER_DISK_PATH], second[SERVER_DISK_PATH];
    path_in(folder, path, "a");
    path_in(folder, second, "b");
    write_text(folder, "a", "text");
    assert_int_equal(server_disk_link(path, second), SERVER_DISK_DONE);
    assert_int_equal(server_disk_link(path, second), SERVER_DISK_REFUSED);
    assert_int_equal(server_disk_remove(folder, path), SERVER_DISK_DONE);
    assert_text(folder, "b", "text");
}

static void add_and_remove(void *user, const char *path, const char *name)
{
    strcat(user, name);
    assert_int_equal(remove(path), 0);
}

static void a_folder_is_walked_while_it_is_emptied(void **state)
{
    const char *folder = *state;
    char names[64] = "", path[SERVER_DISK_PATH];
    write_text(folder, "a", "");
    write_text(folder, ".hidden", "");
    assert_true(server_disk_each(folder, add_and_remove, names));
    assert_string_equal(names, "a");
    assert_true(server_disk_each(folder, add_and_remove, names));
    assert_string_equal(names, "a");
    path_in(folder, path, ".hidden");
    assert_int_equal(access(path, F_OK), 0);
    assert_false(server_disk_each(path, add_and_remove, names));
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(files_are_written_whole), TEST(a_file_that_cant_be_written_leaves_nothing), TEST(what_is_absent_is_told),
        TEST(links_are_second_names),  TEST(a_folder_is_walked_while_it_is_emptied),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
