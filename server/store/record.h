/* Record: what is remembered of a surface: whose it is, its kind and name, what it was made from,
 * what it is. Not the surface, nor the bytes.
 *
 *     geodesicd record 2
 *     kind mesh                                        its word (kind.h)
 *     tenant                                           whose it is; nothing: the daemon has no
 * tenants name bunny sha256 4ffd…                                     of the file size 2911433 of
 * the file attachment 77c0… 575152                          the same of the attachment; nothing:
 * there is none created 1763730000                               seconds since 1970 memory 18402304
 * bytes of the surface when it is in memory options format=obj&triangulate=true              as in
 * the upload's query string, the format as it was found description {"name":"bunny",…} as GET
 * answers while the surface is not in memory checksum 9a0f… SHA-256 of all the lines above
 *
 * That text is the manifest of a durable store and the row of its database. Version 1, which is
 * read as well, has neither kind (a mesh), nor tenant (none), nor attachment (none). A record is
 * complete before it is shared and immutable from then on, but for its catalogue; it is counted.
 *
 * A surface is made from up to two objects: its file, which a client uploaded or the daemon wrote,
 * and, of a mesh that the daemon made from another surface, an attachment: bytes that mean
 * something only to its maker, such as where on that surface each vertex lies. Objects are known by
 * their content, and shared by the surfaces of one tenant: what one tenant uploads is not told by
 * how long the same takes another. */
#ifndef SERVER_STORE_RECORD_H
#define SERVER_STORE_RECORD_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/work/budget.h"
#include "server/store/key.h"
#include "server/store/options.h"
#include "server/base/sha256.h"

#define SERVER_ETAG 33 /* with the NUL */
/* bytes of an object's id, with the NUL */
#define SERVER_OBJECT (SERVER_SHA256_HEX + SERVER_TENANT + 1)

#define SERVER_DESCRIPTION_MOST ((size_t)1 << 20) /* bytes */
#define SERVER_DESCRIPTION_USUAL                                                                   \
    ((size_t)16 << 10) /* a longer one that is read is shortened, if its kind can do that */

struct server_catalogue;

struct server_record {
    atomic_uint references;
    _Atomic(struct server_catalogue *) catalogue; /* of fields; NULL: there was none as yet */
    const struct server_kind *kind;
    char tenant[SERVER_TENANT + 1];
    char name[PROTO_MESH_NAME + 1];
    char key[SERVER_KEY_TEXT];                                            /* text of the three */
    char sha256[SERVER_SHA256_HEX], attachment_sha256[SERVER_SHA256_HEX]; /* empty: there is none */
    uint64_t size, attachment_size;
    /* without quotes: of the objects and the options, the kind and the tenant */
    char etag[SERVER_ETAG];
    char options[SERVER_OPTIONS];
    uint64_t memory;
    int64_t created;
    char *description;            /* JSON, NUL-terminated, one line, owned */
    struct server_budget *budget; /* that counts it; NULL: none does */
};

/* What a record is made of; all strings are borrowed. */
struct server_origin {
    struct server_key key;
    const char *sha256; /* of the file */
    size_t size;
    const char *options;           /* as the kind's read_options wrote them */
    const char *attachment_sha256; /* NULL: there is none */
    size_t attachment_size;
};

/* A record that is created now; memory and description are for the caller to fill in. The caller
 * has one reference. NULL without memory. */
struct server_record *server_record_create(const struct server_origin *origin);

/* Counts its memory as SERVER_BUDGET_RECORDS until it is released; a record that is counted already
 * is not counted again. Before it is shared. The first is false if there is no room; the second
 * counts what is there, past the limit if need be. */
bool server_record_take(struct server_record *record, struct server_budget *budget);
void server_record_count(struct server_record *record, struct server_budget *budget);

struct server_record *server_record_retain(struct server_record *record);
void server_record_release(struct server_record *record); /* NULL is harmless */

/* Its key, borrowed from the record. */
struct server_key server_record_key(const struct server_record *record);

/* The fields that clients know of this version of the mesh (catalogue.h); the record's. NULL
 * without memory. */
struct server_catalogue *server_record_catalogue(struct server_record *record);

/* Are they made from the same objects with the same options, under the same key? */
bool server_record_equal(const struct server_record *a, const struct server_record *b);

/* --- its objects ------------------------------------------------------------------------------ */

enum server_part { SERVER_PART_FILE, SERVER_PART_ATTACHMENT, SERVER_PARTS };

/* An object of the store's. */
struct server_object {
    char id[SERVER_OBJECT]; /* SHA-256 of its bytes, and of a tenant's a dot and the tenant */
    uint64_t size;
};

/* The object of that part; false: the surface has none. */
bool server_record_object(const struct server_record *record, enum server_part part,
                          struct server_object *out);

/* --- as a text -------------------------------------------------------------------------------- */

/* The text, NUL-terminated, malloc'ed; NULL without memory. */
char *server_record_write(const struct server_record *record, size_t *size);

enum server_record_reading {
    SERVER_RECORD_READ,
    SERVER_RECORD_DAMAGED, /* not what was written */
    /* written by a later version of this program, or of a kind that only a later one has */
    SERVER_RECORD_NEWER,
    SERVER_RECORD_NO_MEMORY /* of this process */
};

/* Reads the text; on success the caller has one reference of `*out`. No text, however damaged, does
 * harm. */
enum server_record_reading server_record_read(const char *text, size_t size,
                                              struct server_record **out);

/* The same of the record whose key has that text: DAMAGED if it is another's. */
enum server_record_reading server_record_read_named(const char *key, const char *text, size_t size,
                                                    struct server_record **out);

#endif
