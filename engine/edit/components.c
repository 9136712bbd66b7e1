/* Splits an edited mesh into its components, or keeps some of them. */
#include <stdlib.h>

#include "base/arena.h"
#include "base/pace.h"
#include "edit/edited.h"
#include "mesh/topology.h"
#include "mesh/union_find.h"

struct part {
    double area;
    uint32_t root, first_face;
    uint32_t vertices, faces;
    struct gd_edited *item; /* receives the part; NULL if the part is dropped */
};

struct split {
    const struct gd_edited *edited;
    struct gd__pace pace;
    struct gd__arena arena;
    uint32_t *root; /* for each vertex, the lowest vertex of its component */
    /* first, for each root, its part; later, for each vertex, its number in its part */
    uint32_t *number;
    struct part *parts;
    uint32_t count;
};

static int by_area(const void *a, const void *b)
{
    const struct part *x = a, *y = b;
    if (x->area != y->area) return x->area < y->area ? 1 : -1;
    return x->first_face < y->first_face ? -1 : 1;
}

static double area_of_face(const struct gd_polygons *polygons, const uint32_t *corner)
{
    struct gd_vec3 p[3];
    for (int k = 0; k < 3; k++) memcpy(&p[k], polygons->positions[corner[k]], sizeof p[k]);
    return gd_vec3_length(gd_vec3_cross(gd_vec3_sub(p[1], p[0]), gd_vec3_sub(p[2], p[0]))) / 2;
}

static void find_roots(struct split *split)
{
    const struct gd_polygons *polygons = &split->edited->polygons;
    gd__union_find_init(split->root, polygons->position_count);
    GD__PACED (&split->pace, i, polygons->polygon_count) {
        const uint32_t *corner = &polygons->corners[3 * (size_t)i];
        gd__union_find_join(split->root, corner[0], corner[1]);
        gd__union_find_join(split->root, corner[0], corner[2]);
    }
    GD__PACED (&split->pace, v, polygons->position_count) {
        split->root[v] = gd__union_find_root(split->root, v);
        split->count += split->root[v] == v;
    }
}

/* Fills `parts` in order of decreasing area. Sets `number` of each root to its part. */
static void rank_parts(struct split *split)
{
    const struct gd_polygons *polygons = &split->edited->polygons;
    uint32_t count = 0;
    GD__PACED (&split->pace, v, polygons->position_count) {
        if (split->root[v] == v) {
            split->parts[count] = (struct part){.root = v, .first_face = GD_NONE};
            split->number[v] = count++;
        }
        split->parts[split->number[split->root[v]]].vertices++;
    }
    GD__PACED (&split->pace, i, polygons->polygon_count) {
        const uint32_t *corner = &polygons->corners[3 * (size_t)i];
        struct part *part = &split->parts[split->number[split->root[corner[0]]]];
        if (!part->faces++) part->first_face = i;
        part->area += area_of_face(polygons, corner);
    }
    if (split->pace.status) return;
    qsort(split->parts, split->count, sizeof *split->parts, by_area);
    for (uint32_t i = 0; i < split->count; i++) split->number[split->parts[i].root] = i;
}

/* Finds the components and ranks them. Error: GD_TOO_LARGE (more than `most`). */
static enum gd_status find_parts(struct split *split, uint32_t most, struct gd_detail *detail)
{
    find_roots(split);
    if (split->pace.status) return split->pace.status;
    if (split->count > most)
        return gd_fail(detail, GD_TOO_LARGE,
                       "there are %u components, and at most %u become meshes at a time",
                       split->count, most);
    split->parts = gd__arena_take(&split->arena, split->count, sizeof *split->parts);
    if (!split->parts) return split->arena.status;
    rank_parts(split);
    return split->pace.status;
}

/* Allocates a result for the parts that it receives. Its counts are 0 until fill_parts. */
static enum gd_status item_allocate(struct gd_edited *item, uint32_t vertices, uint32_t faces)
{
    enum gd_status status = gd__edited_allocate(item, vertices, faces);
    item->polygons.position_count = item->polygons.polygon_count = 0;
    return status;
}

/* Fills the parts. Faces and vertices keep their order. A root gets its number in the part before
 * the other vertices of its component, because it is the lowest one. */
