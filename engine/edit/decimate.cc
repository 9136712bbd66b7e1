/* OpenMesh's decimater with a module of our own. The module uses the quadrics of Garland and
 * Heckbert (1997) and rejects collapses that would spoil a face. */
#include "edit/edit_mesh.hpp"

#include <cmath>
#include <vector>

#include <OpenMesh/Core/Geometry/QuadricT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModBaseT.hh>

#include "base/tolerance.h"
#include "edit/decimate.h"

namespace gd_edit
{

typedef OpenMesh::Vec3d Vec3;
typedef OpenMesh::FaceHandle Face;
typedef OpenMesh::VertexHandle Vertex;
typedef OpenMesh::Geometry::Quadricd Quadric;

/* A mesh that counts the collapses that the decimater considers. It counts them in is_collapse_ok,
 * because the decimater calls this function for each collapse, but calls the module only for
 * collapses that is_collapse_ok allows. */
struct WatchedMesh : EditMesh {
    Watch *watch = nullptr;

    bool is_collapse_ok(OpenMesh::HalfedgeHandle half)
    {
        watch->step();
        return EditMesh::is_collapse_ok(half);
    }
};

/* --- quadrics --------------------------------------------------------------------------------- */

/* Returns the quadric of a plane: the squared distance from the plane, times a weight. */
static Quadric plane_quadric(const Vec3 &unit_normal, const Vec3 &p, double weight)
{
    Quadric plane(unit_normal[0], unit_normal[1], unit_normal[2], -(p | unit_normal));
    plane *= weight;
    return plane;
}

/* Returns the quadric of a face's plane, weighted by the face's area; zero for a face without
 * area. */
static Quadric face_quadric(const EditMesh &mesh, Face face)
{
    Vec3 p[3];
    int k = 0;
    for (auto vertex : mesh.fv_range(face)) p[k++] = mesh.point(vertex);
    const Vec3 normal = (p[1] - p[0]) % (p[2] - p[0]);
    const double length = normal.norm();
    return length > 0 ? plane_quadric(normal / length, p[0], 0.5 * length) : Quadric(0.0);
}

/* Returns the quadric of the plane that contains a boundary edge and is perpendicular to the face
 * of this edge. This quadric keeps the boundary in place. */
static Quadric wall_quadric(const EditMesh &mesh, OpenMesh::HalfedgeHandle boundary)
{
    const auto inside = mesh.opposite_halfedge_handle(boundary);
    const auto apex = mesh.to_vertex_handle(mesh.next_halfedge_handle(inside));
    const Vec3 p = mesh.point(mesh.from_vertex_handle(inside));
    const Vec3 along = mesh.point(mesh.to_vertex_handle(inside)) - p;
    const Vec3 normal = along % ((mesh.point(apex) - p) % along);
    const double length = normal.norm();
    return length > 0 ? plane_quadric(normal / length, p, along.sqrnorm()) : Quadric(0.0);
}

/* --- faces that a collapse changes ------------------------------------------------------------ */

/* Returns the height over the longest edge, relative to that edge. */
static double flatness_of(const Vec3 &normal, const Vec3 &p, const Vec3 &a, const Vec3 &b)
{
    return normal.norm() / std::max({(a - p).sqrnorm(), (b - p).sqrnorm(), (b - a).sqrnorm()});
}

/* Returns true if the collapse would turn a remaining face around v0 by 90 degrees or more, or make
 * it too flat. */
static bool spoils_a_face(const OpenMesh::Decimater::CollapseInfoT<WatchedMesh> &collapse)
{
    const EditMesh &mesh = collapse.mesh;
    for (auto half : mesh.voh_range(collapse.v0)) {
        const auto face = mesh.face_handle(half);
        if (!face.is_valid() || face == collapse.fl || face == collapse.fr) continue;
        const auto across = mesh.next_halfedge_handle(half);
        const Vec3 a = mesh.point(mesh.to_vertex_handle(half));
        const Vec3 b = mesh.point(mesh.to_vertex_handle(across));
        const Vec3 before = (a - collapse.p0) % (b - collapse.p0);
        const Vec3 after = (a - collapse.p1) % (b - collapse.p1);
        if (!((before | after) > 0)) return true;
        const double flatness = flatness_of(after, collapse.p1, a, b);
        if (flatness < GD_TOL_EDIT_FLAT && flatness < flatness_of(before, collapse.p0, a, b))
            return true;
    }
    return false;
}

/* --- vertices --------------------------------------------------------------------------------- */

struct VertexTable {
    std::vector<Quadric> quadrics;
    std::vector<uint32_t> valences;

    Quadric &quadric(Vertex vertex)
    {
        return quadrics[(size_t)vertex.idx()];
    }

