#include "proto/queries/batch.h"

#include <string.h>

#include "proto/json/decode.h"

/* the line's member that selects members of the answer */
#define SELECT        "select"
#define FORMER_SELECT "fields"

/* --- lines ------------------------------------------------------------------------------------ */

static bool is_blank(const struct proto_batch_line *line)
{
    size_t i = 0;
    while (i < line->size && strchr(" \t\r", line->text[i]) && line->text[i]) i++;
    return i == line->size;
}

bool proto_batch_next(const char *text, size_t size, struct proto_batch_line *line)
{
    while (line->end < size) {
        const char *begin = text + line->end;
        size_t left = size - line->end;
        const char *newline = memchr(begin, '\n', left);
        line->text = begin;
        line->size = newline ? (size_t)(newline - begin) : left;
        line->end += line->size + (newline != NULL);
        line->number++;
        if (!is_blank(line)) return true;
    }
    return false;
}

/* --- a line's own members --------------------------------------------------------------------- */

/* Appends a string to `out`. */
static bool append_string(const json_t *value, char *out, size_t size)
{
    size_t at = strlen(out), length = json_string_length(value);
    if (!json_is_string(value) || length >= size - at) return false;
    memcpy(out + at, json_string_value(value), length + 1);
    return true;
}

static bool append_names(const json_t *names, char *out, size_t size)
{
    for (size_t i = 0; i < json_array_size(names); i++) {
        if (i && strlen(out) + 2 > size) return false;
        if (i) strcat(out, ",");
        if (!append_string(json_array_get(names, i), out, size)) return false;
    }
    return json_array_size(names) > 0;
}

/* Removes the member from the document and copies its text to `out`. Sets `*found` to true if the
 * member was present. */
static bool take_member(json_t *document, const char *member, const char *expected, char *out,
                        size_t size, bool *found, struct proto_problem *problem)
{
    const json_t *value = json_object_get(document, member);
    out[0] = '\0';
    *found = value != NULL;
    if (!value) return true;
    bool is_list =
        json_is_array(value) && (strcmp(member, SELECT) == 0 || strcmp(member, FORMER_SELECT) == 0);
    if (!(is_list ? append_names(value, out, size) : append_string(value, out, size)))
        return proto_problem_refuse_member(problem, "", member, "expected %s", expected);
    json_object_del(document, member);
    return true;
}

/* Reads the selected members, from "select" or "fields". */
static bool take_select(struct proto_batch_query *query, struct proto_problem *problem)
{
    json_t *document = query->document;
    query->is_former = json_object_get(document, FORMER_SELECT) != NULL;
    if (query->is_former && json_object_get(document, SELECT))
        return proto_problem_refuse(problem, "/" FORMER_SELECT,
                                    "\"" FORMER_SELECT "\" is the former name of \"" SELECT
                                    "\"; send only \"" SELECT "\"");
    return take_member(document, query->is_former ? FORMER_SELECT : SELECT,
                       "names of members, as \"a,b\" or as [\"a\", \"b\"]", query->select,
                       sizeof query->select, &query->has_select, problem);
}

static bool take_members(struct proto_batch_query *query, struct proto_problem *problem)
{
    json_t *document = query->document;
    bool has_name = false;
    if (!json_is_object(document))
        return proto_problem_refuse(problem, "", "a line of a batch is one JSON object");
    if (!proto_decode_member(document, "", "query", problem)) return false;
    return take_member(document, "query", "the name of a query, a string", query->name,
                       sizeof query->name, &has_name, problem) &&
           take_select(query, problem) &&
           take_member(document, "geometry", "full, xyz or none", query->geometry,
                       sizeof query->geometry, &query->has_geometry, problem);
}

bool proto_batch_decode(const struct proto_batch_line *line, struct proto_batch_query *out,
                        struct proto_problem *problem)
{
    if (line->size > PROTO_BATCH_LINE)
        return proto_problem_exceed(
            problem, NULL, PROTO_BATCH_LINE,
            "the line is longer than the %d bytes that a line of a batch may have; "
            "send it as a query of "
            "its own",
            PROTO_BATCH_LINE);
    struct proto_batch_query query = {.document =
                                          proto_decode_document(line->text, line->size, problem)};
    if (!query.document) return false;
    bool ok = take_members(&query, problem);
    if (ok)
        *out = query;
    else
        proto_batch_query_free(&query);
    return ok;
}

void proto_batch_query_free(struct proto_batch_query *query)
{
    json_decref(query->document);
    query->document = NULL;
}

/* --- options ---------------------------------------------------------------------------------- */

/* If the place of a problem is a parameter that comes from the line, changes the place to the
 * line's member. */
static bool put_in_line(const struct proto_batch_query *query, struct proto_problem *problem)
{
    bool is_select = query->has_select && strcmp(problem->parameter, SELECT) == 0;
    bool is_geometry = query->has_geometry && strcmp(problem->parameter, "geometry") == 0;
    if (!is_select && !is_geometry) return false;
    problem->parameter[0] = '\0';
    if (is_geometry) return proto_problem_at(problem, "/geometry");
    return proto_problem_at(problem, query->is_former ? "/" FORMER_SELECT : "/" SELECT);
}

bool proto_batch_options(const struct proto_batch_query *query,
                         const struct proto_parameters *defaults, const struct proto_route *route,
                         struct proto_options *out, struct proto_problem *problem)
{
    const char *select = query->has_select ? query->select : proto_parameters_get(defaults, SELECT);
    const char *geometry =
        query->has_geometry ? query->geometry : proto_parameters_get(defaults, "geometry");
    struct proto_options options = proto_options_of(route->fields);
    if (!proto_options_select(&options, select, geometry, problem))
        return put_in_line(query, problem);
    if (!route->has_lines && query->has_geometry && options.geometry != PROTO_GEOMETRY_FULL)
        return proto_options_refuse_geometry(problem, "/geometry");
    if (!proto_options_timeout(defaults, &options, problem)) return false;
    *out = options;
    return true;
}

/* --- the answer ------------------------------------------------------------------------------- */

#define STATUS_200 "{\"status\":200"

size_t proto_batch_begin(struct proto_writer *writer)
{
    size_t begin = writer->size;
    proto_append(writer, STATUS_200, strlen(STATUS_200));
    writer->comma = false;
    return begin;
}

/* Joins the status and the answer to one object: the answer's opening brace becomes a comma. If the
 * answer is an empty object, the closing brace replaces it. */
void proto_batch_end(struct proto_writer *writer, size_t begin)
{
    if (writer->failure) return;
    size_t brace = begin + strlen(STATUS_200);
    bool is_empty = writer->size == brace + 2;
    writer->data[brace] = is_empty ? '}' : ',';
    if (is_empty) writer->size--;
    proto_append(writer, "\n", 1);
}

void proto_batch_refuse(struct proto_writer *writer, size_t begin,
                        const struct proto_batch_line *line, struct proto_problem *problem)
{
    if (problem->element == GD_ELEMENT_NONE) {
        problem->element = GD_ELEMENT_LINE;
        problem->element_count = 1;
        problem->elements[0][0] = line->number;
    }
    writer->size = begin;
    writer->failure = PROTO_WRITER_FINE;
    writer->comma = false;
    proto_problem_encode(writer, problem);
    proto_append(writer, "\n", 1);
}
