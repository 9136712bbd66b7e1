/* See address.h. */
#include "server/store/postgres/address.h"

#include <postgresql/libpq-fe.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STANDARD_PORT 5432
#define PATH          4096

/* Visits the value of each keyword that the address sets, or else the environment. */
static bool each_value(const char *url,
                       void (*visit)(void *user, const char *keyword, const char *value),
                       void *user)
{
    PQconninfoOption *given = PQconninfoParse(url, NULL),
                     *standard = given ? PQconndefaults() : NULL;
    bool is_read = given && standard;
    for (int i = 0; is_read && given[i].keyword; i++) { /* both have the order of libpq */
        const char *value = given[i].val ? given[i].val : standard[i].val;
        if (value && *value) visit(user, given[i].keyword, value);
    }
    PQconninfoFree(given);
    PQconninfoFree(standard);
    return is_read;
}

struct ports {
    char list[256]; /* "5432,5433": one for each host, or for all */
};

static void on_port(void *user, const char *keyword, const char *value)
{
    struct ports *ports = user;
    if (strcmp(keyword, "port") == 0) snprintf(ports->list, sizeof ports->list, "%s", value);
}

bool server_postgres_each_port(const char *url, bool (*visit)(void *user, uint16_t port),
                               void *user)
{
    struct ports ports = {""};
    char *rest = NULL;
    bool goes_on = each_value(url, on_port, &ports);
    if (goes_on && !ports.list[0]) return visit(user, STANDARD_PORT);
    for (char *port = strtok_r(ports.list, ",", &rest); goes_on && port;
         port = strtok_r(NULL, ",", &rest))
        goes_on = visit(user, (uint16_t)strtoul(port, NULL, 10));
    return goes_on;
}

struct files {
    void (*visit)(void *user, const char *file);
    void *user;
    bool names_passwords;
};

static void on_file(void *user, const char *keyword, const char *value)
{
    static const char *const keywords[] = {"passfile",    "sslcert", "sslkey",
                                           "sslrootcert", "sslcrl",  "sslcrldir"};
    struct files *files = user;
    for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++)
        if (strcmp(keyword, keywords[i]) == 0) files->visit(files->user, value);
    files->names_passwords |= strcmp(keyword, "passfile") == 0;
}

bool server_postgres_each_file(const char *url, void (*visit)(void *user, const char *file),
                               void *user)
{
    struct files files = {.visit = visit, .user = user};
    const char *home = getenv("HOME");
    char path[PATH];
    if (!each_value(url, on_file, &files)) return false;
    if (files.names_passwords || !home || !*home) return true;
    if (snprintf(path, sizeof path, "%s/.pgpass", home) < (int)sizeof path) visit(user, path);
    return true;
}
