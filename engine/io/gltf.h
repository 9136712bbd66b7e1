/* glTF 2.0 reading: the document, its lists, and the data of its buffers. gltf.c reads the
 * container and the meshes. gltf_nodes.c places the meshes of the scene. gltf_data.c reads
 * accessors. gltf_primitive.c converts primitives to triangles.
 *
 * Invariant: the document is not trusted. Every number is read by the functions below, which check
 * its type and its range. An error text names the byte of the document at which the error was
 * found. */
#pragma once

#include "base/arena.h"
#include "io/builder.h"
#include "io/json_tree.h"
#include "io/place.h"
#include "io/weld.h"

#define GD__NO_VALUE UINT32_MAX

/* A top-level list of the document: the JSON values of its items. */
struct gd__gltf_list {
    const char *name;
    uint32_t *values;
    uint32_t count;
};

/* The lists that the reader needs. X(member of gd__gltf, name in the document) */
#define GD__GLTF_LISTS(X)                                                                          \
    X(scenes, "scenes")                                                                            \
    X(nodes, "nodes")                                                                              \
    X(meshes, "meshes")                                                                            \
    X(accessors, "accessors")                                                                      \
    X(views, "bufferViews")                                                                        \
    X(buffers, "buffers")

#define GD__GLTF_BUFFERS 1024 /* largest number of buffers of a file */

struct gd__gltf_bytes {
    const char *at;
    size_t size;
};

/* The functions below store the first failure in `status`. After a failure they return values that
 * must not be used. So a caller may read several values before it checks the status. */
struct gd__gltf {
    enum gd_status status;
    struct gd__scan scan; /* the cursor stays at the beginning of the document */
    const struct gd_control *control;
    struct gd__arena arena; /* the arrays of this struct, and decoded buffers */
    struct gd__json json;
#define GD__GLTF_LIST(member, text) struct gd__gltf_list member;
    GD__GLTF_LISTS(GD__GLTF_LIST)
#undef GD__GLTF_LIST
    struct gd__gltf_bytes binary; /* the BIN chunk of a GLB; binary.at is NULL if there is none */
    /* for each buffer; `at` is NULL until the buffer is loaded */
    struct gd__gltf_bytes *loaded;
};

/* --- gltf.c ----------------------------------------------------------------------------------- */

/* Fails with an error in the document at that JSON value, unless the reader failed before. */
#define gd__gltf_fail(gltf, value, code, ...)                                                      \
    ((void)((gltf)->status ||                                                                      \
            ((gltf)->status = gd__scan_fail(&(gltf)->scan, gd__json_at(&(gltf)->json, (value)),    \
                                            (code), __VA_ARGS__))))

/* Reads the member `name` of an object as a whole number from 0 to `most`. Returns `otherwise` if
 * the member is missing. Error: GD_SYNTAX. */
uint64_t gd__gltf_whole(struct gd__gltf *gltf, uint32_t object, const char *name,
                        uint64_t otherwise, uint64_t most);

/* Reads the member `name` of an object as an index into a list. Returns this item of the list, or
 * GD__NO_VALUE if the member is missing or after a failure. Error: GD_SYNTAX. */
uint32_t gd__gltf_reference(struct gd__gltf *gltf, uint32_t object, const char *name,
                            const struct gd__gltf_list *list);

/* Reads the JSON value `value` as an index into a list. Error: GD_SYNTAX. */
uint32_t gd__gltf_index(struct gd__gltf *gltf, uint32_t value, const struct gd__gltf_list *list);

/* Reads the member `name` of an object as an array of `count` real numbers. Leaves `out` unchanged
 * if the member is missing. Error: GD_SYNTAX. */
void gd__gltf_reals(struct gd__gltf *gltf, uint32_t object, const char *name, unsigned count,
                    double *out);

/* The items of an array: the JSON values from `begin` to before `end`. */
struct gd__gltf_items {
    uint32_t begin, end;
};

/* Reads the member `name` of an object as an array, which is empty if the member is missing. Error:
 * GD_SYNTAX. */
