/* Subdivision: the resource. The options of an upload, its file, and its description. The file is
 * any mesh file of polygons, in OBJ with the tag lines of OpenSubdiv, or JSON with USD's names:
 *
 *     {"points": [[x,y,z]…], "faceVertexCounts", "faceVertexIndices", "creaseIndices"?,
 *      "creaseLengths"?, "creaseSharpnesses"?, "cornerIndices"?, "cornerSharpnesses"?,
 *      "interpolateBoundary"?, "subdivisionScheme"?}
 *
 * No JSON library shows here. */
#ifndef PROTO_SUBDIVISION_H
#define PROTO_SUBDIVISION_H

#include "gd/subdivision.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"

struct proto_subdivision_options {
    enum gd_format format; /* GD_FORMAT_ANY: not said */
    bool has_scheme;       /* else the file's, or Catmull-Clark */
    enum gd_scheme scheme;
};

/* Reads format and scheme, and refuses any other parameter. invalid_request. */
bool proto_subdivision_options_parse(const struct proto_parameters *parameters,
                                     struct proto_subdivision_options *out,
                                     struct proto_problem *problem);

/* The control mesh of a file. invalid_request: it is JSON of another form; invalid_mesh with a
 * reason: it is no control mesh; too_large, insufficient_memory, and those of limits->control.
 * `*scheme` is what options and file say together. The caller frees `*out`. Memory: about 25 bytes
 * for each byte of the file. */
bool proto_subdivision_read(const void *bytes, size_t size,
                            const struct proto_subdivision_options *options,
                            const struct gd_read_options *limits, struct gd_control_mesh *out,
                            enum gd_scheme *scheme, struct proto_problem *problem);

/* The problem of a control mesh that is read and no surface: what names an element that isn't there
 * is a flaw of the file. False. */
bool proto_subdivision_refuse(enum gd_status status, const struct gd_detail *detail,
                              struct proto_problem *problem);

/* All strings are borrowed. */
struct proto_subdivision_description {
    const char *name;
    const char *sha256; /* of the uploaded bytes, lower-case hexadecimal */
    int64_t created;    /* seconds since 1970-01-01T00:00:00Z */
    const char *etag;
    uint64_t memory_bytes;
    const struct gd_subdivision *surface;
};

void proto_subdivision_encode(struct proto_writer *writer,
                              const struct proto_subdivision_description *description);

#endif
