/* Names: a set of strings. Not thread-safe. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct server_names { /* all zero is an empty set */
    void *root;       /* root of a tree of tsearch(3) */
    size_t count;
    bool is_incomplete; /* true if a name may be missing, because memory was short */
};

void server_names_add(struct server_names *names, const char *name); /* copies it */
void server_names_remove(struct server_names *names, const char *name);
bool server_names_has(const struct server_names *names, const char *name);
void server_names_free(struct server_names *names);
