/* See names.h. */
#include "server/base/names.h"

#include <search.h>
#include <stdlib.h>
#include <string.h>

static int names_compare(const void *a, const void *b)
{
    return strcmp(a, b);
}

void server_names_add(struct server_names *names, const char *name)
{
    char *copy = strdup(name);
    char *const *found = copy ? tsearch(copy, &names->root, names_compare) : NULL;
    bool is_new = found && *found == copy;
    if (!found) names->is_incomplete = true;
    if (!is_new) free(copy);
    names->count += is_new;
}

bool server_names_has(const struct server_names *names, const char *name)
{
    return tfind(name, &names->root, names_compare) != NULL;
}

void server_names_free(struct server_names *names)
{
    tdestroy(names->root, free);
    *names = (struct server_names){0};
}
