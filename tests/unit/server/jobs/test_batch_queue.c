/* Tests the queue of batches with each database: SQLite in memory, and PostgreSQL if
 * GEODESICD_TEST_STORE names a database. */
#include "tests/unit/server/folder.h"
#include "tests/unit/server/support.h"

#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>

#include "server/jobs/batch_queue.h"

#define ID_A "000000000000000000000001"
#define ID_B "000000000000000000000002"

static int set_up_local(void **state)
{
    char error[SERVER_ERROR] = "";
    struct server_store_sql *sql =
        server_store_sql_local_open(":memory:", server_batch_queue_tables, error);
    if (!sql) fail_msg("%s", error);
    *state = sql;
    return 0;
}

static int set_up_shared(void **state)
{
    const char *url = getenv("GEODESICD_TEST_STORE");
    char error[SERVER_ERROR] = "";
    *state = NULL;
    if (!url) return 0;
    /* opening the store makes the tables */
    struct server_store *store = server_store_postgres_open(url, error);
    if (!store) fail_msg("%s", error);
    store->close(store);
    struct server_store_sql *sql = server_store_sql_postgres_open(url);
    assert_int_equal(sql->run(sql, SERVER_SQL("DELETE FROM batches")), SERVER_STORE_DONE);
    assert_int_equal(sql->run(sql, SERVER_SQL("DELETE FROM items")), SERVER_STORE_DONE);
    *state = sql;
    return 0;
}

static int tear_down(void **state)
{
    struct server_store_sql *sql = *state;
    if (sql) sql->close(sql);
    return 0;
}

static struct server_store_sql *sql_of(void **state)
{
    if (!*state) {
        print_message(
            "# skipped: tests/cluster/test_suites.py runs it with GEODESICD_TEST_STORE\n");
        skip();
    }
    return *state;
}

static void add(struct server_store_sql *sql, const char *id, const char *tenant, int64_t items)
{
    struct proto_many_state batch = {.items = items, .created = 1763730000};
    snprintf(batch.id, sizeof batch.id, "%s", id);
    const struct server_batch_order order = {&batch, tenant, "{\"a\":\0}", 7, "tag"};
    for (int i = 0; i < 2; i++) /* sends the answer twice, as after a lost response */
        assert_int_equal(server_batch_queue_add(sql, &order), SERVER_STORE_DONE);
}

static struct server_batch_claim claim_after(struct server_store_sql *sql, const char *node,
                                             const char *after)
{
    struct server_batch_claim claim = {.id = ""};
    enum server_outcome outcome = server_batch_queue_claim(sql, node, after, &claim);
    assert_true(outcome == SERVER_STORE_DONE || outcome == SERVER_STORE_ABSENT);
    if (outcome) claim.item = -1;
    return claim;
}

static struct server_batch_claim claim(struct server_store_sql *sql, const char *node)
{
    return claim_after(sql, node, "");
}

static struct proto_many_state find(struct server_store_sql *sql, const char *tenant,
                                    const char *id)
{
    struct proto_many_state batch;
    assert_int_equal(server_batch_queue_find(sql, tenant, id, &batch), SERVER_STORE_DONE);
    return batch;
}

static void answer(struct server_store_sql *sql, const char *id, int64_t item, unsigned status,
                   const char *text)
{
    struct server_batch_claim claim = {.item = item};
    strcpy(claim.id, id);
    assert_int_equal(server_batch_queue_answer(sql, &claim, status, text, strlen(text)),
                     SERVER_STORE_DONE);
}

/* --- tests ------------------------------------------------------------------------------------ */

static void a_batch_is_visible_to_its_tenant_only(void **state)
{
    struct server_store_sql *sql = sql_of(state);
    struct proto_many_state batch, batches[4];
    struct server_batch_list list = {.batches = batches, .most = 4};
    int64_t total;
    void *document;
    size_t size;
    add(sql, ID_A, "ann", 3);
    add(sql, ID_B, "ann", 1);
    assert_int_equal(server_batch_queue_find(sql, "bob", ID_A, &batch), SERVER_STORE_ABSENT);
    batch = find(sql, "ann", ID_A);
    assert_int_equal(batch.items, 3);
    assert_int_equal(batch.created, 1763730000);
    assert_int_equal(batch.done + batch.failed + batch.is_cancelled, 0);
    assert_int_equal(server_batch_queue_count(sql, "ann", &total), SERVER_STORE_DONE);
    assert_int_equal(total, 2);
    assert_int_equal(server_batch_queue_list(sql, "ann", "", &list), SERVER_STORE_DONE);
    assert_int_equal(list.count, 2);
    assert_int_equal(server_batch_queue_list(sql, "ann", ID_A, &list), SERVER_STORE_DONE);
    assert_int_equal(list.count, 1);
    assert_string_equal(batches[0].id, ID_B);
    assert_int_equal(server_batch_queue_document(sql, ID_A, &document, &size), SERVER_STORE_DONE);
    assert_int_equal(size, 7);
    assert_memory_equal(document, "{\"a\":\0}", 7);
    free(document);
}

