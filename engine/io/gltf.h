/* glTF 2.0 while it is being read: the document, its lists, what its buffers hold. gltf.c reads the
 * container and goes through the meshes; gltf_nodes.c says which of them stand where, gltf_data.c
 * finds the numbers of an accessor, gltf_primitive.c makes triangles of them.
 *
 * Invariant: nothing of the document is believed. Every number is looked up by functions below,
 * which check that it is what the format says and within what it points into; a sentence names the
 * byte of the document where it was found wrong. */
#ifndef GD_IO_GLTF_H
#define GD_IO_GLTF_H

#include "io/builder.h"
#include "io/json_tree.h"
#include "io/weld.h"

#define GD__NO_VALUE UINT32_MAX

/* A list of the document, by number. */
struct gd__gltf_list {
    const char *name;
    uint32_t *values; /* owned */
    uint32_t count;
};

/* The lists that matter for shapes. X(member of gd__gltf, name in the document) */
#define GD__GLTF_LISTS(X)                                                                          \
    X(scenes, "scenes")                                                                            \
    X(nodes, "nodes")                                                                              \
    X(meshes, "meshes")                                                                            \
    X(accessors, "accessors")                                                                      \
    X(views, "bufferViews")                                                                        \
    X(buffers, "buffers")

#define GD__GLTF_BUFFERS 1024 /* most buffers of a file */

struct gd__gltf_bytes {
    const char *at;
    size_t size;
};

struct gd__gltf_buffer {
    struct gd__gltf_bytes bytes; /* at NULL: not looked at yet */
    char *decoded;               /* owned, or NULL */
};

struct gd__gltf {
    struct gd__scan scan; /* its cursor stays at the beginning of the document */
    const struct gd_control *control;
    struct gd__json json;
#define GD__GLTF_LIST(member, text) struct gd__gltf_list member;
    GD__GLTF_LISTS(GD__GLTF_LIST)
#undef GD__GLTF_LIST
    struct gd__gltf_bytes binary;   /* the BIN chunk of a GLB; at NULL: there is none */
    struct gd__gltf_buffer *loaded; /* owned: buffers.count of them */
};

/* --- gltf.c ----------------------------------------------------------------------------------- */

/* A mistake in the document at that value. */
#define gd__gltf_fail(gltf, value, status, ...)                                                    \
    gd__scan_fail(&(gltf)->scan, gd__json_at(&(gltf)->json, (value)), (status), __VA_ARGS__)

/* A whole number from 0 to `most` that an object holds; `otherwise` if it holds none. GD_SYNTAX. */
GD_MUST_USE enum gd_status gd__gltf_whole(const struct gd__gltf *gltf, uint32_t object,
                                          const char *name, uint64_t otherwise, uint64_t most,
                                          uint64_t *out);

/* The item of a list that an object names by its number; GD__NO_VALUE if it names none.
 * GD_SYNTAX. */
GD_MUST_USE enum gd_status gd__gltf_reference(const struct gd__gltf *gltf, uint32_t object,
                                              const char *name, const struct gd__gltf_list *list,
                                              uint32_t *out);

/* The number in the list of the item that `value` names. */
GD_MUST_USE enum gd_status gd__gltf_index(const struct gd__gltf *gltf, uint32_t value,
                                          const struct gd__gltf_list *list, uint32_t *out);

/* `count` real numbers of an array that an object holds, left as they are if it holds none.
 * GD_SYNTAX. */
GD_MUST_USE enum gd_status gd__gltf_reals(const struct gd__gltf *gltf, uint32_t object,
                                          const char *name, unsigned count, double *out);

/* --- gltf_data.c ------------------------------------------------------------------------------ */

/* The numbers of an accessor, one element after the other. */
struct gd__gltf_accessor {
    const struct gd__gltf *gltf;
    uint32_t value;      /* of the document */
    unsigned components; /* of an element */
    uint32_t type;       /* of a component: 5120 (byte) to 5126 (float) */
    bool is_normalized;  /* whole numbers stand for [0, 1] or [-1, 1] */
    uint32_t count;      /* of elements */
    const char *at;      /* the first element; NULL: all are zero */
    size_t stride;
    uint32_t next;                      /* the element that comes */
    uint32_t sparse_count, sparse_next; /* elements that stand elsewhere */
    uint32_t sparse_type;
    const char *sparse_indices, *sparse_values;
};

/* How many elements an accessor has, at least 1. GD_SYNTAX. */
GD_MUST_USE enum gd_status gd__gltf_accessor_count(const struct gd__gltf *gltf, uint32_t value,
                                                   uint32_t *out);

/* Opens an accessor of vectors ("VEC3": positions) or of whole numbers ("SCALAR": indices), reading
 * its buffers if they were not read yet. GD_SYNTAX, GD_TRUNCATED (it reaches beyond its bytes),
 * GD_UNSUPPORTED (bytes of another file, compressed bytes), GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__gltf_accessor_open(struct gd__gltf *gltf, uint32_t value,
                                                  bool is_position, struct gd__gltf_accessor *out);

/* The next element, of which there must be one. GD_SYNTAX (sparse indices that don't grow). */
GD_MUST_USE enum gd_status gd__gltf_accessor_next(struct gd__gltf_accessor *accessor,
                                                  double out[3]);

void gd__gltf_buffers_free(struct gd__gltf *gltf);

/* --- gltf_nodes.c ----------------------------------------------------------------------------- */

/* Columns of a 3x4 matrix: x, y, z, and where the origin comes. */
struct gd__gltf_place {
    double columns[4][3];
};

/* What is done to each mesh of the scene. */
struct gd__gltf_visitor {
    enum gd_status (*visit)(struct gd__gltf_visitor *visitor, uint32_t mesh,
                            const struct gd__gltf_place *place);
};

/* Visits the meshes of the scene in the order of its nodes: of the default scene, or else the
 * first; in a file without scenes all nodes that are no child, and in a file without nodes all
 * meshes as they are. A skinned mesh is placed as it is, as the format says. GD_SYNTAX (a node with
 * two parents, or in a circle), GD_UNSUPPORTED (nodes more than 256 deep), GD_NO_MEMORY, and what
 * the visitor returns. */
GD_MUST_USE enum gd_status gd__gltf_walk(const struct gd__gltf *gltf,
                                         struct gd__gltf_visitor *visitor);

/* --- gltf_primitive.c ------------------------------------------------------------------------- */

/* What the primitives of a scene come to. */
struct gd__gltf_sum {
    uint64_t primitives, skipped; /* of all; of these the ones that have no triangles */
    uint64_t vertices, triangles; /* at most */
    uint32_t largest;             /* vertices of a primitive */
};

/* Adds a mesh up. GD_SYNTAX, GD_UNSUPPORTED, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__gltf_count_mesh(const struct gd__gltf *gltf, uint32_t mesh,
                                               struct gd__gltf_sum *sum);

/* The triangles that are being made. */
struct gd__gltf_making {
    struct gd__gltf *gltf;
    struct gd__builder *builder;
    struct gd__weld weld;
    /* owned, sum.largest of them: the builder's vertices of the primitive's */
    uint32_t *vertices;
    uint32_t accessor;           /* whose vertices they are, */
    struct gd__gltf_place place; /* placed so */
    uint64_t done, all;          /* vertices and corners, to tell progress */
};

/* Adds a mesh's triangles, placed, to the builder. All errors of the reader. */
GD_MUST_USE enum gd_status gd__gltf_make_mesh(struct gd__gltf_making *making, uint32_t mesh,
                                              const struct gd__gltf_place *place);

#endif
