/* glTF scene: visits the nodes and computes the placement of each mesh. See gltf.h. */
#include "io/gltf.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEPTH 256 /* largest depth of nested nodes */

enum { IS_CHILD = 1, IS_VISITED = 2 };

/* A node on the path from the root to the current node, with its next child. */
struct step {
    uint32_t child, end; /* next child, and end of the list of children, as JSON values */
    struct gd__place place;
};

struct walk {
    const struct gd__gltf *gltf;
    gd__gltf_visit *visit;
    void *user;
    uint8_t *marks; /* one per node */
    struct step *steps;
    unsigned depth;
};

/* --- transforms ------------------------------------------------------------------------------- */

/* Converts a quaternion to a rotation. Normalises it first, because files store quaternions rounded
 * to floats: without this, the mesh would be scaled slightly. */
static enum gd_status rotate(const struct gd__gltf *gltf, uint32_t node, const double q[4],
                             struct gd__place *out)
{
    double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(norm > 0) || !isfinite(norm))
        return gd__gltf_fail(gltf, node, GD_SYNTAX,
                             "the node's rotation must be a quaternion of length 1");
    double s = 2 / norm, x = q[0], y = q[1], z = q[2], w = q[3];
    *out = (struct gd__place){{{1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)},
                               {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)},
                               {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)},
                               {0, 0, 0}}};
    return GD_OK;
}

static enum gd_status read_steps(const struct gd__gltf *gltf, uint32_t node, struct gd__place *out)
{
    double translation[3] = {0}, rotation[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1};
    enum gd_status status = gd__gltf_reals(gltf, node, "translation", 3, translation);
    if (status == GD_OK) status = gd__gltf_reals(gltf, node, "rotation", 4, rotation);
    if (status == GD_OK) status = gd__gltf_reals(gltf, node, "scale", 3, scale);
    if (status == GD_OK) status = rotate(gltf, node, rotation, out);
    if (status != GD_OK) return status;
    for (int column = 0; column < 3; column++)
        for (int axis = 0; axis < 3; axis++) out->columns[column][axis] *= scale[column];
    memcpy(out->columns[3], translation, sizeof translation);
    return GD_OK;
}

static enum gd_status read_place(const struct gd__gltf *gltf, uint32_t node, struct gd__place *out)
{
    if (gd__json_member(&gltf->json, node, "matrix") == GD__NO_VALUE)
        return read_steps(gltf, node, out);
    double numbers[16];
    enum gd_status status = gd__gltf_reals(gltf, node, "matrix", 16, numbers);
    if (status != GD_OK) return status;
    for (int column = 0; column < 4; column++)
        memcpy(out->columns[column], numbers + 4 * column, 3 * sizeof(double));
    return GD_OK;
}

/* --- traversal -------------------------------------------------------------------------------- */

static enum gd_status visit_mesh(struct walk *walk, uint32_t node, const struct gd__place *place)
{
    const struct gd__gltf *gltf = walk->gltf;
    uint32_t mesh;
    enum gd_status status = gd__gltf_reference(gltf, node, "mesh", &gltf->meshes, &mesh);
    if (status != GD_OK || mesh == GD__NO_VALUE) return status;
    bool is_skinned = gd__json_member(&gltf->json, node, "skin") != GD__NO_VALUE;
    return walk->visit(gltf, mesh, is_skinned ? &gd__unmoved : place, walk->user);
}

static enum gd_status mark_visited(struct walk *walk, uint32_t number)
{
    const struct gd__gltf *gltf = walk->gltf;
    if (walk->marks[number] & IS_VISITED)
        return gd__gltf_fail(gltf, gltf->nodes.values[number], GD_SYNTAX,
                             "node %u is in the scene twice, or below itself; use each node once",
                             number);
    if (walk->depth == DEPTH)
        return gd__gltf_fail(gltf, gltf->nodes.values[number], GD_UNSUPPORTED,
                             "nodes are nested more than %d deep", DEPTH);
    walk->marks[number] |= IS_VISITED;
    return GD_OK;
}