static void each_item_is_claimed_once_in_order_of_batches(void **state)
{
    struct server_store_sql *sql = sql_of(state);
    add(sql, ID_B, "", 1);
    add(sql, ID_A, "ann", 2);
    struct server_batch_claim first = claim(sql, "x");
    assert_string_equal(first.id, ID_A);
    assert_string_equal(first.tenant, "ann");
    assert_string_equal(first.etag, "tag");
    assert_int_equal(first.item, 0);
    assert_int_equal(first.attempts, 1);
    assert_int_equal(claim(sql, "y").item, 1);
    assert_string_equal(claim(sql, "x").id, ID_B);
    assert_int_equal(claim(sql, "x").item, -1);
}

static void tenants_take_turns(void **state)
{
    struct server_store_sql *sql = sql_of(state);
    static const char *const asked[] = {"bob", "cid", "ann", "bob", "ann", "bob"};
    struct server_batch_claim last = {.tenant = "ann"};
    add(sql, ID_A, "ann", 100);
    add(sql, ID_B, "bob", 3);
    add(sql, "000000000000000000000003", "cid", 1);
    for (size_t i = 0; i < COUNT(asked); i++) {
        last = claim_after(sql, "x", last.tenant);
        assert_string_equal(last.tenant, asked[i]);
    }
    for (int i = 0; i < 98; i++) {
        last = claim_after(sql, "x", last.tenant);
        assert_string_equal(last.tenant, "ann");
    }
    assert_int_equal(claim_after(sql, "x", last.tenant).item, -1);
}

static bool on_answer(void *user, const struct server_sql_value *row)
{
    char *text = user;
    sprintf(text + strlen(text), "%d:%d:%.*s:%d ", (int)row[0].integer, (int)row[1].integer,
            (int)row[2].size, row[2].bytes, (int)row[3].integer);
    return true;
}

static void a_second_answer_is_ignored(void **state)
{
    struct server_store_sql *sql = sql_of(state);
    char text[128] = "";
    add(sql, ID_A, "", 3);
    answer(sql, ID_A, 2, 404, "no");
    answer(sql, ID_A, 0, 200, "yes");
    answer(sql, ID_A, 0, 200, "again");
    const struct server_batch_place begin = {ID_A, -1, false};
    assert_int_equal(server_batch_queue_answers(sql, &begin, on_answer, text), SERVER_STORE_DONE);
    assert_string_equal(text, "0:200:yes:0 2:404:no:2 ");
    struct proto_many_state batch = find(sql, "", ID_A);
    assert_int_equal(batch.done, 2);
    assert_int_equal(batch.failed, 1);
    assert_int_equal(claim(sql, "x").item, 1);
}

static void answers_are_numbered_in_order_of_writing(void **state)
{
    struct server_store_sql *sql = sql_of(state);
    char text[128] = "", rest[128] = "";
    add(sql, ID_A, "", 4);
    add(sql, ID_B, "", 1);
    answer(sql, ID_A, 2, 200, "c");
    answer(sql, ID_B, 0, 200, "z");
    answer(sql, ID_A, 0, 200, "a");
    answer(sql, ID_A, 2, 200, "again");
    answer(sql, ID_A, 3, 200, "d");
    const struct server_batch_place begin = {ID_A, 0, true}, second = {ID_A, 2, true};
    assert_int_equal(server_batch_queue_answers(sql, &begin, on_answer, text), SERVER_STORE_DONE);
    assert_string_equal(text, "2:200:c:1 0:200:a:2 3:200:d:3 ");
    assert_int_equal(server_batch_queue_answers(sql, &second, on_answer, rest), SERVER_STORE_DONE);
    assert_string_equal(rest, "3:200:d:3 ");
    assert_int_equal(server_batch_queue_cancel(sql, ID_A), SERVER_STORE_DONE);
    answer(sql, ID_A, 1, 200, "late");
    assert_int_equal(find(sql, "", ID_A).done, 3);
}

#define WRITERS       4
#define ITEMS_EACH    50
#define WRITTEN_ITEMS (WRITERS * ITEMS_EACH)

struct writer {
    struct server_store_sql *sql;
    int64_t first;
};

static void *write_answers(void *user)
{
    const struct writer *writer = user;
    for (int64_t i = 0; i < ITEMS_EACH; i++) answer(writer->sql, ID_A, writer->first + i, 200, "x");
    return NULL;
}

static bool on_number(void *user, const struct server_sql_value *row)
{
    int64_t *last = user;
    assert_int_equal(row[3].integer, *last + 1);
    *last = row[3].integer;
    return true;
}

