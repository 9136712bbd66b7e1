#include "server/query/form.h"

#include "proto/accept.h"

#define JSON  "application/json"
#define BYTES "application/octet-stream"

enum { MOST_WORDS = 8 };

/* By name: "json" is one, float64 has none. */
static bool choose_by_name(const struct proto_parameters *parameters,
                           const struct server_form *forms, unsigned *out,
                           struct proto_problem *problem)
{
    const char *words[MOST_WORDS + 1] = {"json"};
    unsigned word = 0;
    for (unsigned i = 0; forms[i].name && i + 1 < MOST_WORDS; i++) words[i + 1] = forms[i].name;
    if (!proto_parameters_choice(parameters, "format", words, &word, problem)) return false;
    *out = word ? SERVER_FORM_FIRST + word - 1 : SERVER_FORM_JSON;
    return true;
}

static bool refuse(const struct server_form *forms, struct proto_problem *problem)
{
    proto_problem_set(problem, PROTO_PROBLEM_NOT_ACCEPTABLE,
                      "the answer is %s%s; the request's Accept takes none of it", JSON,
                      forms ? ", or a file: see format" : "");
    return false;
}

static bool choose_by_accept(const char *accept, const struct server_form *forms, bool has_bytes,
                             unsigned *out, struct proto_problem *problem)
{
    unsigned best = proto_accept_quality(accept, JSON);
    unsigned bytes = has_bytes ? proto_accept_quality(accept, BYTES) : 0;
    *out = SERVER_FORM_JSON;
    if (bytes > best) {
        best = bytes;
        *out = SERVER_FORM_BYTES;
    }
    for (unsigned i = 0; forms && forms[i].name; i++) {
        unsigned quality = proto_accept_quality(accept, forms[i].media_type);
        if (quality <= best) continue;
        best = quality;
        *out = SERVER_FORM_FIRST + i;
    }
    return best > 0 || refuse(forms, problem);
}

bool server_form_choose(struct server_exchange *exchange, const struct server_form *forms,
                        bool has_bytes, unsigned *out, struct proto_problem *problem)
{
    struct proto_parameters parameters = server_exchange_parameters(exchange);
    if (forms && parameters.get(parameters.user, "format"))
        return choose_by_name(&parameters, forms, out, problem);
    return choose_by_accept(server_exchange_header(exchange, "Accept"), forms, has_bytes, out,
                            problem);
}

bool server_form_wants_mesh(const struct proto_parameters *parameters,
                            const struct server_form *forms, unsigned form, bool *out,
                            struct proto_problem *problem)
{
    static const char *const words[] = {"false", "true", NULL};
    unsigned word = 0;
    if (!proto_parameters_choice(parameters, "mesh", words, &word, problem)) return false;
    *out = word;
    if (!word || (form >= SERVER_FORM_FIRST && forms[form - SERVER_FORM_FIRST].has_mesh))
        return true;
    return proto_problem_refuse(problem, "mesh",
                                "this format can't have the mesh with it; glb and obj can");
}

const char *const *server_form_parameters(const char *const *names, const struct server_form *forms,
                                          const char **out, unsigned most)
{
    unsigned count = 0;
    bool has_mesh = false;
    if (!forms) return names;
    while (names && *names && count + 3 < most) out[count++] = *names++;
    out[count++] = "format";
    for (; forms->name; forms++) has_mesh = has_mesh || forms->has_mesh;
    if (has_mesh) out[count++] = "mesh";
    out[count] = NULL;
    return out;
}
