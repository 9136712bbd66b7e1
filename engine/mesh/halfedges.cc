#include "mesh/halfedges.h"

#include <cstdlib>
#include <new>

#include <OpenMesh/Core/Mesh/TriConnectivity.hh>

namespace
{

using Kernel = OpenMesh::TriConnectivity;

constexpr uint32_t faces_between_checks = 64;

/* Adds the faces one by one; counts the ones that the kernel refuses. */
gd_status add_faces(Kernel &kernel, const uint32_t (*corner)[3], uint32_t face_count, const gd_control *control,
                    double begin, double end, uint32_t &failed)
{
    failed = 0;
    for (uint32_t f = 0; f < face_count; f++) {
        if (f % faces_between_checks == 0) {
            gd_status status = gd_control_check(control, begin + (end - begin) * f / face_count);
            if (status != GD_OK) return status;
        }
        auto vertex = [&](int k) { return Kernel::VertexHandle(static_cast<int>(corner[f][k])); };
        if (!kernel.add_face(vertex(0), vertex(1), vertex(2)).is_valid()) failed++;
    }
    return GD_OK;
}

gd_status export_halfedges(const Kernel &kernel, gd__halfedges &out)
{
    size_t count = kernel.n_halfedges();
    out.edge_count = uint32_t(kernel.n_edges());
    out.origin = static_cast<uint32_t *>(std::malloc((count + 1) * sizeof(uint32_t)));
    out.face = static_cast<uint32_t *>(std::malloc((count + 1) * sizeof(uint32_t)));
    if (!out.origin || !out.face) {
        gd__halfedges_free(&out);
        return GD_NO_MEMORY;
    }
    for (size_t h = 0; h < count; h++) {
        Kernel::HalfedgeHandle halfedge(static_cast<int>(h));
        out.origin[h] = uint32_t(kernel.from_vertex_handle(halfedge).idx());
        out.face[h] = uint32_t(kernel.face_handle(halfedge).idx()); /* OpenMesh's invalid index is -1 */
    }
    return GD_OK;
}

} // namespace

enum gd_status gd__halfedges_connect(const uint32_t (*corner)[3], uint32_t face_count, uint32_t vertex_count,
                                     const struct gd_control *control, double begin, double end,
                                     struct gd__halfedges *out)
{
    try {
        Kernel kernel;
        kernel.reserve(vertex_count, (3 * size_t(face_count) + vertex_count) / 2, face_count);
        for (uint32_t v = 0; v < vertex_count; v++) kernel.new_vertex();
        gd__halfedges halfedges = {};
        gd_status status = add_faces(kernel, corner, face_count, control, begin, end, halfedges.failed_faces);
        if (status == GD_OK) status = export_halfedges(kernel, halfedges);
        if (status == GD_OK) *out = halfedges;
        return status;
    } catch (const std::bad_alloc &) {
        return GD_NO_MEMORY;
    } catch (...) {
        return GD_INTERNAL;
    }
}

void gd__halfedges_free(struct gd__halfedges *halfedges)
{
    std::free(halfedges->origin);
    std::free(halfedges->face);
    halfedges->origin = halfedges->face = nullptr;
}
