/* Key: what tells a surface from all others: whose it is, of what kind, its name. The names of each
 * kind are its own, and so are those of each tenant.
 *
 * As a text, which the store's rows and the names of its manifests are:
 *
 *     bunny                           a mesh of a daemon without tenants
 *     subdivision+cube                a surface of another kind
 *     acme@bunny                      a tenant's
 *     acme@subdivision+cube
 *
 * Neither '@' nor '+' can stand in a tenant, the word of a kind or a name. */
#ifndef SERVER_STORE_KEY_H
#define SERVER_STORE_KEY_H

#include <stdbool.h>

#include "proto/mesh.h"

#define SERVER_TENANT   64 /* most bytes of a tenant, without the NUL */
#define SERVER_KEY_WORD 16 /* of the word of a kind */
/* of the text, with the NUL */
#define SERVER_KEY_TEXT (SERVER_TENANT + SERVER_KEY_WORD + PROTO_MESH_NAME + 3)

struct server_kind;

struct server_key {     /* all strings are borrowed */
    const char *tenant; /* "": the daemon has none */
    const struct server_kind *kind;
    const char *name; /* as proto_mesh_name_check wants it */
};

/* Less than, equal to or greater than 0: by tenant, then kind, then name, each in byte order. */
int server_key_compare(const struct server_key *a, const struct server_key *b);

/* Writes the text of a key that is valid. */
void server_key_write(const struct server_key *key, char text[SERVER_KEY_TEXT]);

/* Could `size` bytes be the text of a key, of whatever kind? */
bool server_key_check(const char *text, size_t size);

/* Reads a text that server_key_write wrote; the strings of `*out` are in `text`, which is cut into
 * them. False: it is none, or its kind is not known. */
bool server_key_read(char text[SERVER_KEY_TEXT], struct server_key *out);

/* Can this be a tenant: 1 to SERVER_TENANT characters that names may have? */
bool server_tenant_check(const char *tenant);

#endif
