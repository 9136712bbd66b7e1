/* Checks single polygons: indices, coordinates, repeated corners, edges of length zero. */
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/large.h"
#include "base/slices.h"
#include "construction/steps.h"
#include "construction/offenders.h"

static enum gd_status check_counts(const struct gd_polygons *polygons, struct gd_detail *detail)
{
    if (polygons->polygon_count == 0) return gd_fail(detail, GD_EMPTY, "the input has no faces");
    uint64_t triangles = gd_polygons_corner_count(polygons) - 2 * (uint64_t)polygons->polygon_count;
    if (!polygons->first) triangles = polygons->polygon_count;
    if (triangles > GD_MESH_MAX_FACES)
        return gd_fail(detail, GD_TOO_LARGE,
                       "the input has %llu triangles; at most %u are supported",
                       (unsigned long long)triangles, GD_MESH_MAX_FACES);
    return GD_OK;
}

static enum gd_status check_sizes(struct gd__construction *work)
{
    const struct gd_polygons *polygons = work->input;
    struct gd_detail *detail = work->detail;
    struct gd__offenders small = {0}, large = {0};
    if (!polygons->first) return GD_OK;
    GD__PACED (&work->pace, i, polygons->polygon_count) {
        uint32_t size = polygons->first[i + 1] - polygons->first[i];
        if (size < 3) gd__offenders_add(&small, i, 0, size);
        if (size > 3) gd__offenders_add(&large, i, 0, size);
    }
    if (small.total) {
        gd_fail(detail, GD_DEGENERATE_FACE, "face %u has %u corners; a face needs three",
                (unsigned)small.lowest[0].a, small.lowest[0].witness);
        return gd__offenders_report(&small, GD_ELEMENT_FACE, GD_DEGENERATE_FACE, detail);
    }
    if (large.total && work->options.refuse_polygons) {
        gd_fail(
            detail, GD_NOT_TRIANGLES,
            "face %u has %u corners and triangulation was refused; %llu faces are not triangles",
            (unsigned)large.lowest[0].a, large.lowest[0].witness, (unsigned long long)large.total);
        return gd__offenders_report(&large, GD_ELEMENT_FACE, GD_NOT_TRIANGLES, detail);
    }
    return GD_OK;
}

static enum gd_status check_indices(struct gd__construction *work)
{
    const struct gd_polygons *polygons = work->input;
    struct gd_detail *detail = work->detail;
    struct gd__offenders offenders = {0};
    GD__PACED (&work->pace, i, polygons->polygon_count) {
        uint32_t end = gd_polygons_first(polygons, i + 1), wrong = end;
        for (uint32_t c = gd_polygons_first(polygons, i); c < end && wrong == end; c++) {
            if (polygons->corners[c] >= polygons->position_count) wrong = c;
        }
        if (wrong < end) gd__offenders_add(&offenders, i, 0, polygons->corners[wrong]);
    }
    if (!offenders.total) return GD_OK;
    gd_fail(detail, GD_INDEX, "face %u names vertex %u, but there are %u vertices, numbered from 0",
            (unsigned)offenders.lowest[0].a, offenders.lowest[0].witness, polygons->position_count);
    return gd__offenders_report(&offenders, GD_ELEMENT_FACE, GD_INDEX, detail);
}

static enum gd_status check_coordinates(struct gd__construction *work)
{
    const struct gd_polygons *polygons = work->input;
    struct gd_detail *detail = work->detail;
    struct gd__offenders infinite = {0}, far = {0};
    GD__PACED (&work->pace, i, polygons->position_count) {
        const double *p = polygons->positions[i];
        double largest = fmax(fmax(fabs(p[0]), fabs(p[1])), fabs(p[2]));
        if (!isfinite(p[0] - p[0] + p[1] - p[1] + p[2] - p[2]))
            gd__offenders_add(&infinite, i, 0, 0);
        else if (largest > GD_EXTENT_MAX)
            gd__offenders_add(&far, i, 0, 0);
    }
    if (infinite.total) {
        gd_fail(detail, GD_NON_FINITE, "vertex %u has a coordinate that is not a finite number",
                (unsigned)infinite.lowest[0].a);
        return gd__offenders_report(&infinite, GD_ELEMENT_VERTEX, GD_NON_FINITE, detail);
    }
    if (far.total) {
        gd_fail(detail, GD_EXTENT,
                "vertex %u has a coordinate beyond %g; use a larger unit of length",
                (unsigned)far.lowest[0].a, GD_EXTENT_MAX);
        return gd__offenders_report(&far, GD_ELEMENT_VERTEX, GD_EXTENT, detail);
    }
    return GD_OK;
}

/* Finds polygons with repeated corners. `seen_in[v]` is 1 + the number of the last polygon with the
 * corner v. A polygon with a bridge to a hole contains both ends of the bridge twice; ear clipping
 * handles this case. */
