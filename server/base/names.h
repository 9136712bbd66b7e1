/* Names: a set of short names, of files or folders: first all are added, then it is sorted, then it
 * is asked. Not thread-safe. */
#ifndef SERVER_BASE_NAMES_H
#define SERVER_BASE_NAMES_H

#include <stdbool.h>
#include <stddef.h>

#define SERVER_NAME_MOST 95 /* most bytes of a name, without the NUL */

struct server_names { /* all zero is an empty set */
    char (*names)[SERVER_NAME_MOST + 1];
    size_t count, capacity;
    /* there was no memory for one, or it was too long: what the set lacks may be in it */
    bool is_incomplete;
};

void server_names_add(struct server_names *names, const char *name);
void server_names_sort(struct server_names *names);

/* Is the name in the set, which is sorted? O(log n). */
bool server_names_has(const struct server_names *names, const char *name);

void server_names_free(struct server_names *names);

#endif
