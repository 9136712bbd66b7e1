#include "tests/unit/server/support.h"

#include <stdio.h>

#include "server/http/grammar.h"

#define HOST          "Host: localhost\r\n"
#define GET           "GET / HTTP/1.1\r\n"
#define PUT           "PUT / HTTP/1.1\r\n" HOST
#define CHUNKED       PUT "Transfer-Encoding: chunked\r\n\r\n"
#define TEXT(literal) (literal), sizeof(literal) - 1

/* Follows all at once; then again byte by byte, which has to come to the same. */
static struct server_grammar follow(const char *bytes, size_t size)
{
    struct server_grammar whole = {0}, single = {0};
    size_t right = server_grammar_follow(&whole, bytes, size), at = 0;
    while (at < size && server_grammar_follow(&single, bytes + at, 1) == 1) at++;
    assert_int_equal(at, right);
    assert_ptr_equal(single.fault, whole.fault);
    assert_int_equal(single.state, whole.state);
    assert_int_equal(single.heads, whole.heads);
    assert_true(whole.fault || right == size);
    return whole;
}

#define FOLLOW(literal) follow(TEXT(literal))

static void assert_whole(struct server_grammar grammar, uint64_t heads)
{
    assert_null(grammar.fault);
    assert_int_equal(grammar.state, SERVER_GRAMMAR_START);
    assert_int_equal(grammar.heads, heads);
}

static void requests_without_fault(void **state)
{
    (void)state;
    assert_whole(FOLLOW(GET HOST "\r\n"), 1);
    assert_whole(FOLLOW("\r\n" GET HOST "\r\n"), 1);
    assert_whole(FOLLOW("M-SEARCH * HTTP/1.0\r\n\r\n"), 1);
    assert_whole(FOLLOW(GET "Empty:\r\nTab:\ta\tb \r\nObs: \xe9\r\n" HOST "\r\n"), 1);
    assert_whole(FOLLOW(PUT "Content-Length: 5\r\n\r\nhello"), 1);
    assert_whole(FOLLOW(PUT "content-LENGTH:0005\r\n\r\nhello"), 1);
    assert_whole(FOLLOW(PUT "Content-Length: 0\r\n\r\n" GET "\r\n"), 2);
    assert_whole(FOLLOW(PUT "Transfer-Encoding: Chunked\r\n\r\n5\r\nhello\r\n0\r\n\r\n" GET "\r\n"),
                 2);
    assert_whole(FOLLOW(PUT "Transfer-Encoding: "
                            "chunked\r\n\r\n00A;a=\"b\"\r\n0123456789\r\n0\r\nTrailer: x\r\n\r\n"),
                 1);
    assert_whole(FOLLOW(PUT "Content-Length: 21\r\n\r\nGET / HTTP/1.1\n\n\n\n\n\n\n" GET "\r\n"),
                 2);
    /* names that begin as, or are longer than, those that count */
    assert_whole(FOLLOW(GET "Content-Lengths: x\r\nHosts: a\r\nHost: b\r\nTransfer-Encoding-: y\r\n"
                            "Transfer-Encoding-Transfer-Encoding: z\r\n\r\n"),
                 1);
}

static void bodies_are_as_long_as_they_say(void **state)
{
    (void)state;
    struct server_grammar grammar = FOLLOW(PUT "Content-Length: 18446744073709551\r\n\r\nabc");
    assert_int_equal(grammar.state, SERVER_GRAMMAR_BODY);
    assert_int_equal(grammar.left, UINT64_C(18446744073709551) - 3);
    grammar = FOLLOW(PUT "Transfer-Encoding: chunked\r\n\r\nffffffffffffffff\r\nabc");
    assert_int_equal(grammar.left, UINT64_MAX - 3);
    assert_false(server_grammar_is_in_head(&grammar));
}

static void knows_when_it_is_in_a_head(void **state)
{
    (void)state;
    static const struct {
        const char *bytes;
        bool is_in_head;
    } cases[] = {
        {"", false},         {"\r\n", false},     {"G", true},
        {GET, true},         {GET HOST, true},    {GET HOST "\r", true},
        {GET "\r\n", false}, {GET "\r\nP", true}, {PUT "Content-Length: 5\r\n\r\nh", false}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct server_grammar grammar = follow(cases[i].bytes, strlen(cases[i].bytes));
        assert_int_equal(server_grammar_is_in_head(&grammar), cases[i].is_in_head);
    }
}