    uint32_t &valence(Vertex vertex)
    {
        return valences[(size_t)vertex.idx()];
    }
};

static void add_faces(const EditMesh &mesh, Watch &watch, VertexTable &table)
{
    for (auto face : mesh.faces()) {
        const Quadric plane = face_quadric(mesh, face);
        for (auto vertex : mesh.fv_range(face)) table.quadric(vertex) += plane;
        watch.step();
    }
}

static void add_walls(const EditMesh &mesh, Watch &watch, VertexTable &table)
{
    for (auto half : mesh.halfedges()) {
        watch.step();
        if (!mesh.is_boundary(half)) continue;
        const Quadric wall = wall_quadric(mesh, half);
        table.quadric(mesh.from_vertex_handle(half)) += wall;
        table.quadric(mesh.to_vertex_handle(half)) += wall;
    }
}

/* Locks vertices of high valence and their neighbours. Each collapse next to such a vertex would
 * visit all its neighbours, and the total time would be quadratic. */
static void lock_hubs(EditMesh &mesh, Watch &watch, VertexTable &table)
{
    for (auto vertex : mesh.vertices()) {
        table.valence(vertex) = (uint32_t)mesh.valence(vertex);
        watch.step();
        if (table.valence(vertex) <= GD_EDIT_VALENCE_MOST) continue;
        mesh.status(vertex).set_locked(true);
        for (auto neighbour : mesh.vv_range(vertex)) mesh.status(neighbour).set_locked(true);
    }
}

static void measure_vertices(EditMesh &mesh, Watch &watch, VertexTable &table)
{
    const size_t count = mesh.n_vertices();
    table.quadrics.reserve(count);
    grow_in_slices(watch,
                   [&](size_t i) { table.quadrics.resize(count * i / SLICES, Quadric(0.0)); });
    table.valences.resize(count);
    add_faces(mesh, watch, table);
    add_walls(mesh, watch, table);
    lock_hubs(mesh, watch, table);
}

/* --- the module ------------------------------------------------------------------------------- */

template <class MeshT> class QuadricsT : public OpenMesh::Decimater::ModBaseT<MeshT>
{
  public:
    DECIMATING_MODULE(QuadricsT, MeshT, Quadrics);

    explicit QuadricsT(MeshT &mesh) : Base(mesh, false)
    {
    }

    /* largest mean squared distance from the planes, in the unit box */
    double most_error = INFINITY;

    void initialize() override
    {
        measure_vertices(Base::mesh(), *Base::mesh().watch, table_);
    }

    float collapse_priority(const CollapseInfo &collapse) override
    {
        Quadric sum = table_.quadric(collapse.v0);
        sum += table_.quadric(collapse.v1);
        const double error = std::max(sum(collapse.p1), 0.0);
        /* the sum of the weights of the quadric's planes is the trace of its 3x3 part, because each
         * plane's normal has length 1 */
        const double weight = sum.a() + sum.e() + sum.h();
        if (error > most_error * weight ||
            table_.valence(collapse.v0) + table_.valence(collapse.v1) > GD_EDIT_VALENCE_MOST + 4 ||
            spoils_a_face(collapse))
            return Base::ILLEGAL_COLLAPSE;
        return (float)error;
    }

    void postprocess_collapse(const CollapseInfo &collapse) override
    {
        table_.quadric(collapse.v1) += table_.quadric(collapse.v0);
        for (auto vertex : {collapse.v1, collapse.vl, collapse.vr}) {
            if (vertex.is_valid()) table_.valence(vertex) = (uint32_t)Base::mesh().valence(vertex);
        }
    }

  private:
    VertexTable table_;
};

typedef QuadricsT<WatchedMesh> Quadrics;
typedef OpenMesh::Decimater::DecimaterT<WatchedMesh> Decimater;

/* Adds the module. The decimater owns it, unless adding it to the decimater's list fails. */
static Quadrics &add_module(Decimater &decimater)
{
    Quadrics::Handle handle;
    try {
        decimater.add(handle);
    } catch (...) {
        if (handle.is_valid()) delete &decimater.module(handle);
        throw;
    }
    return decimater.module(handle);
}

static void lock_boundary(EditMesh &edited, Watch &watch)
{
    for (auto vertex : edited.vertices()) {
        if (edited.is_boundary(vertex)) edited.status(vertex).set_locked(true);
        watch.step();
    }
}

/* Expected number of calls of watch.step for each collapse. A collapse evaluates about 6 neighbours
 * of the vertex again, and each of them has about 6 neighbours. */
static const double STEPS_A_COLLAPSE = 40;

static enum gd_status decimate(const struct gd_mesh *mesh,
                               const struct gd_simplify_options &options, double most_distance,
                               const struct gd_control *control, struct gd_edited *out)
{
    WatchedMesh edited;
    const double faces = gd__edit_counts(mesh).faces;
    const double collapses = std::max(0.0, (faces - options.faces) / 2);
    Watch watch(control, 9 * faces + STEPS_A_COLLAPSE * collapses);
    edited.watch = &watch;
    copy_mesh(mesh, watch, edited);
    if (options.keep_boundary) lock_boundary(edited, watch);
    Decimater decimater(edited);
    add_module(decimater).most_error = most_distance * most_distance;
    if (!decimater.initialize()) return GD_INTERNAL;
    decimater.decimate_to_faces(0, options.faces);
    return keep_rest(mesh, edited, watch, out);
}

} // namespace gd_edit

enum gd_status gd__decimate(const struct gd_mesh *mesh, const struct gd_simplify_options *options,
                            double most_distance, const struct gd_control *control,
                            struct gd_edited *out)
{
    return gd_edit::guarded(
        [&] { return gd_edit::decimate(mesh, *options, most_distance, control, out); });
}
