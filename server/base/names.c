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

void server_names_remove(struct server_names *names, const char *name)
{
    char *const *found = tfind(name, &names->root, names_compare), *held = found ? *found : NULL;
    if (!held) return;
    tdelete(held, &names->root, names_compare);
    free(held);
    names->count--;
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