static enum gd_status fill_parts(struct split *split)
{
    const struct gd_polygons *polygons = &split->edited->polygons;
    uint32_t *part_of = split->root;
    GD__PACED (&split->pace, v, polygons->position_count) {
        bool is_root = split->root[v] == v;
        part_of[v] = is_root ? split->number[v] : part_of[split->root[v]];
        struct gd_edited *item = split->parts[part_of[v]].item;
        if (!item) continue;
        uint32_t at = split->number[v] = item->polygons.position_count++;
        memcpy(item->polygons.positions[at], polygons->positions[v], sizeof(double[3]));
        item->origins[at] = split->edited->origins[v];
    }
    GD__PACED (&split->pace, i, polygons->polygon_count) {
        const uint32_t *corner = &polygons->corners[3 * (size_t)i];
        struct gd_edited *item = split->parts[part_of[corner[0]]].item;
        if (!item) continue;
        uint32_t *to = &item->polygons.corners[3 * (size_t)item->polygons.polygon_count++];
        for (int k = 0; k < 3; k++) to[k] = split->number[corner[k]];
    }
    return split->pace.status;
}

static struct split split_begin(const struct gd_edited *edited, uint32_t vertices,
                                const struct gd_control *control)
{
    struct split split = {.edited = edited, .pace = {.control = control}};
    split.root = gd__arena_take(&split.arena, vertices, sizeof *split.root);
    split.number = gd__arena_take(&split.arena, vertices, sizeof *split.number);
    return split;
}

/* --- all components --------------------------------------------------------------------------- */

static enum gd_status split_all(struct split *split, struct gd_edited_parts *out)
{
    enum gd_status status = GD_OK;
    out->items = calloc(split->count, sizeof *out->items);
    if (!out->items) return GD_NO_MEMORY;
    for (; !status && out->count < split->count; out->count++) {
        struct part *part = &split->parts[out->count];
        part->item = &out->items[out->count];
        status = item_allocate(part->item, part->vertices, part->faces);
        part->item->largest_distance = split->edited->largest_distance;
        out->bytes += part->item->bytes;
    }
    return status ? status : fill_parts(split);
}

enum gd_status gd_edited_split(const struct gd_edited *edited, uint32_t most,
                               const struct gd_control *control, struct gd_edited_parts *out,
                               struct gd_detail *detail)
{
    struct split split = split_begin(edited, edited->polygons.position_count, control);
    struct gd_edited_parts parts = {0};
    enum gd_status status =
        split.arena.status ? split.arena.status : find_parts(&split, most, detail);
    if (!status) status = split_all(&split, &parts);
    gd__arena_free(&split.arena);
    if (status)
        gd_edited_parts_free(&parts);
    else
        *out = parts;
    return status;
}

void gd_edited_parts_free(struct gd_edited_parts *parts)
{
    if (!parts) return;
    for (uint32_t i = 0; i < parts->count; i++) gd_edited_free(&parts->items[i]);
    free(parts->items);
    *parts = (struct gd_edited_parts){0};
}

/* --- some components -------------------------------------------------------------------------- */

static enum gd_status keep_some(struct split *split, const struct gd_components_options *options,
                                struct gd_edited *out)
{
    uint32_t vertices = 0, faces = 0;
    for (uint32_t i = options->skip; i < split->count && i - options->skip < options->keep; i++) {
        split->parts[i].item = out;
        vertices += split->parts[i].vertices;
        faces += split->parts[i].faces;
    }
    enum gd_status status = item_allocate(out, vertices, faces);
    return status ? status : fill_parts(split);
}

enum gd_status gd_components(const struct gd_mesh *mesh,
                             const struct gd_components_options *options,
                             const struct gd_control *control, struct gd_edited *out,
                             struct gd_detail *detail)
{
    struct gd_edited whole = {0}, made = {0};
    if (!options->keep || options->skip >= mesh->summary.components)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "keep = %u and skip = %u leave none of %u components", options->keep,
                       options->skip, mesh->summary.components);
    enum gd_status status = gd_control_afford(control, gd_edit_cost(mesh->face_count));
    if (status) return status;
    struct split split = split_begin(&whole, mesh->vertex_count, control);
    status = split.arena.status;
    if (!status) status = gd__edited_allocate(&whole, mesh->vertex_count, mesh->face_count);
    if (!status) gd__edited_copy(&whole, mesh, split.number, &split.pace);
    if (!status) status = find_parts(&split, UINT32_MAX, detail);
    if (!status) status = keep_some(&split, options, &made);
    gd__arena_free(&split.arena);
    gd_edited_free(&whole);
    if (status)
        gd_edited_free(&made);
    else
        *out = made;
    return status;
}
