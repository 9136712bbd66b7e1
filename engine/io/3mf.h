/* 3MF reading: tables of the contents of a package's model parts. 3mf_model.c fills the tables from
 * the XML. 3mf.c reads the parts and places the objects of the build.
 *
 * Invariant: the XML is not trusted. A document type declaration (DTD) is rejected, so a file
 * cannot define entities. A path can only name a part of the package. An object refers only to
 * objects that are defined before it. */
#pragma once

#include "io/builder.h"
#include "io/place.h"
#include "io/zip.h"

#define GD__3MF_PARTS 256
/* largest number of objects, of components and of items */
#define GD__3MF_OBJECTS 65536
#define GD__3MF_PATH    256 /* longest name of a part, including its NUL */

/* Largest ratio of XML bytes to bytes of the package. A package that exceeds it is rejected,
 * because it was probably made to exhaust the memory. */
#define GD__3MF_INFLATION 256
/* Largest number of bytes that the XML parser may allocate. */
#define GD__3MF_XML_BYTES ((size_t)16 << 20)

/* A model part of the package. */
struct gd__3mf_part {
    char name[GD__3MF_PATH];
    double unit; /* in millimetres */
};

/* A component of an object, or an item of the build: a reference to an object, and the object's
 * placement. */
struct gd__3mf_use {
    uint32_t part, id; /* the object's part, and its id in this part */
    uint32_t object;   /* number of the object in `objects`, set after all parts are read */
    struct gd__place place;
};

struct gd__3mf_object {
    uint32_t part, id;
    /* true if the object is a support structure or has the type "other"; it is not placed */
    bool is_left_out;
    uint32_t first_vertex, vertex_count;
    uint32_t first_triangle, triangle_count;
    uint32_t first_use, use_count; /* the components of the object */
    /* numbers of vertices and triangles of the object and all its components, saturated at
       UINT32_MAX */
    uint64_t vertices, triangles;
};

/* All arrays grow by a factor of 1.5. */
struct gd__3mf {
    struct gd_detail *detail;
    /* a limit that the caller left 0 is already replaced by the default */
    struct gd_read_options limits;
    struct gd__zip *zip;
    size_t size;      /* bytes of the package */
    bool is_counting; /* true if vertices and triangles are counted but not stored */
    struct gd__3mf_part *parts;
    uint32_t part_count, part_capacity;
    struct gd__3mf_object *objects;
    uint32_t object_count, object_capacity;
    struct gd__3mf_use *uses;
    uint32_t use_count, use_capacity;
    uint32_t first_item, item_count; /* indices in `uses` of the items of the build */
    double (*positions)[3];
    uint32_t vertex_count, vertex_capacity;
    uint32_t (*triangles)[3]; /* vertex numbers within their object */
    uint32_t triangle_count, triangle_capacity;
};

/* --- 3mf.c ------------------------------------------------------------------------------------ */

/* Returns in `out` the number of the part with that name, and adds the part if it is new. Ignores a
 * leading '/'. Errors: GD_UNSUPPORTED (too many parts, or too long a name), GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__3mf_name_part(struct gd__3mf *package, const char *name,
                                             uint32_t *out);

/* Makes room for one more item of `item` bytes in an array. Returns false if there is no memory. */
bool gd__3mf_grow(void **array, uint32_t count, uint32_t *capacity, size_t item);

/* --- 3mf_model.c ------------------------------------------------------------------------------ */

/* Reads the relationships of the package and writes the name of its model part to `out`, which has
 * GD__3MF_PATH characters. Leaves `out` unchanged if there is no model. */
GD_MUST_USE enum gd_status gd__3mf_find_model(struct gd__3mf *package, char *out);

/* Adds the contents of a model part to the tables. Reads items of the build from part 0 only.
 * Errors: GD_SYNTAX, GD_INDEX, GD_NON_FINITE, GD_UNSUPPORTED, GD_TOO_LARGE, GD_NO_MEMORY,
 * GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__3mf_read_model(struct gd__3mf *package, uint32_t part);
