/* Edits: each of them, several in turn, and uses of their results. */
#include "tests/fault/operations.h"

#include "gd/edit.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

static struct gd_mesh *closed, *open_ended;
static struct gd_edited subdivided;

static void open_edits(void)
{
    const struct gd_edit_step step = {.kind = GD_EDIT_SUBDIVIDE,
                                      .subdivide = {GD_SUBDIVIDE_LOOP, 1}};
    closed = test_sample("icosphere", (double[SAMPLE_PARAMETERS]){1, 1}, NULL);
    open_ended = test_sample("cylinder", (double[SAMPLE_PARAMETERS]){1, 2, 8, 2}, NULL);
    check_ok(gd_edit_apply(open_ended, &(struct gd_edit_steps){.items = &step, .count = 1}, NULL,
                           &subdivided, NULL),
             NULL);
}

static void digest_edited(struct digest *digest, const void *out)
{
    const struct gd_edited *edited = out;
    const struct gd_polygons *polygons = &edited->polygons;
    digest_bytes(digest, polygons->positions,
                 polygons->position_count * sizeof *polygons->positions);
    digest_bytes(digest, polygons->corners, 3 * polygons->polygon_count * sizeof(uint32_t));
    for (uint32_t i = 0; i < polygons->position_count; i++) {
        digest_number(digest, edited->origins[i].face);
        for (int k = 0; k < 3; k++) digest_number(digest, edited->origins[i].barycentric[k]);
    }
    digest_number(digest, edited->largest_distance);
}

static void discard_edited(void *out)
{
    gd_edited_free(out);
}

static const struct answer an_edited = {sizeof(struct gd_edited), digest_edited, discard_edited};

static enum gd_status apply(const struct gd_mesh *mesh, struct gd_edit_step step, void *out)
{
    return gd_edit_apply(mesh, &(struct gd_edit_steps){.items = &step, .count = 1}, NULL, out,
                         NULL);
}

static enum gd_status simplify(void *out)
{
    return apply(closed, (struct gd_edit_step){.kind = GD_EDIT_SIMPLIFY, .simplify = {.faces = 40}},
                 out);
}

static enum gd_status simplify_within(void *out)
{
    return apply(open_ended,
                 (struct gd_edit_step){.kind = GD_EDIT_SIMPLIFY,
                                       .simplify = {.max_distance = 0.2, .keep_boundary = true}},
                 out);
}

static enum gd_status components(void *out)
{
    return apply(closed,
                 (struct gd_edit_step){.kind = GD_EDIT_COMPONENTS, .components = {.keep = 1}}, out);
}

static enum gd_status subdivide_by(enum gd_subdivide_scheme scheme, void *out)
{
    return apply(open_ended,
                 (struct gd_edit_step){.kind = GD_EDIT_SUBDIVIDE, .subdivide = {scheme, 1}}, out);
}

static enum gd_status subdivide(void *out)
{
    return subdivide_by(GD_SUBDIVIDE_MIDPOINT, out);
}

static enum gd_status subdivide_loop(void *out)
{
    return subdivide_by(GD_SUBDIVIDE_LOOP, out);
}

static enum gd_status subdivide_sqrt3(void *out)
{
    return subdivide_by(GD_SUBDIVIDE_SQRT3, out);
}

static enum gd_status smooth(void *out)
{
    return apply(closed,
                 (struct gd_edit_step){.kind = GD_EDIT_SMOOTH, .smooth = {2, GD_SMOOTH_BOTH, 0.8}},
                 out);
}

static enum gd_status fill(void *out)
{
    return apply(open_ended, (struct gd_edit_step){.kind = GD_EDIT_FILL, .fill = {GD_FILL_EDGES}},
                 out);
}

static enum gd_status several(void *out)
{
    static const struct gd_edit_step steps[] = {
        {.kind = GD_EDIT_FILL, .fill = {GD_FILL_EDGES}},
        {.kind = GD_EDIT_SUBDIVIDE, .subdivide = {GD_SUBDIVIDE_LOOP, 1}},
        {.kind = GD_EDIT_SIMPLIFY, .simplify = {.faces = 30}}};
    return gd_edit_apply(open_ended, &(struct gd_edit_steps){.items = steps, .count = COUNT(steps)},
                         NULL, out, NULL);
}

static void digest_parts(struct digest *digest, const void *out)
{
    const struct gd_edited_parts *parts = out;
    for (uint32_t i = 0; i < parts->count; i++) digest_edited(digest, &parts->items[i]);
}

static void discard_parts(void *out)
{
    gd_edited_parts_free(out);
}

static const struct answer some_parts = {sizeof(struct gd_edited_parts), digest_parts,
                                         discard_parts};

static enum gd_status split(void *out)
{
    return gd_edited_split(&subdivided, 4, NULL, out, NULL);
}

static void digest_distance(struct digest *digest, const void *out)
{
    digest_number(digest, *(const double *)out);
}

static const struct answer a_distance = {sizeof(double), digest_distance, NULL};

static enum gd_status deviation(void *out)
{
    return gd_edit_deviation(open_ended, &subdivided.polygons, NULL, out, NULL);
}

static const struct operation items[] = {
    {"edit: simplify", &an_edited, simplify, GD_OK, NULL},
    {"edit: simplify within a distance", &an_edited, simplify_within, GD_OK, NULL},
    {"edit: components", &an_edited, components, GD_OK, NULL},
    {"edit: subdivide, midpoint", &an_edited, subdivide, GD_OK, NULL},
    {"edit: subdivide, Loop", &an_edited, subdivide_loop, GD_OK, NULL},
    {"edit: subdivide, sqrt(3)", &an_edited, subdivide_sqrt3, GD_OK, NULL},
    {"edit: smooth", &an_edited, smooth, GD_OK, NULL},
    {"edit: fill", &an_edited, fill, GD_OK, NULL},
    {"edit: several", &an_edited, several, GD_OK, NULL},
    {"edit: split", &some_parts, split, GD_OK, NULL},
    {"edit: deviation", &a_distance, deviation, GD_OK, NULL},
};

const struct operations edit_operations = {open_edits, items, COUNT(items)};
