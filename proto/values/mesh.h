/* Mesh: a mesh as a resource. Reads its name, the options of an upload and the format of a
 * download; writes its description. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "gd/io.h"
#include "gd/mesh.h"
#include "generated/answers.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"

struct json_t; /* declared by jansson */

#define PROTO_MESH_BOUNDARIES 100 /* largest number of boundaries listed in a description */
#define PROTO_MESH_NAME       128 /* limit on the characters of a name, without the NUL */

/* The name of a mesh in a request. */
struct proto_name {
    char text[PROTO_MESH_NAME + 1];
};
bool proto_name_decode(const struct json_t *value, const char *place, struct proto_name *out,
                       struct proto_problem *problem);

/* Writes the member `key` that names a mesh's origin: {"name", "etag"}. The name "" means that the
 * origin has no name. */
void proto_made_of_encode(struct proto_writer *writer, const char *key, const char *name,
                          const char *etag);

/* Checks that a name has the form [A-Za-z0-9_-][A-Za-z0-9._-]{0,127}. Otherwise fails with
 * invalid_request. `name` has `length` bytes and need not be NUL-terminated. */
bool proto_mesh_name_check(const char *name, size_t length, struct proto_problem *problem);

/* limit on the characters of the description that a client gives a surface */
#define PROTO_CAPTION 200

/* Checks that a caption is UTF-8 of at most PROTO_CAPTION characters, without control characters.
 * Otherwise fails with invalid_request. */
bool proto_caption_check(const char *text, struct proto_problem *problem);

/* Reads `?description=` of an upload, borrowed; NULL if not given. */
bool proto_caption_parse(const struct proto_parameters *parameters, const char **out,
                         struct proto_problem *problem);

/* Decodes the body of a PATCH of a surface: {"description": "…"}, or null to remove the
 * description. `*out` is borrowed from the document; NULL means that the member is missing. */
bool proto_caption_decode(const struct json_t *document, const char **out,
                          struct proto_problem *problem);

/* Adds the member `description` to the object that was just written, unless it is empty. */
void proto_caption_encode(struct proto_writer *writer, const char *text);

struct proto_mesh_options {
    enum gd_format format; /* GD_FORMAT_ANY if not given */
    struct gd_mesh_options build;
};

/* Reads format, weld (a number >= 0), repair and triangulate; rejects any other parameter. */
bool proto_mesh_options_parse(const struct proto_parameters *parameters,
                              struct proto_mesh_options *out, struct proto_problem *problem);

/* Returns the format of uploaded bytes. The format comes from the first of these sources that names
 * one: the options, the bytes (if their format is recognized), Content-Type (may be NULL). If none
 * names a format, returns GD_FORMAT_ANY, for which gd_read_polygons fails with GD_UNRECOGNIZED. */
enum gd_format proto_mesh_upload_format(const struct proto_mesh_options *options, const void *bytes,
                                        size_t size, const char *content_type);

/* Chooses the format of a download. The parameter ?format=obj|ply|off|stl|glb|gltf names it.
 * Without this parameter, chooses the one of these formats that the Accept header (may be NULL)
 * prefers. In a tie, chooses the first one of this list. Rejects any other parameter. Problems:
 * invalid_request, not_acceptable. */
bool proto_mesh_content_format(const struct proto_parameters *parameters, const char *accept,
                               enum gd_format *out, struct proto_problem *problem);

/* All strings are borrowed. */
struct proto_mesh_description {
    const char *name;
    const char *sha256; /* SHA-256 of the uploaded bytes, lower-case hexadecimal */
    int64_t created;    /* seconds since 1970-01-01T00:00:00Z */
    const char *etag;   /* opaque tag, without the quotes of the header */
    uint64_t fields_cached;
    uint64_t memory_bytes;
    const struct gd_mesh *mesh;
    struct {              /* set for a mesh that edits made */
        const char *mesh; /* the original; "" for an upload; NULL means no edits made it */
        const char *etag;
        double largest_distance;
        const char *operations; /* JSON */
    } derived;
};

/* generated/answers.h: proto_mesh_encode writes it. */

/* Writes a page of at most `limit` boundary loops. The page starts after the loop with the number
 * `after`; -1 means with the first loop. */
void proto_boundaries_encode(struct proto_writer *writer, const struct gd_mesh *mesh, int64_t after,
                             uint32_t limit);

/* Returns the description, shortened to PROTO_MESH_BOUNDARIES boundaries, in memory from malloc.
 * Older versions stored all boundaries. Returns NULL if the description is short enough or
 * malformed, or if out of memory. */
char *proto_mesh_shorten(const char *description);
