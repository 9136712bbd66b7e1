#include <stdlib.h>
#include <string.h>

#include "field/layout.h"
#include "mesh/segment.h"
#include "base/prefetch.h"

enum { SEEDS_AHEAD = 24 };

/* Finds the edge or the face whose interior contains a seed; both are GD_NONE for a seed at a
 * vertex. Returns false if the seed is a segment that no face contains. */
static bool home_of(const struct gd_mesh *mesh, const struct gd__seed *seed,
                    struct gd__segment_location *location)
{
    if (seed->is_segment) return gd__segment_locate(mesh, &seed->point, &seed->end, location);
    location->face = seed->point.kind == GD_POINT_FACE ? seed->point.element : GD_NONE;
    location->edge = seed->point.kind == GD_POINT_EDGE ? seed->point.element : GD_NONE;
    return true;
}

static int compare_face_seeds(const void *x, const void *y)
{
    const struct gd__face_seed *a = x, *b = y;
    if (a->face != b->face) return a->face < b->face ? -1 : 1;
    return (a->seed > b->seed) - (a->seed < b->seed);
}

static enum gd_status open_index(struct gd_field *field)
{
    field->face_seeds = malloc(sizeof *field->face_seeds * 2 * field->seed_count);
    return field->face_seeds ? GD_OK : GD_NO_MEMORY;
}

static void append_face_seed(struct gd_field *field, uint32_t face, uint32_t seed)
{
    if (face != GD_NONE)
        field->face_seeds[field->face_seed_count++] = (struct gd__face_seed){face, seed};
}

/* Adds the entries of a seed. Returns false if the seed is a segment that no face contains. */
static bool enter_seed(struct gd_field *field, uint32_t seed)
{
    struct gd__seed *s = &field->seeds[seed];
    struct gd__segment_location location;
    if (!home_of(field->mesh, s, &location)) return false;
    field->has_segments |= s->is_segment;
    /* The seeds of an image are read-only, and they are not propagated. */
    if (s->is_segment && !field->is_image) s->face = location.face;
    append_face_seed(field, location.face, seed);
    for (uint32_t k = 0; k < 2 && location.edge != GD_NONE; k++)
        append_face_seed(field, field->mesh->side_face[2 * location.edge + k], seed);
    return true;
}

static void close_index(struct gd_field *field)
{
    qsort(field->face_seeds, field->face_seed_count, sizeof *field->face_seeds, compare_face_seeds);
}

enum gd_status gd__field_index_seeds(struct gd_field *field)
{
    enum gd_status status = open_index(field);
    for (uint32_t i = 0; i < field->seed_count && !status; i++)
        if (!enter_seed(field, i)) status = GD_INVALID_ARGUMENT;
    if (!status) close_index(field);
    return status;
}

static void copy_seed(struct gd__seed *to, const struct gd_seed *from, double unit)
{
    memset(to, 0, sizeof *to); /* zeroes the padding too, because images contain it */
    to->point = from->point;
    to->offset = from->offset / unit;
    to->is_segment = from->is_segment;
    if (from->is_segment) to->end = from->end;
}

/* Prefetches the faces of a seed's edge, because consecutive faces along a curve are not neighbours
 * in memory. */
GD__PREFETCH prefetch_faces(const struct gd_mesh *mesh, const struct gd_seed *seed)
{
    if (seed->point.kind == GD_POINT_EDGE)
        __builtin_prefetch(&mesh->side_face[2 * seed->point.element]);
}

/* Checks, copies and indexes each seed while it is in the cache. */
static enum gd_status take_each(struct gd_field *field, const struct gd_field_request *request,
                                struct gd_detail *detail)
{
    for (uint32_t i = 0; i < request->seed_count; i++) {
        const struct gd_seed *seed = &request->seeds[i];
        if (i + SEEDS_AHEAD < request->seed_count) prefetch_faces(field->mesh, seed + SEEDS_AHEAD);
        if (!(seed->offset >= 0 && isfinite(seed->offset)))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "source %u: the offset must be a finite number, zero or more", i);
        copy_seed(&field->seeds[i], seed, field->mesh->unit);
        if (!enter_seed(field, i))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "source %u: a segment must join two different points of one face", i);
    }
    return GD_OK;
}

enum gd_status gd__field_take_seeds(struct gd_field *field, const struct gd_field_request *request,
                                    struct gd_detail *detail)
{
    field->seed_count = request->seed_count;
    field->seeds = malloc(request->seed_count * sizeof *field->seeds);
    enum gd_status status = field->seeds ? open_index(field) : GD_NO_MEMORY;
    if (status) return gd_fail_status(detail, status);
    status = take_each(field, request, detail);
    if (!status) close_index(field);
    return status;
}

/* --- lookup ----------------------------------------------------------------------------------- */

struct gd__face_seeds gd__field_seeds_in(const struct gd_field *field, uint32_t face)
{
    uint32_t lo = 0, hi = field->face_seed_count;
    while (lo < hi) {
        uint32_t middle = lo + (hi - lo) / 2;
        if (field->face_seeds[middle].face < face)
            lo = middle + 1;
        else
            hi = middle;
    }
    while (hi < field->face_seed_count && field->face_seeds[hi].face == face) hi++;
    return (struct gd__face_seeds){field->face_seeds + lo, field->face_seeds + hi};
}
