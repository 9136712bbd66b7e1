#include "proto/page.h"

bool proto_page_parse(const struct proto_parameters *parameters, struct proto_page *out, struct proto_problem *problem)
{
    static const char *const names[] = {"limit", "after", NULL};
    uint64_t limit = PROTO_PAGE_DEFAULT;
    if (!proto_parameters_check(parameters, names, problem)) return false;
    if (!proto_parameters_integer(parameters, "limit", 1, PROTO_PAGE_MOST, &limit, problem)) return false;
    *out = (struct proto_page){.limit = (uint32_t)limit, .after = parameters->get(parameters->user, "after")};
    return true;
}