static enum gd_status enter(struct walk *walk, uint32_t number, const struct gd__place *outer)
{
    uint32_t node = walk->gltf->nodes.values[number];
    struct gd__place place;
    enum gd_status status = mark_visited(walk, number);
    if (status != GD_OK) return status;
    struct step *step = &walk->steps[walk->depth];
    status = read_place(walk->gltf, node, &place);
    if (status == GD_OK)
        status = gd__gltf_items(walk->gltf, node, "children", &step->child, &step->end);
    if (status != GD_OK) return status;
    step->place = gd__place_compose(outer, &place);
    walk->depth++;
    return visit_mesh(walk, node, &step->place);
}

static enum gd_status walk_tree(struct walk *walk, uint32_t root)
{
    enum gd_status status = enter(walk, root, &gd__unmoved);
    while (status == GD_OK && walk->depth > 0) {
        struct step *step = &walk->steps[walk->depth - 1];
        if (step->child >= step->end) {
            walk->depth--;
            continue;
        }
        uint32_t number, value = step->child;
        step->child = gd__json_next(&walk->gltf->json, value);
        status = gd__gltf_index(walk->gltf, value, &walk->gltf->nodes, &number);
        if (status == GD_OK) status = enter(walk, number, &step->place);
    }
    return status;
}

/* --- roots ------------------------------------------------------------------------------------ */

static enum gd_status mark_children(struct walk *walk)
{
    const struct gd__gltf *gltf = walk->gltf;
    enum gd_status status = GD_OK;
    for (uint32_t node = 0; node < gltf->nodes.count && status == GD_OK; node++) {
        uint32_t child, end, number;
        status = gd__gltf_items(gltf, gltf->nodes.values[node], "children", &child, &end);
        for (; child < end && status == GD_OK; child = gd__json_next(&gltf->json, child)) {
            status = gd__gltf_index(gltf, child, &gltf->nodes, &number);
            if (status == GD_OK) walk->marks[number] |= IS_CHILD;
        }
    }
    return status;
}

static enum gd_status walk_roots(struct walk *walk)
{
    enum gd_status status = mark_children(walk);
    for (uint32_t node = 0; node < walk->gltf->nodes.count && status == GD_OK; node++) {
        if (!(walk->marks[node] & IS_CHILD)) status = walk_tree(walk, node);
    }
    return status;
}

static enum gd_status walk_scene(struct walk *walk, uint32_t scene)
{
    const struct gd__gltf *gltf = walk->gltf;
    uint32_t node, end, number;
    enum gd_status status = gd__gltf_items(gltf, scene, "nodes", &node, &end);
    for (; node < end && status == GD_OK; node = gd__json_next(&gltf->json, node)) {
        status = gd__gltf_index(gltf, node, &gltf->nodes, &number);
        if (status == GD_OK) status = walk_tree(walk, number);
    }
    return status;
}

static enum gd_status walk_meshes(struct walk *walk)
{
    enum gd_status status = GD_OK;
    for (uint32_t mesh = 0; mesh < walk->gltf->meshes.count && status == GD_OK; mesh++)
        status = walk->visit(walk->gltf, walk->gltf->meshes.values[mesh], &gd__unmoved, walk->user);
    return status;
}

static enum gd_status walk_all(struct walk *walk)
{
    const struct gd__gltf *gltf = walk->gltf;
    uint32_t scene;
    enum gd_status status = gd__gltf_reference(gltf, 0, "scene", &gltf->scenes, &scene);
    if (status != GD_OK) return status;
    if (gltf->nodes.count == 0) return walk_meshes(walk);
    if (scene == GD__NO_VALUE && gltf->scenes.count > 0) scene = gltf->scenes.values[0];
    return scene == GD__NO_VALUE ? walk_roots(walk) : walk_scene(walk, scene);
}

enum gd_status gd__gltf_walk(const struct gd__gltf *gltf, gd__gltf_visit *visit, void *user)
{
    struct walk walk = {.gltf = gltf,
                        .visit = visit,
                        .user = user,
                        .marks = calloc(gltf->nodes.count + (size_t)1, sizeof *walk.marks),
                        .steps = malloc(DEPTH * sizeof *walk.steps)};
    enum gd_status status = walk.marks && walk.steps
                                ? walk_all(&walk)
                                : gd_fail_status(gltf->scan.detail, GD_NO_MEMORY);
    free(walk.marks);
    free(walk.steps);
    return status;
}
