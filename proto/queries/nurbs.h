/* NURBS: the resource. Its file, which is JSON,
 *
 *     {"degreeU", "degreeV", "knotsU", "knotsV", "controlPoints", "weights"?, "convention"?}
 *     {"parametric": {…}}     a surface of known shape (parametric.h)
 *
 * the options of an upload, and its description. No JSON library shows here. */
#ifndef PROTO_NURBS_H
#define PROTO_NURBS_H

#include "gd/nurbs.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"

struct proto_nurbs_options {
    bool has_convention;              /* of a file that names none */
    unsigned convention;              /* enum gd_nurbs_convention */
    const struct gd_control *control; /* of the reading, borrowed for it; NULL: none */
};

/* Reads convention, and format, which can only be json, and refuses any other parameter. */
bool proto_nurbs_options_parse(const struct proto_parameters *parameters,
                               struct proto_nurbs_options *out, struct proto_problem *problem);

/* What a file says of its surface. */
struct proto_nurbs_form {
    const char *shape;                             /* static: "nurbs", or one of known shape */
    const char *convention;                        /* static; of NURBS only, and so are these: */
    uint32_t degree_u, degree_v, count_u, count_v; /* control points */
    bool is_rational;                              /* the weights differ */
};

/* The surface of a file. invalid_request: it is not JSON of this form; invalid_mesh with the flaw's
 * name as reason: its numbers are no surface; too_large, insufficient_memory. The caller releases
 * `*out`. Memory: about 70 bytes a number. */
bool proto_nurbs_read(const void *bytes, size_t size, const struct proto_nurbs_options *options,
                      struct gd_parametric **out, struct proto_nurbs_form *form,
                      struct proto_problem *problem);

/* All strings are borrowed. */
struct proto_nurbs_description {
    const char *name;
    const char *sha256; /* of the uploaded bytes, lower-case hexadecimal */
    int64_t created;    /* seconds since 1970-01-01T00:00:00Z */
    const char *etag;
    uint64_t memory_bytes;
    struct proto_nurbs_form form;
    const struct gd_parametric *surface;
    /* of the tessellation that shortest paths are first looked for on; 0: it has none, */
    uint64_t seeding_faces;
    const char *obstacle; /* and why */
};

void proto_nurbs_encode(struct proto_writer *writer,
                        const struct proto_nurbs_description *description);

#endif
