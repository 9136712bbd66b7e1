/* Kind of surface (mesh, NURBS, subdivision): a table of functions that the rest of the server
 * calls. The store uses the names and options; server/surfaces defines the tables and uses the
 * rest. To add a kind: write its table, list it in surfaces/kinds.c and add its paths to
 * openapi.yaml. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "gd/status.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"
#include "proto/values/mesh.h"

#define SERVER_OPTIONS      256 /* largest size of a text of options, with the NUL */
#define SERVER_OPTIONS_MOST 8   /* pairs */

struct server_builder;
struct server_record;
struct server_surface;

/* An uploaded file, from which a kind can guess a format. Borrowed. */
struct server_file {
    const void *bytes;
    size_t size;
    const char *content_type; /* the header Content-Type; NULL means that the request had none */
};

struct server_built { /* an object of a kind, and the bytes that it holds */
    void *object;
    size_t size;
};

struct server_kind {
    const char *word;   /* "mesh", used in records and keys; lower-case letters; never changes */
    const char *plural; /* "meshes", used in paths and as the name of the list */
    const char *noun;   /* "mesh", used in sentences after an article */

    /* Checks the parameters of an upload and writes them as one text in a canonical form. Record
       and ETag contain this text: uploads with the same text and the same bytes are the same
       surface. Options that later versions add are written only if they are set. `file` determines
       options that the parameters omit. If `file` is NULL, the parameters are a text that this
       function wrote earlier. */
    bool (*read_options)(const struct proto_parameters *parameters, const struct server_file *file,
                         char text[SERVER_OPTIONS], struct proto_problem *problem);

    /* Builds the object from the builder's bytes and record->options. Takes memory from the
     * builder's budget before it allocates. On success leaves the object's `out->size` bytes in
     * SERVER_BUDGET_FLIGHT; on failure sets a problem (surface.h). */
    enum gd_status (*build)(const struct server_builder *builder, struct server_built *out);
    void (*release)(void *object);

    /* Writes the answer of GET: one JSON object of at most SERVER_DESCRIPTION_MOST bytes. */
    void (*describe)(struct proto_writer *writer, const struct server_surface *surface);

    /* Shortens a description that an earlier version stored. Returns the shorter text, allocated by
       malloc, or NULL if the description is short enough. This member may be NULL. */
    char *(*shorten)(const char *description);
};

extern const struct server_kind server_kind_mesh, server_kind_nurbs, server_kind_subdivision;

/* All kinds, NULL-terminated. Defined in surfaces/kinds.c. */
extern const struct server_kind *const server_kinds[];

/* Return the kind with that word or plural, or NULL if there is none. */
const struct server_kind *server_kind_by_word(const char *word);
const struct server_kind *server_kind_by_plural(const char *plural);

/* The parameters of a text of options ("format=obj&triangulate=true"). Do not copy this struct. */
struct server_options {
    char text[SERVER_OPTIONS];
    struct proto_parameter pairs[SERVER_OPTIONS_MOST];
    struct proto_parameters parameters;
};

/* Splits a text of options. Returns false if it is malformed. */
bool server_options_split(const char *text, struct server_options *out);

/* --- keys of surfaces ------------------------------------------------------------------------- */

/* Key of a surface: tenant, kind and name. Names are unique within a kind of a tenant.
 *
 * As text, in rows of the store and names of manifests:
 *
 *     bunny                        a mesh; the daemon has no tenants
 *     subdivision+cube             a surface of another kind
 *     acme@bunny                   a mesh of a tenant
 *     acme@subdivision+cube
 *
 * Tenants, words of kinds and names contain neither '@' nor '+'. */
#define SERVER_TENANT   64 /* bytes at most, without the NUL */
#define SERVER_KEY_WORD 16 /* bytes of a kind's word */
/* bytes of the text, with the NUL */
#define SERVER_KEY_TEXT (SERVER_TENANT + SERVER_KEY_WORD + PROTO_MESH_NAME + 3)

struct server_key {     /* all strings are borrowed */
    const char *tenant; /* "" if the daemon has no tenants */
    const struct server_kind *kind;
    const char *name; /* passes proto_mesh_name_check */
};

/* Compares keys by tenant, kind and name, each in byte order. The result is like that of strcmp. */
int server_key_compare(const struct server_key *a, const struct server_key *b);

/* Writes the text of a valid key. */
void server_key_write(const struct server_key *key, char text[SERVER_KEY_TEXT]);

/* Returns true if the `size` bytes have the form of a key. The kind need not exist. */
bool server_key_check(const char *text, size_t size);

/* Parses a text in place; `*out` then points into the text. Returns false if the text is not a key
 * or the kind is unknown. */
bool server_key_read(char text[SERVER_KEY_TEXT], struct server_key *out);

/* Returns true if the tenant is valid: 1 to SERVER_TENANT characters that are allowed in names. */
bool server_tenant_check(const char *tenant);
