#include "proto/queries/many.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

#include "generated/queries.h"
#include "proto/http/page.h"

static const char *const queries[] = {
    [PROTO_MANY_ALL_PAIRS] = "all-pairs", [PROTO_MANY_FIELDS] = "fields"};

/* --- reading ---------------------------------------------------------------------------------- */

static bool read_query(const json_t *document, enum proto_many_query *out,
                       struct proto_problem *problem)
{
    const char *name = json_string_value(json_object_get(document, "query"));
    for (int i = 0; name && i < (int)(sizeof queries / sizeof queries[0]); i++) {
        if (strcmp(queries[i], name) != 0) continue;
        *out = (enum proto_many_query)i;
        return true;
    }
    return proto_problem_refuse(problem, "/query",
                                "a batch is of the query \"all-pairs\" or \"fields\"");
}

static bool check_name(const json_t *value, const char *place, struct proto_problem *problem)
{
    const char *name = json_string_value(value);
    if (!name) return proto_problem_refuse(problem, place, "write the name of a mesh");
    if (proto_mesh_name_check(name, strlen(name), problem)) return true;
    return proto_problem_at(problem, place);
}

/* Returns the array of that name, which must have 1 to PROTO_MANY_ITEMS members. Otherwise returns
 * NULL with the problem. */
static const json_t *read_list(const json_t *document, const char *member,
                               struct proto_problem *problem)
{
    const json_t *list = proto_decode_member(document, "", member, problem);
    size_t count = json_array_size(list);
    if (!list) return NULL;
    if (json_is_array(list) && count >= 1 && count <= PROTO_MANY_ITEMS) return list;
    proto_problem_refuse_member(problem, "", member, "list 1 to %d of them", PROTO_MANY_ITEMS);
    return NULL;
}

static bool check_vertices(const json_t *list, struct proto_problem *problem)
{
    size_t i;
    json_t *value;
    json_array_foreach(list, i, value)
    {
        double index = json_number_value(value);
        if (!json_is_number(value) || index < 0 || index > UINT32_MAX - 1 ||
            index != (double)(uint32_t)index)
            return proto_problem_refuse(problem, "/vertices",
                                        "member %zu is not the index of a vertex", i);
    }
    return true;
}

static bool decode_all_pairs(const json_t *document, struct proto_many *out,
                             struct proto_problem *problem)
{
    static const char *const members[] = {"query", "mesh", "vertices", NULL};
    if (!proto_decode_object(document, "", members, problem)) return false;
    if (!check_name(json_object_get(document, "mesh"), "/mesh", problem)) return false;
    const json_t *vertices = read_list(document, "vertices", problem);
    if (!vertices || !check_vertices(vertices, problem)) return false;
    out->item_count = (uint32_t)json_array_size(vertices);
    return true;
}

static bool decode_fields(const json_t *document, struct proto_many *out,
                          struct proto_problem *problem)
{
    static const char *const members[] = {"query", "meshes", "set", "max_distance", NULL};
    static const struct proto_rule rule = {
        .name = "max_distance",
        .is_above = true,
        .most = INFINITY,
        .refusal = "max_distance is more than 0; leave it out for no limit"};
    size_t i;
    json_t *name;
    double reach;
    if (!proto_decode_object(document, "", members, problem)) return false;
    const json_t *meshes = read_list(document, "meshes", problem);
    if (!meshes) return false;
    json_array_foreach(meshes, i, name) if (!check_name(name, "/meshes", problem)) return false;
    if (!proto_decode_member(document, "", "set", problem)) return false;
    if (!proto_take_number(&(struct proto_object){document, "", problem}, &rule, &reach))
        return false;
    out->item_count = (uint32_t)json_array_size(meshes);
    return true;
}

bool proto_many_decode(json_t *document, struct proto_many *out, struct proto_problem *problem)
{
    struct proto_many many = {.document = document};
    if (!json_is_object(document)) return proto_problem_refuse(problem, "", "write a JSON object");
    if (!read_query(document, &many.query, problem)) return false;
    bool is_fine = many.query == PROTO_MANY_ALL_PAIRS ? decode_all_pairs(document, &many, problem)
                                                      : decode_fields(document, &many, problem);
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
