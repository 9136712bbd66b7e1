#include "proto/queries/batch.h"

#include <stdio.h>
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

static bool refuse_member(struct proto_problem *problem, const char *member, const char *expected)
{
    proto_problem_refuse(problem, "", "expected %s", expected);
    return proto_problem_descend(problem, member);
}

/* Copies a string to the end of `out`. */
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

/* Takes the member out of the document, as text; `*found`: it was there. */
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
        return refuse_member(problem, member, expected);
    json_object_del(document, member);
    return true;
}

/* Takes the names of members, under either name. */
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
    if (line->size > PROTO_BATCH_LINE) {
        proto_problem_set(problem, PROTO_PROBLEM_TOO_LARGE,
                          "the line is longer than the %d bytes that a line of a batch may have; "
                          "send it as a query of "
                          "its own",
                          PROTO_BATCH_LINE);
        return proto_problem_limit(problem, PROTO_BATCH_LINE);
    }
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

struct view {
    const struct proto_batch_query *query; /* NULL: of the batch as a whole */
    const struct proto_parameters *defaults;
};

static const char *get_of_batch(void *user, const char *name)
{
    const struct view *view = user;
    return strcmp(name, SELECT) == 0 ? NULL : view->defaults->get(view->defaults->user, name);
}

static void visit_of_batch(void *user, bool (*visit)(void *context, const char *name),
                           void *context)
{
    const struct view *view = user;
    view->defaults->each(view->defaults->user, visit, context);
}

bool proto_batch_parse(const struct proto_parameters *parameters, struct proto_options *out,
                       struct proto_problem *problem)
{
    struct view view = {.defaults = parameters};
    const struct proto_parameters seen = {
        .get = get_of_batch, .each = visit_of_batch, .user = &view};
    return proto_options_parse(&seen, NULL, proto_post_batch_parameters, out, problem);
}

static const char *get_of_line(void *user, const char *name)
{
    const struct view *view = user;
    if (view->query->has_select && strcmp(name, SELECT) == 0) return view->query->select;
    if (view->query->has_geometry && strcmp(name, "geometry") == 0) return view->query->geometry;
    return view->defaults->get(view->defaults->user, name);
}

/* The names in the query string were looked at before. */
static void visit_of_line(void *user, bool (*visit)(void *context, const char *name), void *context)
{
    (void)user, (void)visit, (void)context;
}

/* A parameter that the line itself said is a member of it. */
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
                         const struct proto_parameters *defaults, const char *const *fields,
                         struct proto_options *out, struct proto_problem *problem)
{
    struct view view = {query, defaults};
    const struct proto_parameters seen = {.get = get_of_line, .each = visit_of_line, .user = &view};
    return proto_options_parse(&seen, fields, NULL, out, problem) || put_in_line(query, problem);
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

/* The answer's opening brace becomes the comma behind the status, or the closing one if the answer
 * has nothing. */
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
