/* Fuzzes edits: any edits of a small mesh are refused with a specific error, or result in a mesh
 * whose vertices have origins on the original. The input consists of a few edits, followed by
 * random polygons. */
#include <math.h>
#include <string.h>

#include "gd/edit.h"
#include "gd/point.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/soup.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MOST_STEPS = 3, KINDS = GD_EDIT_FILL + 1 };

static struct gd_edit_step read_step(const uint8_t **data, size_t *size, uint32_t count)
{
    struct gd_edit_step step = {.kind = (enum gd_edit_kind)(soup_next(data, size) % KINDS)};
    uint8_t a = soup_next(data, size), b = soup_next(data, size);
    switch (step.kind) {
    case GD_EDIT_SIMPLIFY: /* the limit of the distance is in lattice steps */
        step.simplify = (struct gd_simplify_options){a % 64, b / 2 * 0.015625, b & 1};
        break;
    case GD_EDIT_COMPONENTS:
        step.components.keep = a % 4;
        break;
    case GD_EDIT_SUBDIVIDE: /* several levels of several steps would make too many faces */
        step.subdivide = (struct gd_subdivide_options){(enum gd_subdivide_scheme)(a % 3),
                                                       count == 1 ? b % 3 : b % 8 != 0};
        break;
    case GD_EDIT_SMOOTH:
        step.smooth = (struct gd_smooth_options){a % 16, (enum gd_smooth_direction)(b % 3),
                                                 b / 255.0 * acos(-1)};
        break;
    case GD_EDIT_FILL:
        step.fill.max_edges = a % 32;
        break;
    }
    return step;
}

static void check_origins(const struct gd_mesh *mesh, const struct gd_edited *edited)
{
    struct gd_point point;
    for (uint32_t i = 0; i < edited->polygons.position_count; i++) {
        const struct gd_origin *origin = &edited->origins[i];
        promise(gd_point_in_face(mesh, (struct gd_face){origin->face}, origin->barycentric, &point,
                                 NULL) == GD_OK);
    }
}

/* Checks the invariants of a single edit of that kind. */
static void check_step(const struct gd_mesh *mesh, const struct gd_edit_step *step,
                       const struct gd_edited *edited, const struct gd_mesh_summary *after)
{
    const struct gd_mesh_summary *before = gd_mesh_summary(mesh);
    double rounding = 1e-12 * gd_vec3_distance(before->min, before->max);
    if (step->kind == GD_EDIT_SIMPLIFY) {
        promise(after->euler_characteristic == before->euler_characteristic);
        promise(after->boundaries == before->boundaries);
        if (step->simplify.max_distance > 0)
            promise(edited->largest_distance <= step->simplify.max_distance + rounding);
    }
    if (step->kind == GD_EDIT_COMPONENTS)
        promise(after->components == (before->components < step->components.keep
                                          ? before->components
                                          : step->components.keep));
    if (step->kind == GD_EDIT_FILL && step->fill.max_edges >= SOUP_VERTICES)
        promise(after->boundaries <= before->boundaries); /* degenerate loops stay open */
}

static void check_edited(const struct gd_mesh *mesh, const struct gd_edit_steps *steps,
                         const struct gd_edited *edited)
{
    struct gd_mesh *made;
    promise(gd_mesh_build(&edited->polygons, NULL, NULL, &made, NULL) == GD_OK);
    promise(isfinite(edited->largest_distance) && edited->largest_distance >= 0);
    promise(gd_mesh_summary(made)->unreferenced_vertices == 0);
    check_origins(mesh, edited);
    if (steps->count == 1) check_step(mesh, steps->items, edited, gd_mesh_summary(made));
    gd_mesh_release(made);
}

static void check_same(const struct gd_edited *a, const struct gd_edited *b)
{
    const struct gd_polygons *p = &a->polygons, *q = &b->polygons;
    promise(p->position_count == q->position_count && p->polygon_count == q->polygon_count);
    promise(memcmp(p->positions, q->positions, p->position_count * sizeof *p->positions) == 0);
    promise(memcmp(p->corners, q->corners, 3 * p->polygon_count * sizeof *p->corners) == 0);
    promise(a->largest_distance == b->largest_distance);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct gd_edit_step items[MOST_STEPS];
    struct gd_edit_steps steps = {.items = items,
                                  .count = 1 + soup_next(&data, &size) % MOST_STEPS};
    struct gd_detail detail = {.text = ""};
    struct gd_edited edited, again;
    struct soup soup;
    for (uint32_t i = 0; i < steps.count; i++) items[i] = read_step(&data, &size, steps.count);
    soup_read(data, size, &soup);
    struct gd_mesh *mesh = soup_build(&soup);
    if (!mesh) return 0;
    for (uint32_t i = 0; i < steps.count; i++)
        if (items[i].kind == GD_EDIT_SIMPLIFY) items[i].simplify.max_distance *= soup.scale;
    enum gd_status status = gd_edit_apply(mesh, &steps, NULL, &edited, &detail);
    if (status) {
        promise(detail.text[0] != '\0' && status != GD_INTERNAL);
    } else {
        check_edited(mesh, &steps, &edited);
        promise(gd_edit_apply(mesh, &steps, NULL, &again, NULL) == GD_OK);
        check_same(&edited, &again);
        gd_edited_free(&edited);
        gd_edited_free(&again);
    }
    gd_mesh_release(mesh);
    return 0;
}
