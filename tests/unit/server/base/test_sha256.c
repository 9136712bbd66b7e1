#include "tests/unit/server/support.h"

#include "server/base/sha256.h"

/* Checks the hashes of FIPS 180-2, appendix B, and the hash of the empty text. */
static void known_sums(void **state)
{
    static const struct {
        const char *text, *sum;
    } cases[] = {{"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
                 {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
                 {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
                  "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"}};
    char sum[SERVER_SHA256_HEX];
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        server_sha256(cases[i].text, strlen(cases[i].text), sum);
        assert_string_equal(sum, cases[i].sum);
    }
}

static void pieces_give_the_same_sum(void **state)
{
    static const char text[] =
        "one after the other, and in the end they are the same as all at once";
    char whole[SERVER_SHA256_HEX], sum[SERVER_SHA256_HEX];
    (void)state;
    server_sha256(text, sizeof text, whole);
    for (size_t piece = 1; piece <= sizeof text; piece++) {
        struct server_sha256 *state_of_sum = server_sha256_begin();
        assert_non_null(state_of_sum);
        for (size_t at = 0; at < sizeof text; at += piece)
            server_sha256_add(state_of_sum, text + at,
                              at + piece < sizeof text ? piece : sizeof text - at);
        server_sha256_end(state_of_sum, sum);
        assert_string_equal(sum, whole);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(known_sums),
                                       cmocka_unit_test(pieces_give_the_same_sum)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
