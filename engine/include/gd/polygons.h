/* Indexed polygons: what a mesh file holds, before anyone asked whether it is a surface. io makes
 * and writes them, mesh builds from them. */
#ifndef GD_POLYGONS_H
#define GD_POLYGONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GD_NONE UINT32_MAX

struct gd_polygons {
    double (*positions)[3]; /* position_count of them */
    uint32_t position_count;
    uint32_t polygon_count;
    uint32_t *corners; /* the polygons' vertex indices one after the other, each < position_count */
    uint32_t *first;   /* polygon_count + 1 offsets into `corners`; NULL: all are triangles */
};

static inline uint32_t gd_polygons_first(const struct gd_polygons *polygons, uint32_t polygon)
{
    return polygons->first ? polygons->first[polygon] : 3 * polygon;
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

/* Frees the arrays and zeroes the struct. NULL and half-built ones are harmless. */
void gd_polygons_free(struct gd_polygons *polygons);

#ifdef __cplusplus
}
#endif

#endif
