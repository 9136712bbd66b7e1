/* NURBS: a parametric surface as a resource. Reads the options and the file (schema NurbsFile) of
 * an upload, and writes the description. This header does not expose the JSON library. */
#pragma once

#include "gd/nurbs.h"
#include "generated/answers.h"
#include "proto/http/options.h"
#include "proto/json/writer.h"

struct proto_nurbs_options {
    bool has_convention;              /* `convention` applies to files that name none */
    unsigned convention;              /* enum gd_nurbs_convention */
    const struct gd_control *control; /* control of the reading; borrowed; may be NULL */
};

/* Reads the parameters `convention` and `format` (only json); rejects any other parameter. */
bool proto_nurbs_options_parse(const struct proto_parameters *parameters,
                               struct proto_nurbs_options *out, struct proto_problem *problem);

/* The form of the surface in a file. */
struct proto_nurbs_form {
    const char *shape; /* static: "nurbs", or the name of a known shape */
    /* static; this and the following members are only set for NURBS */
    const char *convention;
    uint32_t degree[2], count[2]; /* in u, v; `count` of control points */
    bool is_rational;             /* true if the weights differ */
};

/* Reads the surface of a file. Problems: invalid_request (not JSON of this form), invalid_mesh with
 * the flaw's name as reason (the numbers are not a surface) or `trims` (faulty loops), too_large,
 * insufficient_memory. The caller releases `*out`. Memory: about 70 bytes a number. */
bool proto_nurbs_read(const void *bytes, size_t size, const struct proto_nurbs_options *options,
                      struct gd_parametric **out, struct proto_nurbs_form *form,
                      struct proto_problem *problem);

/* Written by proto_nurbs_encode (generated/answers.h). All strings are borrowed. */
struct proto_nurbs_description {
    const char *name;
    const char *sha256; /* SHA-256 of the uploaded bytes, lower-case hexadecimal */
    int64_t created;    /* seconds since 1970-01-01T00:00:00Z */
    const char *etag;
    uint64_t memory_bytes;
    struct proto_nurbs_form form;
    const struct gd_parametric *surface;
    /* faces of the tessellation that finds candidates for shortest paths; 0 means none */
    uint64_t seeding_faces;
    const char *obstacle;    /* why there is no tessellation */
    uint32_t trimming_loops; /* 0 means not trimmed */
    bool has_outer_loop;
};