/* Repeatedly reads the answers after the last known number while all threads write answers. */
static void readers_miss_no_answer(void **state)
{
    struct server_store_sql *sql = sql_of(state);
    pthread_t threads[WRITERS];
    struct writer writers[WRITERS];
    struct server_batch_place place = {ID_A, 0, true};
    add(sql, ID_A, "", WRITTEN_ITEMS);
    for (int i = 0; i < WRITERS; i++) {
        writers[i] = (struct writer){sql, (int64_t)i * ITEMS_EACH};
        assert_int_equal(pthread_create(&threads[i], NULL, write_answers, &writers[i]), 0);
    }
    while (place.after < WRITTEN_ITEMS)
        assert_int_equal(server_batch_queue_answers(sql, &place, on_number, &place.after),
                         SERVER_STORE_DONE);
    for (int i = 0; i < WRITERS; i++) pthread_join(threads[i], NULL);
}

/* Opens a file of the previous release. Its tables have no numbers, and its version is 0. */
static void batches_of_an_older_file_are_numbered(void **state)
{
    char folder[FOLDER_PATH], path[SERVER_DISK_PATH], error[SERVER_ERROR], text[128] = "";
    const char *older[5] = {0};
    (void)state;
    folder_make(folder);
    snprintf(path, sizeof path, "%s/batches.db", folder);
    memcpy(older, server_batch_queue_tables, 4 * sizeof *older);
    struct server_store_sql *sql = server_store_sql_local_open(path, older, error);
    assert_non_null(sql);
    add(sql, ID_A, "", 4);
    assert_int_equal(
        sql->run(sql, SERVER_SQL("UPDATE items SET status = 200, answer = x'61' WHERE item > 1")),
        SERVER_STORE_DONE);
    assert_int_equal(sql->run(sql, SERVER_SQL("PRAGMA user_version = 0")), SERVER_STORE_DONE);
    sql->close(sql);
    sql = server_store_sql_local_open(path, server_batch_queue_tables, error);
    assert_non_null(sql);
    answer(sql, ID_A, 0, 200, "b");
    const struct server_batch_place begin = {ID_A, 0, true};
    assert_int_equal(server_batch_queue_answers(sql, &begin, on_answer, text), SERVER_STORE_DONE);
    assert_string_equal(text, "2:200:a:1 3:200:a:2 0:200:b:3 ");
    assert_int_equal(sql->run(sql, SERVER_SQL("PRAGMA user_version = 99")), SERVER_STORE_DONE);
    sql->close(sql);
    assert_null(server_store_sql_local_open(path, server_batch_queue_tables, error));
    folder_remove(folder);
}

static void only_its_holder_can_renew_or_return_a_lease(void **state)
{
    struct server_store_sql *sql = sql_of(state);
    add(sql, ID_A, "", 1);
    struct server_batch_claim taken = claim(sql, "x");
    assert_int_equal(server_batch_queue_renew(sql, &taken, "x"), SERVER_STORE_DONE);
    assert_int_equal(server_batch_queue_renew(sql, &taken, "y"), SERVER_STORE_ABSENT);
    /* the item belongs to another daemon */
    assert_int_equal(server_batch_queue_return(sql, &taken, "y", false, 0), SERVER_STORE_DONE);
    assert_int_equal(claim(sql, "y").item, -1);
    assert_int_equal(server_batch_queue_return(sql, &taken, "x", false, 0), SERVER_STORE_DONE);
    taken = claim(sql, "y");
    assert_int_equal(taken.item, 0);
    assert_int_equal(taken.attempts, 1);
    assert_int_equal(server_batch_queue_renew(sql, &taken, "x"), SERVER_STORE_ABSENT);
    assert_int_equal(server_batch_queue_return(sql, &taken, "y", true, 60000), SERVER_STORE_DONE);
    /* the item can't be claimed for one minute after it was returned */
    assert_int_equal(claim(sql, "x").item, -1);
    assert_int_equal(server_batch_queue_return_all(sql), SERVER_STORE_DONE);
    assert_int_equal(claim(sql, "x").attempts, 2);
}

static void items_of_a_cancelled_batch_are_not_claimed(void **state)
{
    struct server_store_sql *sql = sql_of(state);
    struct proto_many_state batch;
    add(sql, ID_A, "", 2);
    struct server_batch_claim taken = claim(sql, "x");
    assert_int_equal(taken.item, 0);
    assert_int_equal(server_batch_queue_cancel(sql, ID_A), SERVER_STORE_DONE);
    assert_true(find(sql, "", ID_A).is_cancelled);
    assert_int_equal(claim(sql, "x").item, -1);
    assert_int_equal(server_batch_queue_renew(sql, &taken, "x"), SERVER_STORE_ABSENT);
    assert_int_equal(server_batch_queue_remove(sql, ID_A), SERVER_STORE_DONE);
    assert_int_equal(server_batch_queue_find(sql, "", ID_A, &batch), SERVER_STORE_ABSENT);
    assert_int_equal(server_batch_queue_remove(sql, ID_A), SERVER_STORE_DONE);
}