static void find_repeated_corners(struct gd__construction *work, uint32_t *seen_in,
                                  struct gd__offenders *offenders)
{
    const struct gd_polygons *polygons = work->polygons;
    GD__PACED (&work->pace, i, polygons->polygon_count) {
        bool repeated = false;
        uint32_t face = gd_polygons_first(work->input, i) - 2 * i;
        for (uint32_t c = gd_polygons_first(polygons, i); c < gd_polygons_first(polygons, i + 1);
             c++) {
            uint32_t v = polygons->corners[c];
            if (seen_in[v] == i + 1 && !repeated) {
                if (work->options.repair_split)
                    gd_mended_add(&work->mesh->repair->faces_cut, face, v);
                else
                    gd__offenders_add(offenders, i, 0, v);
                repeated = true;
            }
            seen_in[v] = i + 1;
        }
    }
}

static enum gd_status check_repeated_corners(struct gd__construction *work)
{
    struct gd_detail *detail = work->detail;
    uint32_t *seen_in = gd__large_zeroed(work->polygons->position_count, sizeof *seen_in);
    if (!seen_in) return GD_NO_MEMORY;
    struct gd__offenders offenders = {0};
    find_repeated_corners(work, seen_in, &offenders);
    free(seen_in);
    if (!offenders.total) return GD_OK;
    gd_fail(detail, GD_DEGENERATE_FACE,
            "face %u has vertex %u as two of its corners; repair=split cuts it there",
            (unsigned)offenders.lowest[0].a, offenders.lowest[0].witness);
    return gd__offenders_report(&offenders, GD_ELEMENT_FACE, GD_DEGENERATE_FACE, detail);
}

static enum gd_status check_edge_lengths(struct gd__construction *work)
{
    const struct gd_polygons *polygons = work->polygons;
    struct gd_detail *detail = work->detail;
    struct gd__offenders offenders = {0};
    GD__PACED (&work->pace, i, polygons->polygon_count) {
        uint32_t first = gd_polygons_first(polygons, i), end = gd_polygons_first(polygons, i + 1);
        uint32_t a = end > first ? polygons->corners[end - 1] : GD_NONE;
        for (uint32_t c = first; c < end; c++) {
            uint32_t b = polygons->corners[c];
            const double *p = polygons->positions[a], *q = polygons->positions[b];
            if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2])
                gd__offenders_add(&offenders, a < b ? a : b, a < b ? b : a, i);
            a = b;
        }
    }
    if (!offenders.total) return GD_OK;
    const struct gd__offender *edge = &offenders.lowest[0];
    gd_fail(
        detail, GD_DEGENERATE_FACE,
        "edge %u-%u of face %u has length zero: its vertices have the same position; merge them",
        (unsigned)edge->a, (unsigned)edge->b, edge->witness);
    return gd__offenders_report(&offenders, GD_ELEMENT_EDGE, GD_DEGENERATE_FACE, detail);
}

static enum gd_status check_tolerance(const struct gd_mesh_options *options,
                                      struct gd_detail *detail)
{
    if (!options->weld || (isfinite(options->weld_tolerance) && options->weld_tolerance >= 0))
        return GD_OK;
    return gd_fail(detail, GD_INVALID_ARGUMENT,
                   "the weld tolerance is %g; it must be a finite length of at least 0",
                   options->weld_tolerance);
}

enum gd_status gd__validate(struct gd__construction *work)
{
    enum gd_status status = check_tolerance(&work->options, work->detail);
    if (!status) status = check_sizes(work);
    if (!status) status = check_counts(work->input, work->detail);
    if (!status) status = check_indices(work);
    if (!status) status = check_coordinates(work);
    return status;
}

struct triangle_check {
    const struct gd_polygons *polygons;
    atomic_bool has_offenders;
};

/* Finds edges of length zero. A triangle that repeats a corner has one. */
static void check_triangles(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    struct triangle_check *check = context;
    const double(*positions)[3] = (const double(*)[3])check->polygons->positions;
    bool has_offenders = false;
    (void)pace;
    for (uint32_t i = begin; i < end; i++) {
        const uint32_t *corner = check->polygons->corners + 3 * (size_t)i;
        const double *p = positions[corner[0]], *q = positions[corner[1]],
                     *r = positions[corner[2]];
        has_offenders |= (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) ||
                         (q[0] == r[0] && q[1] == r[1] && q[2] == r[2]) ||
                         (r[0] == p[0] && r[1] == p[1] && r[2] == p[2]);
    }
    if (has_offenders) atomic_store_explicit(&check->has_offenders, true, memory_order_relaxed);
}

enum gd_status gd__validate_corners(struct gd__construction *work)
{
    if (!work->polygons->first) {
        struct triangle_check check = {.polygons = work->polygons};
        gd__slices_run(&work->pace, work->polygons->polygon_count, check_triangles, &check);
        if (!check.has_offenders) return GD_OK;
    }
    enum gd_status status = check_repeated_corners(work);
    if (!status) status = check_edge_lengths(work);
    return status;
}
