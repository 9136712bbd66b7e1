/* Query strings as bodies: the parameters of a query by GET are the members of the body of POST. */
#include <string.h>

#include "proto/json/number.h"
#include "server/api/smooth/smooth.h"

/* Parses u,v. Returns false if the text has another form. */
static bool uv_read(const char *text, double uv[2])
{
    size_t length = proto_number_parse(text, &uv[0]);
    if (!length || text[length] != ',') return false;
    text += length + 1;
    length = proto_number_parse(text, &uv[1]);
    return length && !text[length];
}

bool server_smooth_uv(const char *text, json_t **out)
{
    double uv[2];
    if (!uv_read(text, uv)) return false;
    *out = json_pack("[f, f]", uv[0], uv[1]);
    return true;
}

bool server_smooth_place(const char *text, json_t **out)
{
    uint64_t face = 0, corner = 0;
    double uv[2];
    if (strncmp(text, "f:", 2) != 0) return false;
    text += 2;
    size_t length = proto_integer_parse(text, &face);
    if (!length || text[length] != ':') return false;
    text += length + 1;
    length = proto_integer_parse(text, &corner);
    bool has_corner = length && text[length] == ':';
    if (!uv_read(has_corner ? text + length + 1 : text, uv)) return false;
    *out = json_pack("{s:f, s:f, s:[f, f]}", "face", (double)face, "corner",
                     has_corner ? (double)corner : 0, "uv", uv[0], uv[1]);
    return true;
}

/* Returns a number, a boolean, or the text itself, which the decoder then rejects. Returns NULL if
 * out of memory. */
static json_t *scalar_of(const char *text)
{
    double number = 0;
    size_t length = proto_number_parse(text, &number);
    if (length && !text[length]) return json_real(number);
    if (strcmp(text, "true") == 0 || strcmp(text, "false") == 0) return json_boolean(*text == 't');
    return json_string_nocheck(text);
}

static bool is_option(const char *name)
{
    static const char *const options[] = {"select", "geometry", "format", "timeout_ms"};
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        if (strcmp(name, options[i]) == 0) return true;
    return false;
}

/* Replaces the place of a problem in the body by the name of the parameter. */
static void name_parameter(struct proto_problem *problem)
{
    if (!problem->has_pointer || !problem->pointer[0]) return;
    problem->pointer[1 + strcspn(problem->pointer + 1, "/")] = '\0';
    problem->has_pointer = false;
    proto_problem_at(problem, problem->pointer + 1);
}

bool server_smooth_parse(struct server_query *query, const struct proto_parameters *parameters,
                         const struct server_smooth_ends *ends)
{
    struct proto_problem *problem = query->problem;
    json_t *document = json_object();
    bool ok = true, has_memory = document != NULL;
    for (uint32_t i = 0; i < parameters->count && ok && has_memory; i++) {
        const char *name = parameters->all[i].name, *text = parameters->all[i].value;
        bool is_end = strcmp(name, "from") == 0 || strcmp(name, "to") == 0;
        if (is_option(name)) continue;
        json_t *value = NULL;
        if (!is_end)
            value = scalar_of(text);
        else if (!ends->read(text, &value))
            ok = proto_problem_refuse(problem, name, "expected %s", ends->form);
        has_memory = !ok || (value && !json_object_set_new(document, name, value));
    }
    if (!has_memory) ok = proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    if (ok && !query->kind->decode(query, document)) {
        name_parameter(problem);
        ok = false;
    }
    json_decref(document);
    return ok;
}
