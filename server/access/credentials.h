/* Credentials: the keys by which the daemon knows its users. Read from a file with a line for each
 * key, which `geodesicd keygen` prints:
 *
 *     # name  SHA-256 of the key  what it may do
 *     ci      sha256:9f86d0…      role=write expires=2027-01-31 rate=50 concurrent=8
 *     viewer  sha256:60303a…      role=read tenant=ci
 *     watch   sha256:cd42404d…    role=operator
 *
 * Each key has names of its own for what is uploaded with it, unless tenant= says whose it shares;
 * "tenant=" alone: those of a daemon without keys.
 *
 * A key is 256 random bits, shown once to who makes it; the file holds its SHA-256 only. A set of
 * keys is immutable and counted: a new file makes a new set, in which a name keeps what it has used
 * of its limits. */
#ifndef SERVER_ACCESS_CREDENTIALS_H
#define SERVER_ACCESS_CREDENTIALS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/access/limits.h"
#include "server/base/sha256.h"

#define SERVER_CREDENTIAL_NAME 65 /* with the NUL */
#define SERVER_CREDENTIAL_PREFIX                                                                   \
    "gdk_" /* so that people, and programs that look for secrets, know one when they see it */
#define SERVER_CREDENTIALS_MOST 10000

/* X(NAME, name): read asks, write also changes, operator asks and sees the metrics of all
 * tenants */
#define SERVER_ROLES(X) X(READ, read) X(WRITE, write) X(OPERATOR, operator)

enum server_role {
#define SERVER_ROLE_ENUM(NAME, name) SERVER_ROLE_##NAME,
    SERVER_ROLES(SERVER_ROLE_ENUM)
#undef SERVER_ROLE_ENUM
};

struct server_credential {
    /* [A-Za-z0-9_-][A-Za-z0-9._-]*: as names of surfaces are */
    char name[SERVER_CREDENTIAL_NAME];
    char tenant[SERVER_CREDENTIAL_NAME]; /* whose names it sees (key.h) */
    char sha256[SERVER_SHA256_HEX];
    enum server_role role;
    int64_t expires; /* seconds since 1970; 0: never */
    struct server_limits limits;
    struct server_quota *quota;
};

struct server_credentials;

/* Reads the file. `before` (may be NULL) is the set that it replaces. One reference, or NULL with a
 * sentence in `error` that names the line: unreadable, no key, a line of another form, a name or
 * key that stands twice. */
struct server_credentials *server_credentials_load(const char *path,
                                                   const struct server_credentials *before,
                                                   char *error, size_t error_size);
struct server_credentials *server_credentials_retain(struct server_credentials *keys);
void server_credentials_release(struct server_credentials *keys); /* NULL is harmless */

uint32_t server_credentials_count(const struct server_credentials *keys);
const struct server_credential *server_credentials_at(const struct server_credentials *keys,
                                                      uint32_t index);

/* The key with that text (`size` bytes), or NULL; as the set, to which it belongs. It takes as long
 * for any text. */
const struct server_credential *server_credentials_find(const struct server_credentials *keys,
                                                        const char *text, size_t size);

/* Parses "2027-01-31" (its first second) or "2027-01-31T12:00:00Z". */
bool server_credentials_parse_time(const char *text, int64_t *out);

/* "read", "write" or "operator". */
bool server_credentials_parse_role(const char *text, enum server_role *out);

/* The form of a name. */
bool server_credentials_is_name(const char *text);

#endif
