#include "support.h"

#include <jansson.h>
#include <stdio.h>

#include "server/log.h"

/* The line as it stands, closed but not written, read back as JSON. */
static json_t *parse(struct server_log_line *line)
{
    json_error_t error;
    char text[SERVER_LOG_LINE + 2];
    memcpy(text, line->text, line->size);
    strcpy(text + line->size, "}");
    json_t *document = json_loads(text, JSON_REJECT_DUPLICATES, &error);
    if (!document) fail_msg("%s in %s", error.text, text);
    return document;
}

static void is_json_whatever_is_in_it(void **state)
{
    (void)state;
    struct server_log_line line;
    assert_true(server_log_begin(&line, SERVER_LOG_ERROR, "test"));
    server_log_text(&line, "odd", "quote \" backslash \\ newline \n tab \t \x01 \x7f \xc3\xa9");
    server_log_text(&line, "absent", NULL);
    server_log_integer(&line, "number", INT64_MIN);
    server_log_milliseconds(&line, "ms", 1234567);
    json_t *document = parse(&line);
    assert_string_equal(json_string_value(json_object_get(document, "event")), "test");
    assert_string_equal(json_string_value(json_object_get(document, "level")), "error");
    assert_non_null(strstr(json_string_value(json_object_get(document, "odd")), "quote \" backslash \\ newline \n"));
    assert_null(json_object_get(document, "absent"));
    assert_true(json_real_value(json_object_get(document, "ms")) == 1.235);
    json_decref(document);
}

static void is_json_however_long(void **state)
{
    (void)state;
    static const char fill[] = "\"\\\x01x";
    for (size_t size = 0; size < 3 * SERVER_LOG_LINE; size += 7) {
        struct server_log_line line;
        char text[3 * SERVER_LOG_LINE + 1];
        for (size_t i = 0; i < size; i++) text[i] = fill[i % 4];
        text[size] = '\0';
        assert_true(server_log_begin(&line, SERVER_LOG_ERROR, "test"));
        for (int i = 0; i < 8; i++) {
            char key[16];
            snprintf(key, sizeof key, "key%d", i);
            server_log_text(&line, key, text);
        }
        server_log_integer(&line, "last", 1);
        json_decref(parse(&line));
    }
}

static void knows_its_level(void **state)
{
    (void)state;
    struct server_log_line line;
    server_log_set_level(SERVER_LOG_WARN);
    assert_false(server_log_begin(&line, SERVER_LOG_INFO, "test"));
    assert_true(server_log_begin(&line, SERVER_LOG_WARN, "test"));
    server_log_set_level(SERVER_LOG_DEBUG);
    assert_true(server_log_begin(&line, SERVER_LOG_DEBUG, "test"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_json_whatever_is_in_it),
        cmocka_unit_test(is_json_however_long),
        cmocka_unit_test(knows_its_level),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
