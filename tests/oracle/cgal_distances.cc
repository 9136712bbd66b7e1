#include "tests/oracle/cgal_distances.h"

#if __has_include(<CGAL/Surface_mesh_shortest_path.h>)

/* Header-only: uses Boost's numbers instead of GMP's. Assertions are off, as in published
 * programs. */
#define CGAL_DISABLE_GMP  1
#define CGAL_DISABLE_MPFR 1
#define CGAL_NDEBUG       1

#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>

namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Solver =
    CGAL::Surface_mesh_shortest_path<CGAL::Surface_mesh_shortest_path_traits<Kernel, Mesh>>;
using Vertex = Mesh::Vertex_index;

} // namespace

struct cgal_surface {
    Mesh mesh;
    /* the vertex of each position; null_vertex() if no face uses the position */
    std::vector<Vertex> vertex_of;
    std::vector<uint32_t> position_of;
    std::unique_ptr<Solver> solver;

    Vertex add_corner(const gd_polygons *triangles, uint32_t position)
    {
        if (vertex_of[position] == Mesh::null_vertex()) {
            const double *p = triangles->positions[position];
            vertex_of[position] = mesh.add_vertex(Kernel::Point_3(p[0], p[1], p[2]));
            position_of.push_back(position);
        }
        return vertex_of[position];
    }
};

namespace
{

/* Converts the vertices and edges that CGAL's path passes into a polyline. A path between vertices
 * never bends inside a face. */
struct Tracer {
    const cgal_surface &surface;
    polyline *line;

    void operator()(Mesh::Halfedge_index side, double t)
    {
        polyline_add(line, {surface.position_of[surface.mesh.source(side)],
                            surface.position_of[surface.mesh.target(side)], t});
    }
    void operator()(Vertex vertex)
    {
        polyline_add(line, {surface.position_of[vertex], surface.position_of[vertex], 0});
    }
    void operator()(Mesh::Face_index, const Solver::Barycentric_coordinates &)
    {
        line->failed = true;
    }
};

} // namespace

extern "C" bool cgal_is_available(void)
{
    return true;
}

extern "C" struct cgal_surface *cgal_surface_create(const struct gd_polygons *triangles)
try {
    auto surface = std::make_unique<cgal_surface>();
    surface->vertex_of.assign(triangles->position_count, Mesh::null_vertex());
    for (uint32_t f = 0; f < triangles->polygon_count; f++) {
        Vertex corner[3];
        for (uint32_t k = 0; k < 3; k++)
            corner[k] = surface->add_corner(triangles, triangles->corners[3 * f + k]);
        if (surface->mesh.add_face(corner[0], corner[1], corner[2]) == Mesh::null_face())
            return nullptr;
    }
    surface->solver = std::make_unique<Solver>(surface->mesh);
    return surface.release();
} catch (const std::exception &) {
    return nullptr;
}

extern "C" void cgal_surface_free(struct cgal_surface *surface)
{
    delete surface;
}

extern "C" bool cgal_surface_solve(struct cgal_surface *surface, uint32_t source, double *out)
try {
    surface->solver->remove_all_source_points();
    surface->solver->add_source_point(surface->vertex_of[source]);
    surface->solver->build_sequence_tree();
    for (size_t i = 0; i < surface->vertex_of.size(); i++) {
        out[i] = std::numeric_limits<double>::quiet_NaN();
        if (surface->vertex_of[i] == Mesh::null_vertex()) continue;
        double distance =
            surface->solver->shortest_distance_to_source_points(surface->vertex_of[i]).first;
        out[i] = distance < 0 ? HUGE_VAL : distance;
    }
    return true;
} catch (const std::exception &) {
    return false;
}

extern "C" bool cgal_surface_path(struct cgal_surface *surface, uint32_t vertex,
                                  struct polyline *line)
try {
    Tracer tracer{*surface, line};
    surface->solver->shortest_path_sequence_to_source_points(surface->vertex_of[vertex], tracer);
    return !line->failed;
} catch (const std::exception &) {
    return false;
}

#else

extern "C" bool cgal_is_available(void)
{
    return false;
}

extern "C" struct cgal_surface *cgal_surface_create(const struct gd_polygons *)
{
    return nullptr;
}

extern "C" void cgal_surface_free(struct cgal_surface *)
{
}

extern "C" bool cgal_surface_solve(struct cgal_surface *, uint32_t, double *)
{
    return false;
}

extern "C" bool cgal_surface_path(struct cgal_surface *, uint32_t, struct polyline *)
{
    return false;
}

#endif
