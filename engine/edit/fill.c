/* Fills the holes of a mesh by patches (hole.h). */
#include <stdlib.h>

#include "base/share.h"
#include "edit/crossings.h"
#include "edit/edited.h"
#include "edit/hole.h"
#include "gd/locate.h"
#include "mesh/topology.h"

struct filling {
    const struct gd_mesh *mesh;
    const struct gd_fill_options *options;
    /* progress: two parts for each loop (triangulation and refinement), and one for the result */
    struct gd__share share;
    struct gd_control part;
    struct gd__pace pace; /* pace of the current part */
    struct gd__hole *holes;
    uint32_t count;
};

/* Returns true if the loop is the border of a single face. A patch would be a duplicate of that
 * face. */
static bool is_lone_face(const struct gd_mesh *mesh, uint32_t loop)
{
    uint32_t side = mesh->boundary_side[loop];
    if (!gd__side_is_boundary(mesh, side)) side ^= 1;
    return mesh->boundary[loop].vertices == 3 &&
           mesh->side_face[side ^ 1] == mesh->side_face[gd__edit_side(mesh, side).next ^ 1];
}

/* Sums over the patches. `vertices` counts all vertices of the patches. `loops` counts only those
 * that are vertices of the mesh. */
struct patch_sizes {
    uint32_t vertices, loops, faces;
};

static struct patch_sizes sizes_of(const struct filling *filling)
{
    struct patch_sizes sizes = {0};
    for (uint32_t i = 0; i < filling->count; i++) {
        const struct gd__patch *patch = &filling->holes[i].patch;
        sizes.vertices += patch->position_count;
        sizes.loops += patch->loop_count;
        sizes.faces += patch->face_count;
    }
    return sizes;
}

static enum gd_status fill_one(struct filling *filling, uint32_t loop, struct gd_detail *detail)
{
    struct gd__hole *hole = &filling->holes[filling->count++];
    enum gd_status status = gd__hole_read(filling->mesh, loop, hole);
    if (!status) status = gd__hole_triangulate(hole, &filling->pace, detail);
    filling->share.done++;
    if (!status) status = gd__hole_finish(hole, &filling->part, detail);
    if (status == GD_NOT_TRIANGULABLE) gd__hole_free(&filling->holes[--filling->count]);
    return status;
}

/* Appends the patch to the triangles, whose arrays have room for it. */
static void patch_append(const struct gd__patch *patch, struct gd_polygons *triangles)
{
    memcpy(&triangles->positions[triangles->position_count], patch->positions,
           patch->position_count * sizeof *patch->positions);
    for (uint32_t i = 0; i < 3 * patch->face_count; i++)
        triangles->corners[3 * triangles->polygon_count + i] =
            patch->corners[i] + triangles->position_count;
    triangles->position_count += patch->position_count;
    triangles->polygon_count += patch->face_count;
}

/* Returns true if one of the triangles [first, end) crosses a triangle before them. */
static bool cross_earlier(const uint32_t *crossed, uint32_t first, uint32_t end)
{
    bool found = false;
    for (uint32_t i = first; i < end; i++) found |= crossed[i] < first;
    return found;
}

/* Removes the holes whose patches cross the patch of an earlier hole. These holes stay open. */
static void remove_crossing(struct filling *filling, const uint32_t *crossed,
                            struct gd_detail *refusal)
{
    uint32_t kept = 0, first = 0;
    for (uint32_t i = 0; i < filling->count; i++) {
        struct gd__hole hole = filling->holes[i];
        uint32_t end = first + hole.patch.face_count;
        if (cross_earlier(crossed, first, end)) {
            (void)gd__hole_refuse(&hole, refusal,
                                  "can't be filled: the triangles would cross another filled hole");
            gd__hole_free(&hole);
        } else {
            filling->holes[kept++] = hole;
        }
        first = end;
    }
    filling->count = kept;
}

/* Tests whether patches cross each other. */
static enum gd_status check_patches(struct filling *filling, struct gd_detail *refusal)
{
    struct patch_sizes all = sizes_of(filling);
    struct gd_polygons triangles = {.positions = malloc(all.vertices * sizeof *triangles.positions),
                                    .corners =
                                        malloc(3 * (size_t)all.faces * sizeof *triangles.corners)};
    uint32_t *crossed = malloc(all.faces * sizeof *crossed);
    enum gd_status status = GD_NO_MEMORY;
    if (triangles.positions && triangles.corners && crossed) {
        for (uint32_t i = 0; i < filling->count; i++)
            patch_append(&filling->holes[i].patch, &triangles);
        status = gd__find_crossings(&triangles, &filling->part, crossed);
        if (!status) remove_crossing(filling, crossed, refusal);
    }
    gd_polygons_free(&triangles);
    free(crossed);
    return status;
}

/* Fills all holes that the options select. Returns GD_NOT_TRIANGULABLE if no hole was filled and at
 * least one cannot be triangulated. */
