#include "proto/http/page.h"

#include <stdio.h>
#include <stdlib.h>

#include "generated/queries.h"

bool proto_page_parse(const struct proto_parameters *parameters, struct proto_page *out,
                      struct proto_problem *problem)
{
    return proto_parameters_check(parameters, proto_list_jobs_parameters, problem) &&
           proto_page_parse_names(parameters, out, problem);
}

bool proto_page_parse_names(const struct proto_parameters *parameters, struct proto_page *out,
                            struct proto_problem *problem)
{
    struct proto_list_meshes_query query;
    if (!proto_parameters_check(parameters, proto_list_meshes_parameters, problem) ||
        !proto_list_meshes_query_parse(parameters, &query, problem))
        return false;
    *out = (struct proto_page){(uint32_t)query.limit, query.after, query.prefix};
    return true;
}

bool proto_page_number(const struct proto_page *page, int64_t *out, struct proto_problem *problem)
{
    char *end = NULL;
    *out = page->after ? strtoll(page->after, &end, 10) : -1;
    if (!page->after || (end != page->after && !*end && *out >= 0)) return true;
    return proto_problem_refuse(problem, "after",
                                "write the number of an item, as in `next` of the preceding "
                                "page");
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
