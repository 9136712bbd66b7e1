/* See kind.h. */
#include "server/store/kind.h"

#include <string.h>

const struct server_kind *server_kind_by_word(const char *word)
{
    for (size_t i = 0; server_kinds[i]; i++)
        if (strcmp(server_kinds[i]->word, word) == 0) return server_kinds[i];
    return NULL;
}

const struct server_kind *server_kind_by_plural(const char *plural)
{
    for (size_t i = 0; server_kinds[i]; i++)
        if (strcmp(server_kinds[i]->plural, plural) == 0) return server_kinds[i];
    return NULL;
}

bool server_options_split(const char *text, struct server_options *out)
{
    out->count = 0;
    if (strlen(text) >= sizeof out->text) return false;
    strcpy(out->text, text);
    for (char *rest = out->text, *pair; (pair = strsep(&rest, "&"));) {
        char *equals = strchr(pair, '=');
        if (!equals || out->count == SERVER_OPTIONS_MOST) return false;
        *equals = '\0';
        out->names[out->count] = pair;
        out->values[out->count++] = equals + 1;
    }
    return true;
}

static const char *option_get(void *user, const char *name)
{
    const struct server_options *options = user;
    for (unsigned i = 0; i < options->count; i++)
        if (strcmp(options->names[i], name) == 0) return options->values[i];
    return NULL;
}

static void option_each(void *user, bool (*visit)(void *context, const char *name), void *context)
{
    const struct server_options *options = user;
    for (unsigned i = 0; i < options->count; i++)
        if (!visit(context, options->names[i])) return;
}

struct proto_parameters server_options_parameters(struct server_options *options)
{
    return (struct proto_parameters){.get = option_get, .each = option_each, .user = options};
}
