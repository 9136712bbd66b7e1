#include "tests/unit/server/support.h"

#include "server/http/header_block.h"

static struct server_response response;
static struct server_header_block block;

static void add(const char *name, const char *value)
{
    struct server_response_header *header = &response.headers[response.header_count++];
    header->name = name;
    header->size = strlen(value);
    strcpy(header->value, value);
}

static void assert_block(const char *joined, const char *broken)
{
    char copy[sizeof block.value];
    server_header_block_join(&block, &response, "today");
    assert_string_equal(block.value, joined);
    strcpy(copy, block.value);
    server_header_block_break(&block, copy);
    assert_string_equal(copy, broken);
}

static void lines_stand_in_the_dates_value(void **state)
{
    (void)state;
    response.header_count = 0;
    assert_block("today", "today");
    add("ETag", "\"x\"");
    assert_block("today  ETag: \"x\"", "today\r\nETag: \"x\"");
    add("Vary", "Accept-Encoding");
    add("X-Empty", "");
    add("X-Blanks", "a  b: c");
    assert_block("today  ETag: \"x\"  Vary: Accept-Encoding  X-Empty:   X-Blanks: a  b: c",
                 "today\r\nETag: \"x\"\r\nVary: Accept-Encoding\r\nX-Empty: \r\nX-Blanks: a  b: c");
}

static void the_longest_fit(void **state)
{
    (void)state;
    char name[SERVER_HEADER_NAME + 1], value[SERVER_HEADER_VALUE];
    memset(name, 'n', sizeof name - 1);
    memset(value, 'v', sizeof value - 1);
    name[sizeof name - 1] = value[sizeof value - 1] = '\0';
    response.header_count = 0;
    while (response.header_count < SERVER_RESPONSE_HEADERS) add(name, value);
    server_header_block_join(&block, &response, "today");
    assert_int_equal(strlen(block.value),
                     5 + SERVER_RESPONSE_HEADERS * (sizeof value - 1 + sizeof name + 3));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_stand_in_the_dates_value),
        cmocka_unit_test(the_longest_fit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
