#include "gd/polygons.h"

#include <stdlib.h>

void gd_polygons_free(struct gd_polygons *polygons)
{
    if (!polygons) return;
    free(polygons->positions);
    free(polygons->corners);
    free(polygons->first);
    *polygons = (struct gd_polygons){0};
}
