#include "proto/http/page.h"

#include <stdio.h>
#include <stdlib.h>

#include "proto/json/writer.h"
#include "proto/json/problem.h"

static bool page_parse(const struct proto_parameters *parameters, const char *const *names,
                       struct proto_page *out, struct proto_problem *problem)
{
    uint64_t limit = PROTO_PAGE_DEFAULT;
    if (!proto_parameters_check(parameters, names, problem)) return false;
    if (!proto_parameters_integer(parameters, "limit", 1, PROTO_PAGE_MOST, &limit, problem))
        return false;
    *out = (struct proto_page){.limit = (uint32_t)limit,
                               .after = proto_parameters_get(parameters, "after")};
    return true;
}

bool proto_page_parse(const struct proto_parameters *parameters, struct proto_page *out,
                      struct proto_problem *problem)
{
    return page_parse(parameters, proto_list_jobs_parameters, out, problem);
}

bool proto_page_parse_names(const struct proto_parameters *parameters, struct proto_page *out,
                            struct proto_problem *problem)
{
    if (!page_parse(parameters, proto_list_meshes_parameters, out, problem)) return false;
    out->prefix = proto_parameters_get(parameters, "prefix");
    return true;
}

bool proto_page_number(const struct proto_page *page, int64_t *out, struct proto_problem *problem)
{
    char *end = NULL;
    *out = page->after ? strtoll(page->after, &end, 10) : -1;
    if (!page->after || (end != page->after && !*end && *out >= 0)) return true;
    return proto_problem_refuse(problem, "after",
                                "write the number of an item, as `next` of the page before has it");
}

const char *proto_page_write_number(int64_t number, char text[PROTO_PAGE_NUMBER])
{
    snprintf(text, PROTO_PAGE_NUMBER, "%lld", (long long)number);
    return text;
}

void proto_page_begin(struct proto_writer *writer, const char *name)
{
    proto_write_object_begin(writer);
    proto_member_array(writer, name);
}

void proto_page_end(struct proto_writer *writer, const char *next)
{
    proto_write_array_end(writer);
    proto_member_string(writer, "next", next);
    proto_write_object_end(writer);
}