static void count_aside(void *user, const char *path, const char *name)
{
    (void)path;
    *(uint32_t *)user += strncmp(name, "batches.db.damaged-", 19) == 0;
}

static void an_invalid_statement_is_refused(void **state)
{
    struct server_store_sql *sql = sql_of(state);
    assert_true(sql->run(sql, SERVER_SQL("SELECT FROM nothing AT ALL")) != SERVER_STORE_DONE);
    assert_int_equal(sql->run(sql, SERVER_SQL("SELECT 1")), SERVER_STORE_DONE);
}

/* Adds more data than SQLite keeps in memory, so that SQLite reads pages again. */
static void a_database_damaged_during_use_is_set_aside(void **state)
{
    char folder[FOLDER_PATH], path[SERVER_DISK_PATH], error[SERVER_ERROR];
    static const char rubbish[1 << 20];
    (void)state;
    folder_make(folder);
    snprintf(path, sizeof path, "%s/batches.db", folder);
    struct server_store_sql *sql =
        server_store_sql_local_open(path, server_batch_queue_tables, error);
    assert_non_null(sql);
    add(sql, ID_A, "", 200000);
    int file = open(path, O_WRONLY);
    for (off_t at = sizeof rubbish; at < 6 * (off_t)sizeof rubbish; at += sizeof rubbish)
        assert_int_equal(pwrite(file, rubbish, sizeof rubbish, at), sizeof rubbish);
    close(file);
    assert_int_equal(sql->run(sql, SERVER_SQL("SELECT sum(item) FROM items")),
                     SERVER_STORE_READ_ONLY);
    add(sql, ID_B, "", 2); /* the new database works */
    assert_int_equal(claim(sql, "x").item, 0);
    sql->close(sql);
    uint32_t aside = 0;
    assert_true(folder_each(folder, count_aside, &aside));
    assert_true(aside >= 1);
    folder_remove(folder);
}

/* Asks SQLite how it would run the statements of the queue. */
struct planner {
    struct server_store_sql sql; /* must be the first member */
    struct server_store_sql *queue;
    int reads; /* reads of the items of one batch */
};

static bool on_plan(void *user, const struct server_sql_value *row)
{
    struct planner *planner = user;
    const char *step = row[3].bytes;
    if (!strstr(step, "items")) return true;
    planner->reads++;
    assert_non_null(strstr(step, "COVERING INDEX"));
    assert_true(strstr(step, "items_failed") || strstr(step, "items_answered"));
    return true;
}

static enum server_outcome plan(struct server_store_sql *sql,
                                const struct server_statement *statement)
{
    struct planner *planner = (struct planner *)sql;
    struct server_statement explained = *statement;
    char text[2048];
    snprintf(text, sizeof text, "EXPLAIN QUERY PLAN %s", statement->text);
    explained.text = text;
    explained.visit = on_plan;
    explained.user = planner;
    return planner->queue->run(planner->queue, &explained);
}

/* A tenant may have 1,000 batches of 20,000 items. */
static void a_list_does_not_count_items(void **state)
{
    struct planner planner = {.sql = {.run = plan}, .queue = sql_of(state)};
    struct proto_many_state batches[2];
    struct server_batch_list list = {.batches = batches, .most = 2};
    assert_int_equal(server_batch_queue_list(&planner.sql, "", "", &list), SERVER_STORE_DONE);
    assert_int_equal(planner.reads, 2);
    assert_int_equal(server_batch_queue_find(&planner.sql, "", ID_A, batches), SERVER_STORE_ABSENT);
    assert_int_equal(planner.reads, 4);
}

#define EACH(test)                                                                                 \
    cmocka_unit_test_setup_teardown(test, set_up_local, tear_down),                                \
        cmocka_unit_test_setup_teardown(test, set_up_shared, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        EACH(a_batch_is_visible_to_its_tenant_only),
        EACH(each_item_is_claimed_once_in_order_of_batches),
        EACH(tenants_take_turns),
        EACH(a_second_answer_is_ignored),
        EACH(answers_are_numbered_in_order_of_writing),
        EACH(readers_miss_no_answer),
        cmocka_unit_test_setup_teardown(a_list_does_not_count_items, set_up_local, tear_down),
        cmocka_unit_test(batches_of_an_older_file_are_numbered),
        EACH(only_its_holder_can_renew_or_return_a_lease),
        EACH(items_of_a_cancelled_batch_are_not_claimed),
        EACH(an_invalid_statement_is_refused),
        cmocka_unit_test(a_database_damaged_during_use_is_set_aside)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
