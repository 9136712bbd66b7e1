#include "support.h"

#include "proto/http/asset.h"

static void finds_exact_paths_only(void **state)
{
    (void)state;
    static const struct proto_asset assets[] = {{.path = "/index.html"}, {.path = "/"}};
    assert_ptr_equal(proto_asset_find(assets, COUNT(assets), "/"), &assets[1]);
    assert_ptr_equal(proto_asset_find(assets, COUNT(assets), "/index.html"), &assets[0]);
    assert_null(proto_asset_find(assets, COUNT(assets), "/index"));
    assert_null(proto_asset_find(assets, COUNT(assets), "/../index.html"));
    assert_null(proto_asset_find(assets, 0, "/"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(finds_exact_paths_only)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