static const struct {
    const char *bytes;
    size_t size, right; /* how many bytes are without fault */
} faults[] = {
#define FAULT(before, after)                                                                       \
    {                                                                                              \
        TEXT(before after), sizeof(before) - 1                                                     \
    }
    FAULT("", "\n"),
    FAULT("\r\n", "\r\n" GET),
    FAULT("\r", "\r"),
    FAULT("", " GET"),
    FAULT("", "\x16\x03\x01"),
    FAULT("G", "(T / HTTP/1.1"),
    FAULT("GET", "\t/ HTTP/1.1"),
    FAULT("GET ", " / HTTP/1.1"),
    FAULT("GET / ", " HTTP/1.1"),
    FAULT("GET /", "\r\n"),
    FAULT("GET /a", "\tb HTTP/1.1"),
    FAULT("GET /", "\xff HTTP/1.1"),
    FAULT("GET /", "#a HTTP/1.1"),
    FAULT("GET /", "\x7f HTTP/1.1"),
    FAULT("GET / ", "http/1.1"),
    FAULT("GET / HTTP/1.", "2\r\n"),
    FAULT("GET / HTTP/", "2.0\r\n"),
    FAULT("GET / HTTP/1.1", " \r\n"),
    FAULT("GET / HTTP/1.1", "\n"),
    FAULT("GET / HTTP/1.1\r", "X"),
    FAULT(GET, " Host: a\r\n"),
    FAULT(GET, "\tHost: a\r\n"),
    FAULT(GET, ": a\r\n"),
    FAULT(GET, "\n"),
    FAULT(GET "Host", " : a\r\n"),
    FAULT(GET "Host", "\t: a\r\n"),
    FAULT(GET "Host", "\r\n"),
    FAULT(GET "Ho", "(st: a\r\n"),
    FAULT(GET "Ho", "\xe9: a\r\n"),
    FAULT(GET "A: b", "\n"),
    FAULT(GET "A: b\r", "c"),
    FAULT(GET "A: b\r", "\r\n"),
    FAULT(GET "A: b\r\n", " c\r\n"),
    FAULT(GET "A: b", "\x01"),
    FAULT(GET "A: b", "\x7f"),
    FAULT(GET HOST "\r", "GET"),
    FAULT(GET HOST "Host: localhost", "\r\n"),
    FAULT(PUT "Content-Length: 5\r\nContent-Length: 5", "\r\n\r\n"),
    FAULT(PUT "Content-Length: 5, 5", "\r\n"),
    FAULT(PUT "Content-Length: +5", "\r\n"),
    FAULT(PUT "Content-Length: -5", "\r\n"),
    FAULT(PUT "Content-Length: 0x5", "\r\n"),
    FAULT(PUT "Content-Length: 5 ", "\r\n"),
    FAULT(PUT "Content-Length: 5\xa0", "\r\n"),
    FAULT(PUT "Content-Length:", "\r\n"),
    FAULT(PUT "Content-Length: 1234567890123456789", "\r\n"),
    FAULT(PUT "Content-Length: 99999999999999999999999999", "\r\n"),
    FAULT(PUT "Transfer-Encoding: chunked, chunked", "\r\n"),
    FAULT(PUT "Transfer-Encoding: gzip", "\r\n"),
    FAULT(PUT "Transfer-Encoding: xchunked", "\r\n"),
    FAULT(PUT "Transfer-Encoding: chunked ", "\r\n"),
    FAULT(PUT "Transfer-Encoding:", "\r\n"),
    FAULT(PUT "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked", "\r\n"),
    FAULT(PUT "Transfer-Encoding: chunked\r\nContent-Length: 5\r\n\r", "\n"),
    FAULT(PUT "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r", "\n"),
    FAULT("PUT / HTTP/1.0\r\nTransfer-Encoding: chunked", "\r\n"),
#undef FAULT
};

