/* See store.h: what a connection to a PostgreSQL database needs. */
#include <postgresql/libpq-fe.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/store/store.h"

#define STANDARD_PORT "5432"
#define VALUE         4096

/* Copies the value of a keyword that the address sets, or else the environment; empty: neither.
 * False: the address is malformed. */
static bool address_value(const char *url, const char *keyword, char value[VALUE])
{
    PQconninfoOption *given = PQconninfoParse(url, NULL),
                     *standard = given ? PQconndefaults() : NULL;
    bool is_read = given && standard;
    *value = '\0';
    for (int i = 0; is_read && given[i].keyword; i++) { /* both have the order of libpq */
        const char *found = given[i].val ? given[i].val : standard[i].val;
        if (found && strcmp(given[i].keyword, keyword) == 0) snprintf(value, VALUE, "%s", found);
    }
    PQconninfoFree(given);
    PQconninfoFree(standard);
    return is_read;
}

bool server_postgres_each_port(const char *url, bool (*visit)(void *user, uint16_t port),
                               void *user)
{
    char list[VALUE], *rest = list; /* "5432,5433": one for each host, or for all */
    bool goes_on = address_value(url, "port", list);
    if (!*list) strcpy(list, STANDARD_PORT);
    for (char *port; goes_on && (port = strsep(&rest, ","));)
        goes_on = visit(user, (uint16_t)strtoul(*port ? port : STANDARD_PORT, NULL, 10));
    return goes_on;
}

bool server_postgres_each_file(const char *url, void (*visit)(void *user, const char *file),
                               void *user)
{
    static const char *const keywords[] = {"sslcert", "sslkey",    "sslrootcert",
                                           "sslcrl",  "sslcrldir", "passfile"};
    const char *home = getenv("HOME");
    char value[VALUE] = "";
    for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++) {
        if (!address_value(url, keywords[i], value)) return false;
        if (*value) visit(user, value);
    }
    bool has_home = !*value && home && *home; /* `value`: of passfile */
    if (has_home && snprintf(value, sizeof value, "%s/.pgpass", home) < (int)sizeof value)
        visit(user, value);
    return true;
}
