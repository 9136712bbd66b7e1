/* PLY header: the elements of a file, in the order in which they appear in the body. */
#pragma once

#include "io/builder.h"

/* X(NAME, name, alternative name, bytes in a binary body) */
#define GD__PLY_TYPE_MAP(X)                                                                        \
    X(CHAR, char, int8, 1)                                                                         \
    X(UCHAR, uchar, uint8, 1)                                                                      \
    X(SHORT, short, int16, 2)                                                                      \
    X(USHORT, ushort, uint16, 2)                                                                   \
    X(INT, int, int32, 4)                                                                          \
    X(UINT, uint, uint32, 4)                                                                       \
    X(FLOAT, float, float32, 4)                                                                    \
    X(DOUBLE, double, float64, 8)

enum gd__ply_type {
#define GD__PLY_TYPE_ENUM(NAME, name, other, size) GD__PLY_##NAME,
    GD__PLY_TYPE_MAP(GD__PLY_TYPE_ENUM)
#undef GD__PLY_TYPE_ENUM
};

/* Returns the bytes of a scalar in a binary body. */
int gd__ply_size(enum gd__ply_type type);

enum gd__ply_encoding { GD__PLY_ASCII, GD__PLY_LITTLE_ENDIAN, GD__PLY_BIG_ENDIAN };

/* The meaning of a property for the reader. */
enum gd__ply_role { GD__PLY_SKIPPED, GD__PLY_X, GD__PLY_Y, GD__PLY_Z, GD__PLY_CORNERS };

struct gd__ply_property {
    uint8_t type; /* enum gd__ply_type of the scalar, or of the items of a list */
    uint8_t count_type;
    uint8_t role; /* enum gd__ply_role */
    bool list;
};

enum gd__ply_kind { GD__PLY_VERTEX, GD__PLY_FACE, GD__PLY_TRISTRIPS, GD__PLY_OTHER };

struct gd__ply_element {
    enum gd__ply_kind kind;
    uint64_t count;
    uint32_t first_property, property_count;
};

#define GD__PLY_ELEMENTS   32
#define GD__PLY_PROPERTIES 512

struct gd__ply_header {
    enum gd__ply_encoding encoding;
    uint32_t element_count, property_count;
    struct gd__ply_element elements[GD__PLY_ELEMENTS];
    struct gd__ply_property properties[GD__PLY_PROPERTIES];
};

/* Reads the header and leaves the cursor at the first byte of the body. Checks that the input is
 * long enough for the counts of the header. Errors: GD_SYNTAX, GD_UNSUPPORTED, GD_TRUNCATED. */
GD_MUST_USE enum gd_status gd__ply_read_header(struct gd__scan *scan, struct gd__builder *builder,
                                               struct gd__ply_header *header);
