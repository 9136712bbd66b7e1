/* Mesh: the resource. Its name, the options of an upload, its description, the choice of a format
 * on the way out. */
#ifndef PROTO_MESH_H
#define PROTO_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "gd/io.h"
#include "gd/mesh.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"

struct json_t; /* of jansson */

#define PROTO_MESH_BOUNDARIES 100 /* of them stand in a description */
#define PROTO_MESH_NAME       128 /* most characters of a name, without the NUL */

/* The name of a mesh in a request. */
struct proto_name {
    char text[PROTO_MESH_NAME + 1];
};
bool proto_name_decode(const struct json_t *value, const char *place, struct proto_name *out,
                       struct proto_problem *problem);

/* Writes the member that names a mesh's origin: `key`: {"name", "etag"}. */
void proto_made_of_encode(struct proto_writer *writer, const char *key, const char *name,
                          const char *etag);

/* [A-Za-z0-9_-][A-Za-z0-9._-]{0,127}; else invalid_request. `name` has `length` bytes and need not
 * be NUL-terminated. */
bool proto_mesh_name_check(const char *name, size_t length, struct proto_problem *problem);

struct proto_mesh_options {
    enum gd_format format; /* GD_FORMAT_ANY: not said */
    struct gd_mesh_options build;
};

/* Reads format, weld (a number >= 0), repair and triangulate, and refuses any other parameter. */
bool proto_mesh_options_parse(const struct proto_parameters *parameters,
                              struct proto_mesh_options *out, struct proto_problem *problem);

/* The format of uploaded bytes: what the options say, else what the bytes show, else what
 * Content-Type says (may be NULL). GD_FORMAT_ANY when nothing tells; gd_read_polygons then fails
 * with GD_UNRECOGNIZED. */
enum gd_format proto_mesh_upload_format(const struct proto_mesh_options *options, const void *bytes,
                                        size_t size, const char *content_type);

/* The format to send a mesh in: ?format=obj|ply|off|stl|glb|gltf, else the best of these by the
 * Accept header (may be NULL), OBJ at a tie. Refuses any other parameter. invalid_request;
 * not_acceptable. */
bool proto_mesh_content_format(const struct proto_parameters *parameters, const char *accept,
                               enum gd_format *out, struct proto_problem *problem);

/* All strings are borrowed. */
struct proto_mesh_description {
    const char *name;
    const char *sha256; /* of the uploaded bytes, lower-case hexadecimal */
    int64_t created;    /* seconds since 1970-01-01T00:00:00Z */
    const char *etag;   /* opaque tag, without the quotes that it has in the header */
    uint64_t fields_cached;
    uint64_t memory_bytes;
    const struct gd_mesh *mesh;
};

void proto_mesh_encode(struct proto_writer *writer,
                       const struct proto_mesh_description *description);

/* Writes a page of the boundary loops: at most `limit`, from the one behind the number `after` on
 * (-1: from the first). */
void proto_boundaries_encode(struct proto_writer *writer, const struct gd_mesh *mesh, int64_t after,
                             uint32_t limit);

/* The description with no more boundaries than one has that is written now, malloc'ed: versions
 * before wrote them all. NULL when it is short, or no description, or without memory. */
char *proto_mesh_shorten(const char *description);

#endif