struct gd__gltf_items gd__gltf_items(struct gd__gltf *gltf, uint32_t object, const char *name);

/* --- gltf_data.c ------------------------------------------------------------------------------ */

/* An accessor that is read one element after the other. */
struct gd__gltf_accessor {
    struct gd__gltf *gltf;
    uint32_t value;      /* JSON value of the accessor */
    unsigned components; /* components per element */
    uint32_t type;       /* type of a component: 5120 (byte) to 5126 (float) */
    /* true if whole numbers represent fractions, scaled to [0, 1] or [-1, 1] */
    bool is_normalized;
    uint32_t count; /* number of elements */
    const char *at; /* the first element; NULL means that all elements are zero */
    size_t stride;
    uint32_t next; /* number of the next element */
    /* number of elements in the sparse list, and index of the next one */
    uint32_t sparse_count, sparse_next;
    uint32_t sparse_type;
    const char *sparse_indices, *sparse_values;
};

/* Returns the number of elements of an accessor, at least 1. Error: GD_SYNTAX. */
uint32_t gd__gltf_accessor_count(struct gd__gltf *gltf, uint32_t value);

/* Opens an accessor of vectors ("VEC3": positions) or of whole numbers ("SCALAR": indices). Loads
 * its buffers if necessary. Errors: GD_SYNTAX, GD_TRUNCATED (the accessor extends beyond its
 * buffer), GD_UNSUPPORTED (data in another file, compressed data), GD_NO_MEMORY. */
struct gd__gltf_accessor gd__gltf_accessor_open(struct gd__gltf *gltf, uint32_t value,
                                                bool is_position);

/* Reads the next element, which must exist. Error: GD_SYNTAX (sparse indices that do not
 * increase). */
void gd__gltf_accessor_next(struct gd__gltf_accessor *accessor, double out[3]);

/* --- gltf_nodes.c ----------------------------------------------------------------------------- */

/* Called for each mesh of the scene. `user` is the last argument of gd__gltf_walk. */
typedef void gd__gltf_visit(struct gd__gltf *gltf, uint32_t mesh, const struct gd__place *place,
                            void *user);

/* Visits the meshes of the scene in the order of its nodes. Uses the default scene, or the first
 * scene if no default is given. In a file without scenes it visits all root nodes, and in a file
 * without nodes all meshes, untransformed. It places a skinned mesh without a transform, as the
 * format requires. Errors: GD_SYNTAX (a node with two parents, or in a cycle), GD_UNSUPPORTED
 * (nodes nested more than 256 deep), GD_NO_MEMORY, and the errors of the visitor. */
void gd__gltf_walk(struct gd__gltf *gltf, gd__gltf_visit *visit, void *user);

/* --- gltf_primitive.c ------------------------------------------------------------------------- */

/* Sums over the primitives of a scene. */
struct gd__gltf_sum {
    /* number of all primitives, and of the skipped ones (without triangles) */
    uint64_t primitives, skipped;
    uint64_t vertices, triangles; /* upper bounds */
    uint32_t largest;             /* largest number of vertices of a primitive */
};

/* Visitor: adds the primitives of a mesh to the sums, a struct gd__gltf_sum. Errors: GD_SYNTAX,
 * GD_UNSUPPORTED, GD_CANCELLED, GD_DEADLINE. */
gd__gltf_visit gd__gltf_count_mesh;

/* State of the conversion to triangles. */
struct gd__gltf_making {
    struct gd__gltf *gltf;
    struct gd__builder *builder;
    struct gd__weld weld;
    /* sum.largest items: for each vertex of `accessor`, its number in the builder */
    uint32_t *vertices;
    uint32_t accessor;      /* the accessor to which `vertices` belongs */
    struct gd__place place; /* the placement of these vertices */
    /* converted and total numbers of vertices and corners, for the progress */
    uint64_t done, all;
};

/* Visitor: adds the triangles of a mesh, transformed by `place`, to the builder of a struct
 * gd__gltf_making. Errors: those of gd_read_polygons. */
gd__gltf_visit gd__gltf_make_mesh;
