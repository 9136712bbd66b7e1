/* Derived: the data stored with a derived mesh, that is, a mesh made from another mesh by edits. */
#pragma once

#include <string.h>

#include "proto/queries/derive.h"
#include "server/surfaces/surface.h"

/* The attachment, in the byte order of this machine. The origins of the vertices follow, four
 * doubles each: face and barycentric coordinates. */
struct server_derived {
    char word[8]; /* SERVER_DERIVED_WORD, without a NUL */
    char mesh[PROTO_MESH_NAME + 8],
        /* name and ETag of the original mesh; the name is empty for an upload */
        etag[SERVER_ETAG + 7];
    double largest_distance;           /* largest distance from the original mesh */
    char operations[PROTO_EDITS_TEXT]; /* the edits as JSON, NUL-terminated */
};

#define SERVER_DERIVED_WORD "derived1"

/* Returns the attachment of a mesh that edits made; NULL for other meshes. */
static inline const struct server_derived *server_derived_of(const struct server_surface *surface)
{
    bool is_derived = surface->attachment &&
                      surface->record->attachment_size > sizeof(struct server_derived) &&
                      memcmp(surface->attachment, SERVER_DERIVED_WORD, 8) == 0;
    return is_derived ? surface->attachment : NULL;
}
