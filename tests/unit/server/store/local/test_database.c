#include "tests/unit/server/folder.h"

#include <sqlite3.h>

#include "server/store/local/local.h"

struct fixture {
    char folder[FOLDER_PATH], path[FOLDER_PATH + 32], copy[FOLDER_PATH + 32];
    sqlite3 *database;
};

static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    folder_make(fixture->folder);
    snprintf(fixture->path, sizeof fixture->path, "%s/a.db", fixture->folder);
    snprintf(fixture->copy, sizeof fixture->copy, "%s/copy.db", fixture->folder);
    assert_int_equal(sqlite3_open(fixture->path, &fixture->database), SQLITE_OK);
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    sqlite3_close(fixture->database);
    folder_remove(fixture->folder);
    free(fixture);
    return 0;
}

static const char *const steps[] = {
    "CREATE TABLE t (a INTEGER); INSERT INTO t VALUES (7);",
    "ALTER TABLE t ADD COLUMN b INTEGER NOT NULL DEFAULT 1;",
    "UPDATE t SET b = a + 1;",
};
static const char *const wrong_steps[] = {
    "CREATE TABLE t (a INTEGER); INSERT INTO t VALUES (7);",
    "INSERT INTO t VALUES (8); INSERT INTO nowhere VALUES (1);",
};

static int64_t number(sqlite3 *database, const char *sql)
{
    sqlite3_stmt *statement;
    assert_int_equal(sqlite3_prepare_v2(database, sql, -1, &statement, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_step(statement), SQLITE_ROW);
    int64_t found = sqlite3_column_int64(statement, 0);
    sqlite3_finalize(statement);
    return found;
}

static void creates_a_new_database_without_a_copy(void **state)
{
    struct fixture *fixture = *state;
    assert_int_equal(server_sqlite_migrate(fixture->database, steps, 3, fixture->copy),
                     SERVER_STORE_DONE);
    assert_int_equal(number(fixture->database, "SELECT b FROM t"), 8);
    assert_int_equal(number(fixture->database, "PRAGMA user_version"), 3);
    assert_int_not_equal(access(fixture->copy, F_OK), 0);
}

static void migrates_an_older_database_after_a_copy(void **state)
{
    struct fixture *fixture = *state;
    sqlite3 *copy;
    assert_int_equal(server_sqlite_migrate(fixture->database, steps, 1, fixture->copy),
                     SERVER_STORE_DONE);
    assert_int_equal(server_sqlite_migrate(fixture->database, steps, 1, fixture->copy),
                     SERVER_STORE_DONE);
    assert_int_not_equal(access(fixture->copy, F_OK), 0); /* the database needed no migration */
    assert_int_equal(server_sqlite_migrate(fixture->database, steps, 3, fixture->copy),
                     SERVER_STORE_DONE);
    assert_int_equal(number(fixture->database, "SELECT b FROM t"), 8);
    assert_int_equal(sqlite3_open(fixture->copy, &copy), SQLITE_OK);
    assert_int_equal(number(copy, "SELECT a FROM t"), 7);
    assert_int_equal(number(copy, "PRAGMA user_version"), 1);
    sqlite3_close(copy);
}

static void a_step_that_fails_changes_nothing(void **state)
{
    struct fixture *fixture = *state;
    assert_int_equal(server_sqlite_migrate(fixture->database, wrong_steps, 1, fixture->copy),
                     SERVER_STORE_DONE);
    assert_int_equal(server_sqlite_migrate(fixture->database, wrong_steps, 2, fixture->copy),
                     SERVER_STORE_DAMAGED);
    assert_int_equal(number(fixture->database, "SELECT count(*) FROM t"), 1);
    assert_int_equal(number(fixture->database, "PRAGMA user_version"), 1);
}

static void an_unknown_version_is_damage(void **state)
{
    struct fixture *fixture = *state;
    sqlite3_exec(fixture->database, "PRAGMA user_version = 99", NULL, NULL, NULL);
    assert_int_equal(server_sqlite_migrate(fixture->database, steps, 3, fixture->copy),
                     SERVER_STORE_DAMAGED);
    sqlite3_exec(fixture->database, "PRAGMA user_version = -1", NULL, NULL, NULL);
    assert_int_equal(server_sqlite_migrate(fixture->database, steps, 3, fixture->copy),
                     SERVER_STORE_DAMAGED);
}

static void codes_become_outcomes(void **state)
{
    (void)state;
    assert_int_equal(server_sqlite_outcome(SQLITE_DONE), SERVER_STORE_DONE);
    assert_int_equal(server_sqlite_outcome(SQLITE_FULL), SERVER_STORE_FULL);
    assert_int_equal(server_sqlite_outcome(SQLITE_IOERR_SHMSIZE), SERVER_STORE_FULL);
    assert_int_equal(server_sqlite_outcome(SQLITE_IOERR_FSYNC), SERVER_STORE_READ_ONLY);
    assert_int_equal(server_sqlite_outcome(SQLITE_IOERR_WRITE), SERVER_STORE_READ_ONLY);
    assert_int_equal(server_sqlite_outcome(SQLITE_NOMEM), SERVER_STORE_NO_MEMORY);
    assert_int_equal(server_sqlite_outcome(SQLITE_IOERR_NOMEM), SERVER_STORE_NO_MEMORY);
    assert_int_equal(server_sqlite_outcome(SQLITE_CANTOPEN), SERVER_STORE_REFUSED);
    assert_int_equal(server_sqlite_outcome(SQLITE_CORRUPT_INDEX), SERVER_STORE_DAMAGED);
    assert_int_equal(server_sqlite_outcome(SQLITE_NOTADB), SERVER_STORE_DAMAGED);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(creates_a_new_database_without_a_copy), TEST(migrates_an_older_database_after_a_copy),
        TEST(a_step_that_fails_changes_nothing),     TEST(an_unknown_version_is_damage),
        cmocka_unit_test(codes_become_outcomes),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