static enum gd_status fill_all(struct filling *filling, struct gd_detail *detail)
{
    const struct gd_mesh *mesh = filling->mesh;
    enum gd_status status = GD_OK;
    struct gd_detail refusal = {.text = ""};
    filling->holes = calloc(mesh->summary.boundaries + 1, sizeof *filling->holes);
    if (!filling->holes) return GD_NO_MEMORY;
    for (uint32_t loop = 0; !status && loop < mesh->summary.boundaries; loop++) {
        filling->share.done = 2 * loop;
        if (mesh->boundary[loop].vertices > filling->options->max_edges || is_lone_face(mesh, loop))
            continue;
        status = fill_one(filling, loop, &refusal);
        if (status == GD_NOT_TRIANGULABLE) status = GD_OK;
    }
    if (!status && filling->count > 1) status = check_patches(filling, &refusal);
    if (status || filling->count || !refusal.text[0]) return status;
    if (detail) *detail = refusal;
    return GD_NOT_TRIANGULABLE;
}

/* --- the result ------------------------------------------------------------------------------- */

/* Writes the position of a new vertex, in the mesh's unit, and its origin. */
static enum gd_status put_new(const struct gd_mesh *mesh, const double in_box[3], uint32_t at,
                              struct gd_edited *out)
{
    double size = gd__edit_box_size(mesh);
    struct gd_vec3 low = mesh->summary.min;
    struct gd_vec3 p = {low.x + size * in_box[0], low.y + size * in_box[1],
                        low.z + size * in_box[2]};
    struct gd_point nearest;
    enum gd_status status = gd_locate_nearest(mesh, p, -1, &nearest, NULL);
    if (status) return status;
    memcpy(out->polygons.positions[at], &p, sizeof p);
    out->origins[at] = gd__origin_of(mesh, &nearest);
    return GD_OK;
}

/* The result while it is being written. */
struct writing {
    struct gd__pace *pace;
    uint32_t *number; /* for each internal vertex, its number in the result */
    uint32_t vertices, faces;
    struct gd_edited made;
};

static enum gd_status write_patch(struct writing *writing, const struct gd__hole *hole)
{
    const struct gd__patch *patch = &hole->patch;
    const uint32_t first = writing->vertices - patch->loop_count;
    uint32_t *corners = &writing->made.polygons.corners[3 * writing->faces];
    enum gd_status status = GD_OK;
    for (uint32_t i = patch->loop_count; !status && i < patch->position_count; i++) {
        status = put_new(hole->mesh, patch->positions[i], first + i, &writing->made);
        if (!status && !gd__pace(writing->pace, 40)) status = writing->pace->status;
    }
    for (uint32_t i = 0; i < 3 * patch->face_count; i++) {
        uint32_t corner = patch->corners[i];
        corners[i] =
            corner < patch->loop_count ? writing->number[hole->vertex[corner]] : first + corner;
    }
    writing->vertices = first + patch->position_count;
    writing->faces += patch->face_count;
    return status;
}

static enum gd_status write(struct filling *filling, struct gd_edited *out)
{
    const struct gd_mesh *mesh = filling->mesh;
    struct writing writing = {.pace = &filling->pace,
                              .number = malloc(mesh->vertex_count * sizeof *writing.number)};
    struct patch_sizes all = sizes_of(filling);
    enum gd_status status =
        writing.number
            ? gd__edited_allocate(&writing.made, mesh->vertex_count + all.vertices - all.loops,
                                  mesh->face_count + all.faces)
            : GD_NO_MEMORY;
    if (!status) {
        gd__edited_copy(&writing.made, mesh, writing.number, &filling->pace);
        writing.vertices = mesh->vertex_count;
        writing.faces = mesh->face_count;
        status = filling->pace.status;
    }
    for (uint32_t i = 0; !status && i < filling->count; i++)
        status = write_patch(&writing, &filling->holes[i]);
    free(writing.number);
    if (status)
        gd_edited_free(&writing.made);
    else
        *out = writing.made;
    return status;
}

enum gd_status gd_fill(const struct gd_mesh *mesh, const struct gd_fill_options *options,
                       const struct gd_control *control, struct gd_edited *out,
                       struct gd_detail *detail)
{
    struct filling filling = {
        .mesh = mesh,
        .options = options,
        .share = {.control = control, .total = 2 * mesh->summary.boundaries + 1}};
    const size_t largest = options->max_edges;
    if (options->max_edges < 3 || options->max_edges > GD_FILL_EDGES_MOST)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "max_edges = %u is not 3 to %d",
                       options->max_edges, GD_FILL_EDGES_MOST);
    enum gd_status status =
        gd_control_afford(control, gd_edit_cost(mesh->face_count) + 10 * largest * largest);
    filling.part = gd__share_control(&filling.share, 0);
    filling.pace.control = &filling.part;
    if (!status) status = fill_all(&filling, detail);
    filling.share.done = filling.share.total - 1;
    if (!status) status = write(&filling, out);
    for (uint32_t i = 0; i < filling.count; i++) gd__hole_free(&filling.holes[i]);
    free(filling.holes);
    return status;
}
