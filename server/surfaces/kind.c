/* See kind.h. */
#include "server/surfaces/kind.h"

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
