/* Makes records for tests, equal to the records that uploads make. */
#pragma once

#include "support.h"

#include "server/store/kind.h"
#include "server/store/record.h"

#define MESH_OPTIONS "format=obj&triangulate=true"

/* Returns the key of a mesh of a daemon without tenants. */
static inline struct server_key mesh_key(const char *name)
{
    return (struct server_key){.tenant = "", .kind = &server_kind_mesh, .name = name};
}

/* Creates a record with that key for a file and an attachment, both given as texts. The attachment
 * may be NULL. */
static inline struct server_record *new_record_of(struct server_key key, const char *options,
                                                  const char *bytes, const char *attachment)
{
    char sha256[SERVER_SHA256_HEX], attachment_sha256[SERVER_SHA256_HEX];
    struct server_origin origin = {
        .key = key, .sha256 = sha256, .size = strlen(bytes), .options = options};
    server_sha256(bytes, strlen(bytes), sha256);
    if (attachment) {
        server_sha256(attachment, strlen(attachment), attachment_sha256);
        origin.attachment_sha256 = attachment_sha256;
        origin.attachment_size = strlen(attachment);
    }
    struct server_record *record = server_record_create(&origin);
    record->description = strdup("{\"name\":\"it\"}");
    record->memory = 1234;
    return record;
}

static inline struct server_record *new_record(const char *name, const char *bytes)
{
    return new_record_of(mesh_key(name), MESH_OPTIONS, bytes, NULL);
}
