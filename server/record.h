/* Record: what is remembered of a surface: its name, what it was made from, what it is. Not the mesh, nor its bytes.
 *
 *     geodesicd record 1
 *     name bunny
 *     sha256 4ffd…                                     of the uploaded bytes
 *     size 2911433                                     of the uploaded bytes
 *     created 1763730000                               seconds since 1970
 *     memory 18402304                                  bytes of the mesh when it is in memory
 *     options format=obj&triangulate=true              as in the upload's query string, the format as it was found
 *     description {"name":"bunny",…}                   as GET answers while the mesh is not in memory
 *     checksum 9a0f…                                   SHA-256 of all the lines above
 *
 * That text is the manifest of a durable store and the row of its database. A record is complete before it is shared
 * and immutable from then on, but for its catalogue; it is counted. */
#ifndef SERVER_RECORD_H
#define SERVER_RECORD_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/mesh.h"
#include "server/sha256.h"

#define SERVER_ETAG 33 /* with the NUL */

struct server_catalogue;

struct server_record {
    atomic_uint references;
    _Atomic(struct server_catalogue *) catalogue; /* of fields; NULL: there was none as yet */
    char name[PROTO_MESH_NAME + 1];
    char sha256[SERVER_SHA256_HEX];
    char etag[SERVER_ETAG]; /* without quotes: of the bytes and the options */
    struct proto_mesh_options options;
    uint64_t size, memory;
    int64_t created;
    char *description; /* JSON, NUL-terminated, one line, owned */
};

/* A record of `size` bytes with that hash, created now; memory and description are for the caller to fill in. The
 * caller has one reference. NULL without memory. */
struct server_record *server_record_create(const char *name, const char sha256[SERVER_SHA256_HEX], size_t size,
                                           const struct proto_mesh_options *options);

struct server_record *server_record_retain(struct server_record *record);
void server_record_release(struct server_record *record); /* NULL is harmless */

/* The fields that clients know of this version of the mesh (catalogue.h); the record's. NULL without memory. */
struct server_catalogue *server_record_catalogue(struct server_record *record);

/* Are they made from the same bytes with the same options, under the same name? */
bool server_record_equal(const struct server_record *a, const struct server_record *b);

/* The text, NUL-terminated, malloc'ed; NULL without memory. */
char *server_record_write(const struct server_record *record, size_t *size);

enum server_record_reading {
    SERVER_RECORD_READ,
    SERVER_RECORD_DAMAGED,  /* not what was written */
    SERVER_RECORD_NEWER,    /* written by a later version of this program */
    SERVER_RECORD_NO_MEMORY /* of this process */
};

/* Reads the text; on success the caller has one reference of `*out`. No text, however damaged, does harm. */
enum server_record_reading server_record_read(const char *text, size_t size, struct server_record **out);

/* The same of the record of that name: DAMAGED if it is another's. */
enum server_record_reading server_record_read_named(const char *name, const char *text, size_t size,
                                                    struct server_record **out);

#endif
