/* Key of a surface: tenant, kind and name. Names are unique within a kind of a tenant.
 *
 * As text, in rows of the store and names of manifests:
 *
 *     bunny                        a mesh; the daemon has no tenants
 *     subdivision+cube             a surface of another kind
 *     acme@bunny                   of a tenant
 *     acme@subdivision+cube
 *
 * Tenants, words of kinds and names contain neither '@' nor '+'. */
#ifndef SERVER_STORE_KEY_H
#define SERVER_STORE_KEY_H

#include <stdbool.h>

#include "proto/values/mesh.h"

#define SERVER_TENANT   64 /* bytes at most, without the NUL */
#define SERVER_KEY_WORD 16 /* of the word of a kind */
/* of the text, with the NUL */
#define SERVER_KEY_TEXT (SERVER_TENANT + SERVER_KEY_WORD + PROTO_MESH_NAME + 3)

struct server_kind;

struct server_key {     /* all strings are borrowed */
    const char *tenant; /* "": the daemon has no tenants */
    const struct server_kind *kind;
    const char *name; /* passes proto_mesh_name_check */
};

/* Orders keys by tenant, kind and name, each in byte order; as strcmp. */
int server_key_compare(const struct server_key *a, const struct server_key *b);

/* Writes the text of a valid key. */
void server_key_write(const struct server_key *key, char text[SERVER_KEY_TEXT]);

/* Returns whether `size` bytes have the form of a key; the kind need not exist. */
bool server_key_check(const char *text, size_t size);

/* Parses a text in place: the strings of `*out` point into `text`. False: the text is no key, or
 * its kind is unknown. */
bool server_key_read(char text[SERVER_KEY_TEXT], struct server_key *out);

/* Returns whether this is a valid tenant: 1 to SERVER_TENANT characters of names. */
bool server_tenant_check(const char *tenant);

#endif
