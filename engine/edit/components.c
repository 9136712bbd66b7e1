#include <stdlib.h>

#include "base/pace.h"
#include "edit/edited.h"
#include "mesh/topology.h"

struct ranked {
    double area;
    uint32_t component, first_face; /* `first_face` is the lowest index of the component's faces */
};

static int by_area(const void *a, const void *b)
{
    const struct ranked *x = a, *y = b;
    if (x->area != y->area) return x->area < y->area ? 1 : -1;
    return x->first_face < y->first_face ? -1 : 1;
}

static uint32_t component_of_face(const struct gd_mesh *mesh, uint32_t face)
{
    return mesh->vertex_component[mesh->origin[mesh->face_side[face][0]]];
}

static double area_of_face(const struct gd_mesh *mesh, uint32_t face)
{
    struct gd_vec3 p[3];
    for (int k = 0; k < 3; k++) p[k] = mesh->position[mesh->origin[mesh->face_side[face][k]]];
    return gd_vec3_length(gd_vec3_cross(gd_vec3_sub(p[1], p[0]), gd_vec3_sub(p[2], p[0]))) / 2;
}

/* Returns an array with true for each component that is kept. */
static bool *choose(const struct gd_mesh *mesh, const struct gd_components_options *options,
                    struct gd__pace *pace)
{
    uint32_t count = mesh->summary.components;
    struct ranked *ranked = malloc(count * sizeof *ranked);
    bool *is_kept = calloc(count, sizeof *is_kept);
    if (ranked && is_kept) {
        for (uint32_t i = 0; i < count; i++) ranked[i] = (struct ranked){0, i, GD_NONE};
        for (uint32_t f = 0; f < mesh->face_count && gd__pace(pace, 1); f++) {
            struct ranked *own = &ranked[component_of_face(mesh, f)];
            own->area += area_of_face(mesh, f);
            if (mesh->index_of_face[f] < own->first_face) own->first_face = mesh->index_of_face[f];
        }
        qsort(ranked, count, sizeof *ranked, by_area);
        for (uint32_t i = options->skip; i < count && i - options->skip < options->keep; i++)
            is_kept[ranked[i].component] = true;
    } else {
        free(is_kept);
        is_kept = NULL;
    }
    free(ranked);
    return is_kept;
}

/* Numbers the kept vertices in the order of their indices. Returns their number. */
static uint32_t number_vertices(const struct gd_mesh *mesh, const bool *is_kept, uint32_t *number)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < mesh->summary.index_count; i++) {
        uint32_t v = gd__edit_vertex(mesh, i);
        if (v != GD_NONE) number[v] = is_kept[mesh->vertex_component[v]] ? count++ : GD_NONE;
    }
    return count;
}

static enum gd_status copy_kept(const struct gd_mesh *mesh, const bool *is_kept, uint32_t *number,
                                struct gd__pace *pace, struct gd_edited *out)
{
    uint32_t vertices = number_vertices(mesh, is_kept, number), faces = 0;
    for (uint32_t f = 0; f < mesh->face_count; f++) faces += is_kept[component_of_face(mesh, f)];
    enum gd_status status = gd__edited_allocate(out, vertices, faces);
    if (status) return status;
    for (uint32_t v = 0; v < mesh->vertex_count && gd__pace(pace, 4); v++) {
        if (number[v] != GD_NONE) gd__edited_keep(out, number[v], mesh, v);
    }
    uint32_t *corner = out->polygons.corners;
    for (uint32_t i = 0; i < mesh->summary.face_index_count && gd__pace(pace, 1); i++) {
        uint32_t f = gd__edit_face(mesh, i);
        if (f == GD_NONE || !is_kept[component_of_face(mesh, f)]) continue;
        for (int k = 0; k < 3; k++) *corner++ = number[mesh->origin[mesh->face_side[f][k]]];
    }
    if (pace->status) gd_edited_free(out);
    return pace->status;
}

enum gd_status gd_components(const struct gd_mesh *mesh,
                             const struct gd_components_options *options,
                             const struct gd_control *control, struct gd_edited *out,
                             struct gd_detail *detail)
{
    struct gd__pace pace = {.control = control, .fraction = 0.5};
    struct gd_edited made;
    if (!options->keep || options->skip >= mesh->summary.components)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "keep = %u and skip = %u leave none of %u components", options->keep,
                       options->skip, mesh->summary.components);
    enum gd_status status = gd_control_afford(control, gd_edit_cost(mesh->face_count));
    if (status) return status;
    uint32_t *number = malloc(mesh->vertex_count * sizeof *number);
    bool *is_kept = choose(mesh, options, &pace);
    status = number && is_kept ? copy_kept(mesh, is_kept, number, &pace, &made) : GD_NO_MEMORY;
    free(is_kept);
    free(number);
    if (!status) *out = made;
    return status;
}
