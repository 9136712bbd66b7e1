/* Indexed polygons: the contents of a mesh file, not yet validated as a surface. engine/io reads
 * and writes polygons; engine/mesh builds meshes from them. */
#ifndef GD_POLYGONS_H
#define GD_POLYGONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/language.h"

GD_EXTERN_C_BEGIN

#define GD_NONE UINT32_MAX

struct gd_polygons {
    double (*positions)[3]; /* position_count entries (x, y, z) */
    uint32_t position_count;
    uint32_t polygon_count;
    /* vertex indices of all polygons, polygon after polygon, each < position_count */
    uint32_t *corners;
    /* polygon_count + 1 offsets into `corners`; NULL means that all polygons are triangles */
    uint32_t *first;
};

static inline uint32_t gd_polygons_first(const struct gd_polygons *polygons, uint32_t polygon)
{
    return polygons->first ? polygons->first[polygon] : 3 * polygon;
}

/* Returns the number of corners of a polygon. */
static inline uint32_t gd_polygons_size(const struct gd_polygons *polygons, uint32_t polygon)
{
    return gd_polygons_first(polygons, polygon + 1) - gd_polygons_first(polygons, polygon);
}

static inline uint32_t gd_polygons_corner_count(const struct gd_polygons *polygons)
{
    return gd_polygons_first(polygons, polygons->polygon_count);
}

static inline bool gd_polygons_are_triangles(const struct gd_polygons *polygons)
{
    for (uint32_t i = 0; polygons->first && i < polygons->polygon_count; i++) {
        if (polygons->first[i + 1] - polygons->first[i] != 3) return false;
    }
    return true;
}

#define GD_MENDED_LISTED 8

/* The number of skipped or changed elements of one kind, and a list of the first ones. */
struct gd_mended {
    uint32_t count;
    uint32_t listed; /* at most GD_MENDED_LISTED */
    uint32_t elements[GD_MENDED_LISTED][2];
};

static inline void gd_mended_add(struct gd_mended *mended, uint32_t a, uint32_t b)
{
    mended->count++;
    if (mended->listed == GD_MENDED_LISTED) return;
    mended->elements[mended->listed][0] = a;
    mended->elements[mended->listed++][1] = b;
}

/* Frees the arrays and zeroes the struct. Accepts NULL and partly built structs. */
void gd_polygons_free(struct gd_polygons *polygons);

GD_EXTERN_C_END

#endif