static void faults_of_heads(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(faults); i++) {
        struct server_grammar grammar = {0};
        follow(faults[i].bytes, faults[i].size);
        assert_int_equal(server_grammar_follow(&grammar, faults[i].bytes, faults[i].size),
                         faults[i].right);
        assert_non_null(grammar.fault);
        assert_int_equal(grammar.heads, 0);
        /* nothing is followed any more */
        assert_int_equal(server_grammar_follow(&grammar, GET "\r\n", sizeof GET), 0);
    }
}

static void faults_of_chunks(void **state)
{
    (void)state;
    static const char *const cases[] = {"0x5\r\n",
                                        "+5\r\n",
                                        "-5\r\n",
                                        " 5\r\n",
                                        "5 \r\n",
                                        "5\t;a\r\n",
                                        "\r\n",
                                        ";a\r\n",
                                        "g\r\n",
                                        "5\n",
                                        "5\rX",
                                        "5;a\n",
                                        "5;a\x01\r\n",
                                        "00000000000000005\r\n",
                                        "5\r\nhelloworld",
                                        "5\r\nhello\n",
                                        "5\r\nhello\rX",
                                        "5\r\nhello0\r\n\r\n",
                                        "0\r\n\n",
                                        "0\r\n A: b\r\n",
                                        "0\r\nA : b\r\n",
                                        "0\r\nA: b\n\n",
                                        "0\r\nContent-Length: 5\r\n",
                                        "0\r\nTransfer-Encoding: chunked\r\n",
                                        "0\r\nHost: b\r\n"};
    for (size_t i = 0; i < COUNT(cases); i++) {
        char bytes[256];
        snprintf(bytes, sizeof bytes, CHUNKED "%s", cases[i]);
        struct server_grammar grammar = follow(bytes, strlen(bytes));
        assert_non_null(grammar.fault);
        assert_int_equal(grammar.heads, 1);
    }
}

static void extensions_have_an_end(void **state)
{
    (void)state;
    char extensions[4096] = "";
    struct server_grammar grammar = {0};
    server_grammar_follow(&grammar, TEXT(CHUNKED));
    for (int i = 0; i < 400; i++) strcat(extensions, "1;a=b\r\nx\r\n");
    size_t right = server_grammar_follow(&grammar, extensions, strlen(extensions));
    assert_non_null(grammar.fault);
    assert_in_range(right, 1024, 4096);
}

/* What a fault leaves is completed by the ending to a whole head, or to chunks that are faulty for
 * everybody. */
/* `count` times the text, after the head so far. */
static struct server_grammar follow_many(const char *head, const char *text, unsigned count)
{
    struct server_grammar grammar = {0};
    server_grammar_follow(&grammar, head, strlen(head));
    for (unsigned i = 0; i < count && !grammar.fault; i++)
        server_grammar_follow(&grammar, text, strlen(text));
    return grammar;
}

/* However the bytes come. */
static void a_head_has_room_for_so_much(void **state)
{
    (void)state;
    assert_null(follow_many("GET ", "a", SERVER_GRAMMAR_TARGET_MOST).fault);
    assert_non_null(
        strstr(follow_many("GET ", "a", SERVER_GRAMMAR_TARGET_MOST + 1).fault, "target"));
    assert_non_null(strstr(
        follow_many("GET ", "abcdefgh", SERVER_GRAMMAR_TARGET_MOST / 8 + 1).fault, "target"));
    unsigned before = strlen("GET"
                             "/"
                             "HTTP/1.1"
                             "a"),
             room = SERVER_GRAMMAR_HEAD_MOST - before;
    assert_null(follow_many(GET "a:", "b", room).fault);
    assert_non_null(strstr(follow_many(GET "a:", "b", room + 1).fault, "headers"));
    assert_non_null(strstr(follow_many(GET "Content-Length: ", "0", SERVER_GRAMMAR_HEAD_MOST).fault,
                           "headers"));
    assert_null(follow_many(GET, "a: b\r\n", SERVER_GRAMMAR_HEADERS_MOST).fault);
    assert_non_null(
        strstr(follow_many(GET, "a: b\r\n", SERVER_GRAMMAR_HEADERS_MOST + 1).fault, "headers"));
    assert_non_null(follow_many(GET, "a", 257).fault);
    assert_null(follow_many("", GET HOST "\r\n", 5000).fault);
    assert_null(
        follow_many(PUT "Transfer-Encoding: chunked\r\n\r\n", "000000000000001\r\na\r\n", 5000)
            .fault);
}

