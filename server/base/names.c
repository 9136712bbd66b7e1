/* See names.h. */
#include "server/base/names.h"

#include <stdlib.h>
#include <string.h>

static bool reserve(struct server_names *names)
{
    if (names->count < names->capacity) return true;
    size_t capacity = names->capacity ? 2 * names->capacity : 64;
    void *grown = realloc(names->names, capacity * sizeof *names->names);
    if (!grown) return false;
    names->names = grown;
    names->capacity = capacity;
    return true;
}

void server_names_add(struct server_names *names, const char *name)
{
    if (strlen(name) <= SERVER_NAME_MOST && reserve(names))
        strcpy(names->names[names->count++], name);
    else
        names->is_incomplete = true;
}

static int compare(const void *a, const void *b)
{
    return strcmp(a, b);
}

void server_names_sort(struct server_names *names)
{
    if (names->count) qsort(names->names, names->count, sizeof *names->names, compare);
}

bool server_names_has(const struct server_names *names, const char *name)
{
    return names->count && bsearch(name, names->names, names->count, sizeof *names->names, compare);
}

void server_names_free(struct server_names *names)
{
    free(names->names);
    *names = (struct server_names){0};
}
