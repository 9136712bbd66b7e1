#include "support.h"

#include "proto/http/accept.h"

static void weighs_media_types(void **state)
{
    (void)state;
    static const struct {
        const char *accept, *media_type;
        unsigned quality;
    } cases[] = {
        {NULL, "model/obj", 1000},
        {"", "model/obj", 1000},
        {"  ", "model/obj", 1000},
        {"*/*", "model/obj", 1000},
        {"model/*", "model/obj", 1000},
        {"model/obj", "model/obj", 1000},
        {"MODEL/OBJ", "model/obj", 1000},
        {"model/stl", "model/obj", 0},
        {"text/*", "model/obj", 0},
        {"mode/*", "model/obj", 0},
        {"model/objx", "model/obj", 0},
        {"model", "model/obj", 0},
        {"model/obj;q=0.5", "model/obj", 500},
        {"model/obj ; level=1 ; Q=0.25", "model/obj", 250},
        {"model/obj;q=0", "model/obj", 0},
        {"model/obj;q=0.001", "model/obj", 1},
        {"model/obj;q=1.000", "model/obj", 1000},
        {"model/obj;q=7", "model/obj", 1000},
        {"model/obj;q=x", "model/obj", 0},
        {"*/*;q=0.1, model/*;q=0.2, model/obj;q=0.3", "model/obj", 300},
        {"model/obj;q=0.3, model/*;q=0.2, */*", "model/obj", 300},
        {"model/obj;q=0, */*", "model/obj", 0},
        {"application/json, text/plain, */*", "model/obj", 1000},
        {",,model/obj,", "model/obj", 1000},
        {";q=1", "model/obj", 0},
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        assert_int_equal(proto_accept_quality(cases[i].accept, cases[i].media_type),
                         cases[i].quality);
}

static void finds_codings(void **state)
{
    (void)state;
    static const struct {
        const char *accept;
        bool is_listed;
    } cases[] = {
        {NULL, false},
        {"", false},
        {"gzip", true},
        {"GZIP", true},
        {"br, gzip ;q=0.001", true},
        {"deflate;q=0,gzip", true},
        {"gzip;q=0", false},
        {"gzip; Q=0.000, br", false},
        {"notgzip", false},
        {"x-gzip", false},
        {"gzipped", false},
        {"br;x=gzip", false},
        {"*", false},
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        assert_int_equal(proto_accept_lists_coding(cases[i].accept, "gzip"), cases[i].is_listed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(weighs_media_types),
                                       cmocka_unit_test(finds_codings)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