static void an_ending_ends(void **state)
{
    (void)state;
    static const char *const heads[] = {"\n",
                                        "\r\r",
                                        "G(",
                                        "GET  ",
                                        "GET /\t",
                                        "GET / X",
                                        "GET / HTTP/1.1 ",
                                        GET " a",
                                        GET "A(",
                                        GET "A: \x01",
                                        GET "A: b\rc",
                                        GET "\rX",
                                        "GET / HTTP/1.1\rX"};
    for (size_t i = 0; i < COUNT(heads); i++) {
        char bytes[256] = "";
        struct server_grammar grammar = {0}, again = {0};
        size_t right = server_grammar_follow(&grammar, heads[i], strlen(heads[i]));
        memcpy(bytes, heads[i], right);
        strcpy(bytes + right, server_grammar_ending(&grammar));
        size_t size = strlen(bytes);
        /* "GET /  HTTP/1.1" is left to more lenient readers */
        bool is_lenient = strcmp(heads[i], "GET / X") == 0;
        assert_true(is_lenient || server_grammar_follow(&again, bytes, size) == size);
        assert_true(is_lenient || (again.heads == 1 && again.state == SERVER_GRAMMAR_START));
    }
}

/* A number below `bound`, of a fixed sequence (splitmix64). */
static size_t next_below(uint64_t *state, size_t bound)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return (size_t)((z ^ z >> 31) % bound);
}

/* What passes holds, outside bodies, no NUL, and no LF without its CR. */
static void assert_clean(const char *bytes, size_t size)
{
    struct server_grammar grammar = {0};
    for (size_t i = 0; i < size; i++) {
        bool is_body =
            grammar.state == SERVER_GRAMMAR_BODY || grammar.state == SERVER_GRAMMAR_CHUNK_DATA;
        if (!server_grammar_follow(&grammar, bytes + i, 1)) return;
        assert_true(is_body || bytes[i]);
        assert_true(is_body || bytes[i] != '\n' || (i > 0 && bytes[i - 1] == '\r'));
    }
}

/* Requests with bytes exchanged, left out and put in: whatever they are, pieces make no difference.
 */
static void damaged_requests(void **state)
{
    (void)state;
    static const char request[] = "\r\n" PUT "Content-Length: 5\r\n\r\nhello" CHUNKED
                                  "5;a\r\nhello\r\n0\r\nA: b\r\n\r\n" GET "\r\n";
    static const char odd[] = "\r\n\0\t :;0f\x80";
    uint64_t sequence = 1, whole = 0;
    for (int trial = 0; trial < 100000; trial++) {
        char bytes[sizeof request];
        size_t size = sizeof request - 1, at = next_below(&sequence, size);
        memcpy(bytes, request, size);
        switch (next_below(&sequence, 3)) {
        case 0:
            bytes[at] = odd[next_below(&sequence, sizeof odd - 1)];
            break;
        case 1:
            memmove(bytes + at, bytes + at + 1, --size - at);
            break;
        case 2:
            memmove(bytes + at + 1, bytes + at, size - at);
            bytes[at] = odd[next_below(&sequence, sizeof odd - 1)];
            size++;
            break;
        }
        struct server_grammar grammar = follow(bytes, size);
        whole += grammar.heads == 3 && grammar.state == SERVER_GRAMMAR_START && !grammar.fault;
        assert_clean(bytes, size);
    }
    assert_in_range(whole, 10000, 60000); /* both outcomes are common */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(requests_without_fault),
        cmocka_unit_test(bodies_are_as_long_as_they_say),
        cmocka_unit_test(knows_when_it_is_in_a_head),
        cmocka_unit_test(faults_of_heads),
        cmocka_unit_test(faults_of_chunks),
        cmocka_unit_test(extensions_have_an_end),
        cmocka_unit_test(a_head_has_room_for_so_much),
        cmocka_unit_test(an_ending_ends),
        cmocka_unit_test(damaged_requests),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
