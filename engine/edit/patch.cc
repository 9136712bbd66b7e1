/* Refinement after Liepa (2003). A triangle is divided at its middle if the middle is farther from
 * each corner than the mean length of the edges at this corner. Edges are flipped as long as that
 * makes them locally Delaunay. Then each new vertex moves repeatedly to the mean of its
 * neighbours. */
#include "edit/edit_mesh.hpp"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "base/tolerance.h"
#include "edit/patch.h"

namespace gd_edit
{

typedef OpenMesh::Vec3d Vec3;
typedef OpenMesh::VertexHandle Vertex;

/* largest number of rounds of dividing and flipping */
static const int ROUNDS = 20;
static const int STEPS = 100; /* number of smoothing steps */
/* largest number of new vertices for each vertex of the loop */
static const uint32_t GROWTH = 40;
static const double DENSITY = 1.4142135623730951; /* Liepa's alpha: the square root of 2 */

struct Refinement {
    EditMesh mesh;
    std::vector<double> scale; /* for each vertex, mean length of the edges around it */
    uint32_t loop_count;
    const struct gd__patch_options &options;
    Watch watch;
};

/* Reads a patch. Returns false if OpenMesh rejects triangles. */
static bool read(const struct gd__patch &patch, EditMesh &mesh)
{
    uint32_t refused = 0;
    for (uint32_t i = 0; i < patch.position_count; i++) {
        const double *p = patch.positions[i];
        mesh.add_vertex(Vec3(p[0], p[1], p[2]));
    }
    for (uint32_t i = 0; i < patch.face_count; i++) {
        const uint32_t *c = &patch.corners[3 * i];
        const auto face = mesh.add_face(Vertex((int)c[0]), Vertex((int)c[1]), Vertex((int)c[2]));
        refused += !face.is_valid();
    }
    return refused == 0;
}

static void measure_loop(Refinement &work)
{
    const EditMesh &mesh = work.mesh;
    work.scale.assign(mesh.n_vertices(), 0);
    for (auto half : mesh.halfedges()) {
        if (!mesh.is_boundary(half)) continue;
        const double length = mesh.calc_edge_length(half);
        work.scale[(size_t)mesh.to_vertex_handle(half).idx()] += length / 2;
        work.scale[(size_t)mesh.from_vertex_handle(half).idx()] += length / 2;
    }
}

static bool is_large(const Refinement &work, OpenMesh::FaceHandle face, Vec3 &middle, double &scale)
{
    const EditMesh &mesh = work.mesh;
    middle = Vec3(0, 0, 0);
    scale = 0;
    for (auto vertex : mesh.fv_range(face)) {
        middle += mesh.point(vertex) / 3;
        scale += work.scale[(size_t)vertex.idx()] / 3;
    }
    for (auto vertex : mesh.fv_range(face)) {
        const double distance = DENSITY * (middle - mesh.point(vertex)).norm();
        if (distance <= scale || distance <= work.scale[(size_t)vertex.idx()]) return false;
    }
    return true;
}

/* Divides large triangles. Returns true if it divided any. */
static bool divide(Refinement &work)
{
    const size_t before = work.mesh.n_faces();
    bool is_divided = false;
    for (size_t f = 0; f < before; f++) {
        const OpenMesh::FaceHandle face((int)f);
        Vec3 middle;
        double scale;
        work.watch.step();
        if (work.mesh.n_vertices() >= (GROWTH + 1) * (size_t)work.loop_count ||
            !is_large(work, face, middle, scale))
            continue;
        work.mesh.split(face, work.mesh.add_vertex(middle));
        work.scale.push_back(scale);
        is_divided = true;
    }
    return is_divided;
}

static double angle_at(const Vec3 &apex, const Vec3 &a, const Vec3 &b)
{
    return std::atan2(((a - apex) % (b - apex)).norm(), (a - apex) | (b - apex));
}

/* Returns true if the two angles opposite to the edge sum to more than pi, and the edge after the
 * flip does not exist yet. */
static bool is_better_flipped(const Refinement &work, OpenMesh::EdgeHandle edge)
{
    const EditMesh &mesh = work.mesh;
    if (mesh.is_boundary(edge) || !mesh.is_flip_ok(edge)) return false;
    const auto half = mesh.halfedge_handle(edge, 0), twin = mesh.halfedge_handle(edge, 1);
    const auto left = mesh.to_vertex_handle(mesh.next_halfedge_handle(half));
    const auto right = mesh.to_vertex_handle(mesh.next_halfedge_handle(twin));
    const Vec3 a = mesh.point(mesh.from_vertex_handle(half));
    const Vec3 b = mesh.point(mesh.to_vertex_handle(half));
    const Vec3 p = mesh.point(left), q = mesh.point(right);
    const uint32_t l = (uint32_t)left.idx(), r = (uint32_t)right.idx();
    if (l < work.loop_count && r < work.loop_count &&
        work.options.is_taken(work.options.user, l, r))
        return false;
    /* the edge is flipped only if both new faces have the orientation of the old ones */
    const Vec3 normal = ((b - a) % (p - a)) + ((q - a) % (b - a));
    if ((((q - a) % (p - a)) | normal) <= 0 || (((p - b) % (q - b)) | normal) <= 0) return false;
    return angle_at(p, a, b) + angle_at(q, a, b) > std::acos(-1.0) * (1 + GD_TOL_EDIT_FLIP);
}

static bool flip(Refinement &work)
{
    bool is_flipped = false;
    for (int round = 0, again = 1; round < ROUNDS && again; round++) {
        again = 0;
        for (auto edge : work.mesh.edges()) {
            work.watch.step();
            if (!is_better_flipped(work, edge)) continue;
            work.mesh.flip(edge);
            again = 1;
        }
        is_flipped |= again;
    }
    return is_flipped;
}

/* Smooths the vertices in their order. For neighbours that were already moved, uses the new
 * positions (Gauss-Seidel). */
static void smooth(Refinement &work)
{
    EditMesh &mesh = work.mesh;
    for (int step = 0; step < STEPS; step++) {
        for (size_t v = work.loop_count; v < mesh.n_vertices(); v++) {
            const Vertex vertex((int)v);
            Vec3 sum(0, 0, 0);
            for (auto neighbour : mesh.vv_range(vertex)) sum += mesh.point(neighbour);
            mesh.set_point(vertex, sum / (double)mesh.valence(vertex));
            work.watch.step();
        }
    }
}

static enum gd_status write(const EditMesh &mesh, uint32_t loop_count, struct gd__patch &out)
{
    const size_t vertices = mesh.n_vertices(), faces = mesh.n_faces();
    auto *positions = (double(*)[3])std::malloc(vertices * sizeof *out.positions);
    auto *corners = (uint32_t *)std::malloc(3 * faces * sizeof *out.corners);
    if (!positions || !corners) {
        std::free(positions);
        std::free(corners);
        return GD_NO_MEMORY;
    }
    for (auto vertex : mesh.vertices())
        std::memcpy(positions[vertex.idx()], mesh.point(vertex).data(), sizeof *positions);
    uint32_t *corner = corners;
    for (auto face : mesh.faces()) {
        for (auto vertex : mesh.fv_range(face)) *corner++ = (uint32_t)vertex.idx();
    }
    out = {positions, (uint32_t)vertices, loop_count, corners, (uint32_t)faces};
    return GD_OK;
}

static enum gd_status refine(const struct gd__patch &rough, Refinement &work, struct gd__patch &out)
{
    if (!read(rough, work.mesh)) return GD_NON_MANIFOLD_EDGE;
    measure_loop(work);
    flip(work);
    for (int round = 0; round < ROUNDS && divide(work); round++) flip(work);
    if (work.options.is_smooth) smooth(work);
    return write(work.mesh, rough.loop_count, out);
}

} // namespace gd_edit

enum gd_status gd__patch_refine(const struct gd__patch *rough,
                                const struct gd__patch_options *options,
                                const struct gd_control *control, struct gd__patch *out)
{
    return gd_edit::guarded([&] {
        gd_edit::Refinement work = {
            {}, {}, rough->loop_count, *options, gd_edit::Watch(control, 1e5)};
        return gd_edit::refine(*rough, work, *out);
    });
}
