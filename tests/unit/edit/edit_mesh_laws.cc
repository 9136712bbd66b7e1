#include "edit/edit_mesh.hpp"

#include "tests/unit/edit/edit_mesh_laws.h"

using gd_edit::EditMesh;
using gd_edit::Stopped;
using gd_edit::Watch;

typedef OpenMesh::VertexHandle Vertex;
typedef OpenMesh::FaceHandle Face;

#define LAW(condition)                                                                             \
    if (!(condition)) return #condition

/* Builds a mesh as programs that use OpenMesh do. Returns false if it rejects a face. */
static bool build(const struct gd_polygons &polygons, EditMesh &out)
{
    bool is_good = true;
    for (uint32_t i = 0; i < polygons.position_count; i++) {
        const double *p = polygons.positions[i];
        out.add_vertex(OpenMesh::Vec3d(p[0], p[1], p[2]));
    }
    for (uint32_t i = 0; i < polygons.polygon_count; i++) {
        const uint32_t *c = &polygons.corners[3 * i];
        is_good &= out.add_face(Vertex((int)c[0]), Vertex((int)c[1]), Vertex((int)c[2])).is_valid();
    }
    return is_good;
}

/* Returns the vertex of the copy with that index of the input. */
static Vertex copied(const struct gd_mesh *mesh, uint32_t index)
{
    return Vertex((int)gd__edit_vertex(mesh, index));
}

static const char *check_halfedges(const EditMesh &copy)
{
    for (auto half : copy.halfedges()) {
        const auto next = copy.next_halfedge_handle(half);
        LAW(copy.prev_halfedge_handle(next) == half);
        LAW(copy.from_vertex_handle(next) == copy.to_vertex_handle(half));
        LAW(copy.face_handle(next) == copy.face_handle(half));
        LAW(copy.is_boundary(half) ||
            copy.next_halfedge_handle(copy.next_halfedge_handle(next)) == half);
    }
    for (auto vertex : copy.vertices()) {
        const auto leaving = copy.halfedge_handle(vertex);
        LAW(copy.from_vertex_handle(leaving) == vertex);
        LAW(copy.is_boundary(leaving) == copy.is_boundary(vertex));
        for (int k = 0; k < 3; k++) LAW(copy.point(vertex)[k] >= 0 && copy.point(vertex)[k] <= 1);
    }
    return nullptr;
}

const char *edit_mesh_check_copy(const struct gd_mesh *mesh, const struct gd_polygons *polygons)
{
    EditMesh copy, built;
    Watch watch(nullptr, 1);
    gd_edit::copy_mesh(mesh, watch, copy);
    LAW(build(*polygons, built));
    LAW(copy.n_vertices() == built.n_vertices());
    LAW(copy.n_edges() == built.n_edges());
    LAW(copy.n_faces() == built.n_faces());
    for (uint32_t i = 0; i < polygons->position_count; i++) {
        const Vertex own = copied(mesh, i), theirs((int)i);
        LAW(copy.valence(own) == built.valence(theirs));
        LAW(copy.is_boundary(own) == built.is_boundary(theirs));
        for (auto neighbour : built.vv_range(theirs))
            LAW(copy.find_halfedge(own, copied(mesh, (uint32_t)neighbour.idx())).is_valid());
    }
    return check_halfedges(copy);
}

static bool is_kept(uint32_t polygon)
{
    return polygon % 3 == 0;
}

static const char *check_kept(const struct gd_mesh *mesh, const struct gd_edited &rest,
                              const struct gd_polygons &polygons)
{
    const uint32_t *corner = rest.polygons.corners;
    LAW(rest.polygons.polygon_count == (polygons.polygon_count + 2) / 3);
    for (uint32_t i = 0; i < polygons.polygon_count; i++) {
        for (int k = 0; k < 3 && is_kept(i); k++) {
            const double *q = rest.polygons.positions[*corner++];
            const double *p = polygons.positions[polygons.corners[3 * i + (uint32_t)k]];
            LAW(p[0] == q[0] && p[1] == q[1] && p[2] == q[2]);
        }
    }
    for (uint32_t i = 0; i < rest.polygons.position_count; i++)
        LAW(rest.origins[i].face < gd_mesh_summary(mesh)->face_index_count);
    return nullptr;
}

const char *edit_mesh_check_rest(const struct gd_mesh *mesh, const struct gd_polygons *polygons)
{
    EditMesh edited;
    Watch watch(nullptr, 1);
    struct gd_edited rest;
    gd_edit::copy_mesh(mesh, watch, edited);
    for (uint32_t i = 0; i < polygons->polygon_count; i++)
        if (!is_kept(i)) edited.delete_face(Face((int)gd__edit_face(mesh, i)), true);
    LAW(gd_edit::keep_rest(mesh, edited, watch, &rest) == GD_OK);
    const char *broken = check_kept(mesh, rest, *polygons);
    gd_edited_free(&rest);
    return broken;
}

struct Stop {
    int left; /* number of checks until the call is stopped */
};

static bool count_down(void *user, double)
{
    return static_cast<Stop *>(user)->left-- > 0;
}

const char *edit_mesh_check_stop(const struct gd_mesh *mesh)
{
    enum gd_status status = GD_CANCELLED;
    int most = 0;
    for (; status == GD_CANCELLED && most < 1000000; most++) {
        Stop stop = {most};
        struct gd_control control = {};
        control.progress = count_down;
        control.user = &stop;
        struct gd_edited rest = {};
        status = gd_edit::guarded([&] {
            EditMesh edited;
            Watch watch(&control, 1);
            gd_edit::copy_mesh(mesh, watch, edited);
            return gd_edit::keep_rest(mesh, edited, watch, &rest);
        });
        LAW((status == GD_OK) == (rest.origins != nullptr));
        gd_edited_free(&rest);
    }
    LAW(status == GD_OK);
    LAW(most > 2 * (int)gd_edit::SLICES);
    return nullptr;
}

const char *edit_mesh_check_guard(void)
{
    LAW(gd_edit::guarded([] { return GD_OK; }) == GD_OK);
    LAW(gd_edit::guarded([]() -> gd_status { throw Stopped{GD_DEADLINE}; }) == GD_DEADLINE);
    LAW(gd_edit::guarded([]() -> gd_status { throw std::bad_alloc(); }) == GD_NO_MEMORY);
    LAW(gd_edit::guarded([]() -> gd_status { throw std::length_error(""); }) == GD_NO_MEMORY);
    LAW(gd_edit::guarded([]() -> gd_status { throw 1; }) == GD_INTERNAL);
    return nullptr;
}
