/* Subdivision: a subdivision surface as a resource. Reads the options and the file of an upload,
 * and writes the description. The file is a mesh file of polygons, OBJ with the tag lines of
 * OpenSubdiv, or SubdivisionJson (usd.h). This header does not expose the JSON library. */
#pragma once

#include "gd/limit_mesh.h"
#include "generated/answers.h"

struct proto_subdivision_options {
    enum gd_format format; /* GD_FORMAT_ANY if not given */
    bool has_scheme;       /* false if the scheme is that of the file, or Catmull-Clark */
    enum gd_scheme scheme;
};

/* Reads format and scheme; rejects any other parameter. Problem: invalid_request. */
bool proto_subdivision_options_parse(const struct proto_parameters *parameters,
                                     struct proto_subdivision_options *out,
                                     struct proto_problem *problem);

/* Reads the control mesh of a file. Problems: invalid_request (JSON of another form), invalid_mesh
 * with a reason (not a control mesh), too_large, insufficient_memory, and those of limits->control.
 * `*scheme` follows from options and file. The caller frees `*out`. Memory: about 25 bytes for each
 * byte of the file. */
bool proto_subdivision_read(const void *bytes, size_t size,
                            const struct proto_subdivision_options *options,
                            const struct gd_read_options *limits, struct gd_control_mesh *out,
                            enum gd_scheme *scheme, struct proto_problem *problem);

/* Fills in the problem of a readable control mesh that is not a surface. If a reference names a
 * missing element, the problem is that of a faulty file. Returns false. */
bool proto_subdivision_refuse(enum gd_status status, const struct gd_detail *detail,
                              struct proto_problem *problem);

/* Written by proto_subdivision_encode (generated/answers.h). All strings are borrowed. */
struct proto_subdivision_description {
    const char *name;
    const char *sha256; /* SHA-256 of the uploaded bytes, lower-case hexadecimal */
    int64_t created;    /* seconds since 1970-01-01T00:00:00Z */
    const char *etag;
    uint64_t memory_bytes;
    const struct gd_subdivision *surface;
    struct gd_subdivision_summary summary; /* of the surface */
};
