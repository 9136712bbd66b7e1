/* Record of a surface: its key, its description and the names of its objects. A record contains
 * neither the surface nor the bytes of its objects. The text of a record is the manifest of a local
 * store and the row of a database:
 *
 *     geodesicd record 3
 *     kind mesh                         word of the kind (kind.h)
 *     tenant                            empty if the daemon has no tenants
 *     name bunny
 *     sha256 4ffd…                      SHA-256 of the file
 *     size 2911433                      bytes of the file
 *     attachment 77c0… 575152           SHA-256 and size; empty if there is none
 *     created 1763730000                seconds since 1970
 *     memory 18402304                   bytes of the loaded surface
 *     options format=obj&weld=0         as in the query string of the upload
 *     caption scan of the left hand     the `description` that the client gave
 *     description {"name":"bunny",…}    the answer of GET while the surface is not loaded
 *     checksum 9a0f…                    SHA-256 of all lines above
 *
 * A record without a caption is written as version 2, which lacks the line `caption`. Version 1,
 * which is only read, also lacks kind (mesh), tenant and attachment. A record is reference-counted.
 * Once it is shared, only its caption and its attached data change.
 *
 * A surface has up to two objects. The first is the file that a client uploaded or the daemon
 * wrote. A derived mesh also has an attachment, with data of the code that made the mesh. Objects
 * are named by their content, and surfaces of one tenant with the same content share an object.
 * Different tenants share no objects, so that the time of an upload does not reveal the files of
 * other tenants. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/sha256.h"
#include "server/store/kind.h"
#include "server/work/budget.h"

#define SERVER_ETAG   33                                      /* with the NUL */
#define SERVER_OBJECT (SERVER_SHA256_HEX + SERVER_TENANT + 1) /* an object's id, with the NUL */

#define SERVER_CAPTION          (4 * PROTO_CAPTION + 1) /* bytes of a caption, with the NUL */
#define SERVER_DESCRIPTION_MOST ((size_t)1 << 20)       /* bytes */
/* A longer description is shortened when it is read, if the kind has a function for this. */
#define SERVER_DESCRIPTION_USUAL ((size_t)16 << 10)

/* A struct that can be attached to a record begins with this member, and lives as long as the
 * record. */
struct server_attached {
    size_t bytes; /* counted as SERVER_BUDGET_RECORDS */
    void (*destroy)(struct server_attached *attached);
};

enum server_part { SERVER_PART_FILE, SERVER_PART_ATTACHMENT, SERVER_PARTS };

struct server_object {
    /* SHA-256 of the bytes, followed, for a tenant, by a dot and the tenant's name; empty means no
       object */
    char id[SERVER_OBJECT];
    uint64_t size;
};

struct server_record {
    atomic_uint references;
    _Atomic(struct server_attached *) attached; /* NULL means nothing */
    const struct server_kind *kind;
    char tenant[SERVER_TENANT + 1];
    char name[PROTO_MESH_NAME + 1];
    /* kind, tenant and name as one text */
    char key[SERVER_KEY_TEXT];
    char sha256[SERVER_SHA256_HEX], attachment_sha256[SERVER_SHA256_HEX]; /* empty means none */
    uint64_t size, attachment_size;
    struct server_object objects[SERVER_PARTS]; /* their ids have the tenant */
    char etag[SERVER_ETAG]; /* derived from objects, options, kind and tenant; without quotes */
    char options[SERVER_OPTIONS];
    uint64_t memory;
    int64_t created;
    char *caption; /* owned; NULL if empty. Read it with server_record_caption */
    /* JSON without the caption, NUL-terminated, one line, owned */
    char *description;
    struct server_budget *budget; /* budget that counts the record, or NULL */
};

/* The input of server_record_create; all strings are borrowed. */
struct server_origin {
    struct server_key key;
    const char *sha256; /* SHA-256 of the file */
    size_t size;
    const char *options;           /* written by the kind's read_options */
    const char *attachment_sha256; /* NULL means that there is none */
    size_t attachment_size;
};

/* Creates a record with one reference and the current time. The caller sets memory and description.
 * Returns NULL if out of memory. */
struct server_record *server_record_create(const struct server_origin *origin);

/* Count the record as SERVER_BUDGET_RECORDS until it is freed. Call one of the two functions once,
 * before the record is shared. server_record_take returns false if the budget is exhausted;
 * server_record_count may exceed the limit. */
bool server_record_take(struct server_record *record, struct server_budget *budget);
void server_record_count(struct server_record *record, struct server_budget *budget);

struct server_record *server_record_retain(struct server_record *record);
void server_record_release(struct server_record *record); /* NULL is allowed */

/* Returns a copy with that caption and one reference. Nothing is attached to the copy. Returns NULL
 * if out of memory. */
struct server_record *server_record_copy(const struct server_record *record, const char *caption);

/* Sets the caption. The record may be shared. Returns false if out of memory. */
bool server_record_set_caption(struct server_record *record, const char *caption);

/* Writes the caption, one line of UTF-8, or "" if there is none. */
void server_record_caption(const struct server_record *record, char out[SERVER_CAPTION]);

/* Exchanges the captions of two records, which may be shared. */
void server_record_exchange_captions(struct server_record *to, struct server_record *from);

/* Returns true if both records come from the same upload, that is, if they are equal and have the
 * same time of creation. */
bool server_record_is_same_upload(const struct server_record *a, const struct server_record *b);

/* Attaches `made`. If another thread has attached a struct before, destroys `made`. Returns the
 * attached struct. */
struct server_attached *server_record_attach(struct server_record *record,
                                             struct server_attached *made);

/* Returns the key, borrowed from the record. */
struct server_key server_record_key(const struct server_record *record);

/* Returns whether both records have the same key, objects and options. */
bool server_record_equal(const struct server_record *a, const struct server_record *b);

/* Returns the record's text, NUL-terminated, malloc'ed. Returns NULL if out of memory. */
char *server_record_write(const struct server_record *record, size_t *size);

enum server_record_reading {
    SERVER_RECORD_READ,
    SERVER_RECORD_DAMAGED,
    /* a later version of the daemon wrote the record, or only a later version has its kind */
    SERVER_RECORD_NEWER,
    SERVER_RECORD_NO_MEMORY /* this process is out of memory */
};

/* Parses a text that may be damaged in any way. Also returns DAMAGED if `key` is not NULL and the
 * record has another key. After READ the caller owns one reference of `*out`. */
enum server_record_reading server_record_read(const char *key, const char *text, size_t size,
                                              struct server_record **out);
