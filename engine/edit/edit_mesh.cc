#include "edit/edit_mesh.hpp"

#include <vector>

namespace gd_edit
{

typedef OpenMesh::HalfedgeHandle Half;
typedef OpenMesh::VertexHandle Vertex;
typedef OpenMesh::FaceHandle Face;

void copy_mesh(const struct gd_mesh *mesh, Watch &watch, EditMesh &out)
{
    const struct gd__edit_counts count = gd__edit_counts(mesh);
    out.reserve(count.vertices, count.edges, count.faces);
    grow_in_slices(watch, [&](size_t i) {
        out.resize(count.vertices * i / SLICES, count.edges * i / SLICES, count.faces * i / SLICES);
    });
    for (uint32_t v = 0; v < count.vertices; v++) {
        const struct gd_vec3 p = gd__edit_place(mesh, v);
        out.set_point(Vertex((int)v), OpenMesh::Vec3d(p.x, p.y, p.z));
        out.set_halfedge_handle(Vertex((int)v), Half((int)gd__edit_leaving(mesh, v)));
        watch.step();
    }
    for (uint32_t h = 0; h < 2 * count.edges; h++) {
        const struct gd__edit_side side = gd__edit_side(mesh, h);
        out.set_vertex_handle(Half((int)h), Vertex((int)side.destination));
        out.set_next_halfedge_handle(Half((int)h), Half((int)side.next));
        if (side.face != GD_NONE) out.set_face_handle(Half((int)h), Face((int)side.face));
        watch.step();
    }
    for (uint32_t f = 0; f < count.faces; f++) {
        out.set_halfedge_handle(Face((int)f), Half((int)gd__edit_first_side(mesh, f)));
        watch.step();
    }
}

/* Numbers the remaining vertices in the order of their indices. */
static std::vector<uint32_t> number_rest(const struct gd_mesh *mesh, const EditMesh &edited,
                                         Watch &watch, uint32_t *count)
{
    std::vector<uint32_t> number(edited.n_vertices(), GD_NONE);
    *count = 0;
    for (uint32_t i = 0; i < gd__edit_counts(mesh).indices; i++) {
        uint32_t v = gd__edit_vertex(mesh, i);
        if (v != GD_NONE && !edited.status(Vertex((int)v)).deleted()) number[v] = (*count)++;
        watch.step();
    }
    return number;
}

static void write_vertices(const struct gd_mesh *mesh, const std::vector<uint32_t> &number,
                           Watch &watch, struct gd_edited &out)
{
    for (uint32_t v = 0; v < number.size(); v++) {
        if (number[v] != GD_NONE) gd__edited_keep(&out, number[v], mesh, v);
        watch.step();
    }
}

static void write_faces(const struct gd_mesh *mesh, const EditMesh &edited,
                        const std::vector<uint32_t> &number, Watch &watch, uint32_t *corner)
{
    for (uint32_t i = 0; i < gd__edit_counts(mesh).face_indices; i++) {
        uint32_t f = gd__edit_face(mesh, i);
        watch.step();
        if (f == GD_NONE || edited.status(Face((int)f)).deleted()) continue;
        Half half = edited.halfedge_handle(Face((int)f));
        for (int k = 0; k < 3; k++, half = edited.next_halfedge_handle(half))
            *corner++ = number[(size_t)edited.from_vertex_handle(half).idx()];
    }
}

enum gd_status keep_rest(const struct gd_mesh *mesh, const EditMesh &edited, Watch &watch,
                         struct gd_edited *out)
{
    uint32_t vertices = 0, faces = 0;
    const std::vector<uint32_t> number = number_rest(mesh, edited, watch, &vertices);
    for (auto face : edited.all_faces()) faces += !edited.status(face).deleted();
    struct gd_edited made;
    const enum gd_status status = gd__edited_allocate(&made, vertices, faces);
    if (status) return status;
    try {
        write_vertices(mesh, number, watch, made);
        write_faces(mesh, edited, number, watch, made.polygons.corners);
    } catch (const Stopped &) {
        gd_edited_free(&made);
        throw;
    }
    *out = made;
    return GD_OK;
}

} // namespace gd_edit
