/* glTF scene: visits the nodes and computes the placement of each mesh. See gltf.h. */
#include "io/gltf.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEPTH 256 /* largest depth of nested nodes */

enum { IS_CHILD = 1, IS_VISITED = 2 };

/* A node on the path from the root to the current node. */
struct step {
    struct gd__gltf_items children; /* the children that are not visited yet */
    struct gd__place place;
};

struct walk {
    struct gd__gltf *gltf;
    gd__gltf_visit *visit;
    void *user;
    uint8_t *marks; /* one per node */
    struct step *steps;
    unsigned depth;
};

/* --- transforms ------------------------------------------------------------------------------- */

/* Converts a quaternion to a rotation. Normalises it first, because files store quaternions rounded
 * to floats: without this, the mesh would be scaled slightly. */
static void rotate(struct gd__gltf *gltf, uint32_t node, const double q[4], struct gd__place *out)
{
    double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(norm > 0) || !isfinite(norm))
        gd__gltf_fail(gltf, node, GD_SYNTAX,
                      "the node's rotation must be a quaternion of length 1");
    double s = 2 / norm, x = q[0], y = q[1], z = q[2], w = q[3];
    *out = (struct gd__place){{{1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)},
                               {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)},
                               {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)},
                               {0, 0, 0}}};
}

static void read_place(struct gd__gltf *gltf, uint32_t node, struct gd__place *out)
{
    if (gd__json_member(&gltf->json, node, "matrix") != GD__NO_VALUE) {
        double numbers[16] = {0};
        gd__gltf_reals(gltf, node, "matrix", 16, numbers);
        for (int column = 0; column < 4; column++)
            memcpy(out->columns[column], numbers + 4 * column, 3 * sizeof(double));
        return;
    }
    double translation[3] = {0}, rotation[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1};
    gd__gltf_reals(gltf, node, "translation", 3, translation);
    gd__gltf_reals(gltf, node, "rotation", 4, rotation);
    gd__gltf_reals(gltf, node, "scale", 3, scale);
    rotate(gltf, node, rotation, out);
    for (int column = 0; column < 3; column++)
        for (int axis = 0; axis < 3; axis++) out->columns[column][axis] *= scale[column];
    memcpy(out->columns[3], translation, sizeof translation);
}

/* --- traversal -------------------------------------------------------------------------------- */

static void visit_mesh(struct walk *walk, uint32_t node, const struct gd__place *place)
{
    struct gd__gltf *gltf = walk->gltf;
    uint32_t mesh = gd__gltf_reference(gltf, node, "mesh", &gltf->meshes);
    bool is_skinned = gd__json_member(&gltf->json, node, "skin") != GD__NO_VALUE;
    if (!gltf->status && mesh != GD__NO_VALUE)
        walk->visit(gltf, mesh, is_skinned ? &gd__unmoved : place, walk->user);
}

static void mark_visited(struct walk *walk, uint32_t number)
{
    struct gd__gltf *gltf = walk->gltf;
    if (walk->marks[number] & IS_VISITED)
        gd__gltf_fail(gltf, gltf->nodes.values[number], GD_SYNTAX,
                      "node %u is in the scene twice, or below itself; use each node once", number);
    if (walk->depth == DEPTH)
        gd__gltf_fail(gltf, gltf->nodes.values[number], GD_UNSUPPORTED,
                      "nodes are nested more than %d deep", DEPTH);
    walk->marks[number] |= IS_VISITED;
}

static void enter(struct walk *walk, uint32_t number, const struct gd__place *outer)
{
    struct gd__gltf *gltf = walk->gltf;
    mark_visited(walk, number);
    if (gltf->status) return;
    uint32_t node = gltf->nodes.values[number];
    struct gd__place place;
    struct step *step = &walk->steps[walk->depth++];
    read_place(gltf, node, &place);
    step->children = gd__gltf_items(gltf, node, "children");
    step->place = gd__place_compose(outer, &place);
    visit_mesh(walk, node, &step->place);
}

static void walk_tree(struct walk *walk, uint32_t root)
{
    struct gd__gltf *gltf = walk->gltf;
    enter(walk, root, &gd__unmoved);
    while (!gltf->status && walk->depth > 0) {
        struct step *step = &walk->steps[walk->depth - 1];
        uint32_t value = step->children.begin;
        if (value >= step->children.end) {
            walk->depth--;
            continue;
        }
        step->children.begin = gd__json_next(&gltf->json, value);
        uint32_t number = gd__gltf_index(gltf, value, &gltf->nodes);
        if (!gltf->status) enter(walk, number, &step->place);
    }
}

/* --- roots ------------------------------------------------------------------------------------ */

static void mark_children(struct walk *walk)
{
    struct gd__gltf *gltf = walk->gltf;
    for (uint32_t node = 0; node < gltf->nodes.count && !gltf->status; node++) {
        struct gd__gltf_items items = gd__gltf_items(gltf, gltf->nodes.values[node], "children");
        for (uint32_t child = items.begin; child < items.end && !gltf->status;
             child = gd__json_next(&gltf->json, child)) {
            uint32_t number = gd__gltf_index(gltf, child, &gltf->nodes);
            if (!gltf->status) walk->marks[number] |= IS_CHILD;
        }
    }
}

static void walk_roots(struct walk *walk)
{
    mark_children(walk);
    for (uint32_t node = 0; node < walk->gltf->nodes.count && !walk->gltf->status; node++)
        if (!(walk->marks[node] & IS_CHILD)) walk_tree(walk, node);
}

static void walk_scene(struct walk *walk, uint32_t scene)
{
    struct gd__gltf *gltf = walk->gltf;
    struct gd__gltf_items items = gd__gltf_items(gltf, scene, "nodes");
    for (uint32_t node = items.begin; node < items.end && !gltf->status;
         node = gd__json_next(&gltf->json, node)) {
        uint32_t number = gd__gltf_index(gltf, node, &gltf->nodes);
        if (!gltf->status) walk_tree(walk, number);
    }
}

static void walk_meshes(struct walk *walk)
{
    struct gd__gltf *gltf = walk->gltf;
    for (uint32_t mesh = 0; mesh < gltf->meshes.count && !gltf->status; mesh++)
        walk->visit(gltf, gltf->meshes.values[mesh], &gd__unmoved, walk->user);
}

static void walk_all(struct walk *walk)
{
    struct gd__gltf *gltf = walk->gltf;
    uint32_t scene = gd__gltf_reference(gltf, 0, "scene", &gltf->scenes);
    if (scene == GD__NO_VALUE && gltf->scenes.count > 0) scene = gltf->scenes.values[0];
    if (gltf->nodes.count == 0)
        walk_meshes(walk);
    else if (scene == GD__NO_VALUE)
        walk_roots(walk);
    else
        walk_scene(walk, scene);
}

void gd__gltf_walk(struct gd__gltf *gltf, gd__gltf_visit *visit, void *user)
{
    if (gltf->status) return;
    struct walk walk = {.gltf = gltf,
                        .visit = visit,
                        .user = user,
                        .marks = calloc(gltf->nodes.count + (size_t)1, sizeof *walk.marks),
                        .steps = malloc(DEPTH * sizeof *walk.steps)};
    if (walk.marks && walk.steps)
        walk_all(&walk);
    else
        gltf->status = gd_fail_status(gltf->scan.detail, GD_NO_MEMORY);
    free(walk.marks);
    free(walk.steps);
}
