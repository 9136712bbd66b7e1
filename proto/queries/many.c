#include "proto/queries/many.h"

#include <jansson.h>
#include <string.h>

#include "generated/queries.h"
#include "generated/requests.h"
#include "proto/http/page.h"

/* --- reading ---------------------------------------------------------------------------------- */

static bool decode_all_pairs(const json_t *document, struct proto_many *out,
                             struct proto_problem *problem)
{
    struct proto_all_pairs_batch_request request;
    if (!proto_all_pairs_batch_request_decode(document, &request, problem)) return false;
    out->item_count = request.vertices.count;
    proto_all_pairs_batch_request_free(&request);
    return true;
}

/* The names are not copied, because a copy of all of them would be large. */
static bool check_meshes(const json_t *document, uint32_t *count, struct proto_problem *problem)
{
    const json_t *list = proto_decode_member(document, "", "meshes", problem);
    struct proto_name name;
    size_t size = json_array_size(list);
    if (!list) return false;
    if (size < 1 || size > PROTO_MANY_ITEMS)
        return proto_problem_refuse(problem, "/meshes", "list 1 to %d of them", PROTO_MANY_ITEMS);
    for (size_t i = 0; i < size; i++)
        if (!proto_name_decode(json_array_get(list, i), "/meshes", &name, problem)) return false;
    *count = (uint32_t)size;
    return true;
}

static bool decode_fields(const json_t *document, struct proto_many *out,
                          struct proto_problem *problem)
{
    struct proto_fields_batch_request request;
    return proto_fields_batch_request_decode(document, &request, problem) &&
           check_meshes(document, &out->item_count, problem) &&
           proto_decode_member(document, "", "set", problem);
}

bool proto_many_decode(json_t *document, struct proto_many *out, struct proto_problem *problem)
{
    struct proto_many many = {.document = document};
    const char *query = json_string_value(json_object_get(document, "query"));
    bool is_fields = query && strcmp(query, "fields") == 0;
    if (!json_is_object(document)) return proto_problem_refuse(problem, "", "write a JSON object");
    if (!is_fields && (!query || strcmp(query, "all-pairs") != 0))
        return proto_problem_refuse(problem, "/query",
                                    "a batch is of the query \"all-pairs\" or \"fields\"");
    many.query = is_fields ? PROTO_MANY_FIELDS : PROTO_MANY_ALL_PAIRS;
    bool is_fine = is_fields ? decode_fields(document, &many, problem)
                             : decode_all_pairs(document, &many, problem);
    if (is_fine) *out = many;
    return is_fine;
}

bool proto_many_read(const void *text, size_t size, struct proto_many *out,
                     struct proto_problem *problem)
{
    json_t *document = proto_decode_document(text, size, problem);
    if (document && proto_many_decode(document, out, problem)) return true;
    json_decref(document);
    return false;
}

void proto_many_free(struct proto_many *many)
{
    json_decref(many->document);
    many->document = NULL;
}

/* --- the query of an item --------------------------------------------------------------------- */

const char *proto_many_mesh(const struct proto_many *many, uint32_t item)
{
    const json_t *names = json_object_get(many->document, "meshes");
    return json_string_value(many->query == PROTO_MANY_FIELDS
                                 ? json_array_get(names, item)
                                 : json_object_get(many->document, "mesh"));
}

static uint32_t vertex_of(const struct proto_many *many, uint32_t item)
{
    return (uint32_t)json_number_value(
        json_array_get(json_object_get(many->document, "vertices"), item));
}

static void write_vertices(struct proto_writer *body, const char *key,
                           const struct proto_many *many, uint32_t from, uint32_t to)
{
    proto_member_array(body, key);
    for (uint32_t i = from; i < to; i++) {
        proto_write_object_begin(body);
        proto_member_uint(body, "vertex", vertex_of(many, i));
        proto_write_object_end(body);
    }
    proto_write_array_end(body);
}

static void copy_member(struct proto_writer *body, const struct proto_many *many,
                        const char *member)
{
    const json_t *value = json_object_get(many->document, member);
    if (!value) return;
    proto_write_key(body, member);
    proto_write_document(body, value);
}

const char *proto_many_ask(const struct proto_many *many, uint32_t item, struct proto_writer *body)
{
    proto_write_object_begin(body);
    if (many->query == PROTO_MANY_ALL_PAIRS) {
        write_vertices(body, "sources", many, item, item + 1);
        write_vertices(body, "targets", many, 0, many->item_count);
    } else {
        copy_member(body, many, "set");
        copy_member(body, many, "max_distance");
    }
    proto_write_object_end(body);
    return many->query == PROTO_MANY_ALL_PAIRS ? "matrix" : "fields";
}

/* --- a page of answers ------------------------------------------------------------------------ */

bool proto_many_parse_page(const struct proto_parameters *parameters, struct proto_many_page *out,
                           struct proto_problem *problem)
{
    struct proto_get_batch_results_query query;
    if (!proto_parameters_check(parameters, proto_get_batch_results_parameters, problem) ||
        !proto_get_batch_results_query_parse(parameters, &query, problem))
        return false;
    const struct proto_page page = {.after = query.after};
    bool has_cursor = query.has_cursor, waits = proto_parameters_get(parameters, "wait") != NULL;
    int64_t after;
    if (!proto_page_number(&page, &after, problem)) return false;
    if (page.after && has_cursor)
        return proto_problem_refuse(problem, "after", "send `after` or `cursor`, not both");
    if (waits && !has_cursor)
        return proto_problem_refuse(problem, "wait",
                                    "send `wait` together with `cursor`, at first cursor=0");
    *out = (struct proto_many_page){.limit = (uint32_t)query.limit,
                                    .is_by_number = has_cursor,
                                    .after = has_cursor ? (int64_t)query.cursor : after,
                                    .wait_s = query.wait};
    return true;
}

bool proto_many_parse_wait(const struct proto_parameters *parameters, uint64_t *wait_s,
                           struct proto_problem *problem)
{
    *wait_s = 0;
    return proto_parameters_check(parameters, proto_get_batch_parameters, problem) &&
           proto_parameters_integer(parameters, "wait", 0, PROTO_MANY_WAIT, wait_s, problem);
}

/* --- the state of a batch --------------------------------------------------------------------- */

bool proto_many_has_ended(const struct proto_many_state *state)
{
    return state->is_cancelled || state->done == state->items;
}

const char *proto_many_state_name(const struct proto_many_state *state)
{
    if (state->done == state->items) return "done";
    return state->is_cancelled ? "cancelled" : "running";
}

void proto_many_encode_answer(struct proto_writer *writer, const struct proto_many *many,
                              uint32_t item, unsigned status, const char *answer, size_t size)
{
    proto_write_object_begin(writer);
    proto_member_uint(writer, "item", item);
    proto_member_uint(writer, "status", status);
    proto_member_string(writer, "mesh", proto_many_mesh(many, item));
    if (many->query == PROTO_MANY_ALL_PAIRS)
        proto_member_uint(writer, "vertex", vertex_of(many, item));
    proto_write_key(writer, status < 400 ? "answer" : "problem");
    proto_write_raw(writer, answer, size);
    proto_write_object_end(writer);
}

void proto_many_end_page(struct proto_writer *writer, const struct proto_many_state *state,
                         int64_t next)
{
    char text[PROTO_PAGE_NUMBER];
    proto_write_array_end(writer);
    proto_member_string(writer, "state", proto_many_state_name(state));
    proto_member_string(writer, "next", next < 0 ? NULL : proto_page_write_number(next, text));
    proto_write_object_end(writer);
}
