/* gd_bench_geometry_central: geometry-central as a solver with the command line of peer.h: fields
 * by its exact solver, lines by traceGeodesic. Built only if GEOMETRY_CENTRAL names its source,
 * with its library in GEOMETRY_CENTRAL/build/src (see the Makefile). */
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "geometrycentral/surface/exact_geodesics.h"
#include "geometrycentral/surface/surface_mesh_factories.h"
#include "geometrycentral/surface/trace_geodesic.h"
#include "geometrycentral/surface/vertex_position_geometry.h"

#include "tests/bench/peer.h"

namespace
{

using namespace geometrycentral;
using namespace geometrycentral::surface;

struct model {
    std::unique_ptr<ManifoldSurfaceMesh> mesh;
    std::unique_ptr<VertexPositionGeometry> geometry;
};

void *create(const gd_polygons *triangles)
{
    std::vector<Vector3> positions(triangles->position_count);
    std::vector<std::vector<size_t>> faces(triangles->polygon_count);
    for (size_t i = 0; i < positions.size(); i++)
        positions[i] = {triangles->positions[i][0], triangles->positions[i][1],
                        triangles->positions[i][2]};
    for (size_t i = 0; i < faces.size(); i++)
        faces[i] = {triangles->corners[3 * i], triangles->corners[3 * i + 1],
                    triangles->corners[3 * i + 2]};
    try {
        auto made = std::make_unique<model>();
        std::tie(made->mesh, made->geometry) = makeManifoldSurfaceMeshAndGeometry(faces, positions);
        /* computes this before the first line, whose time would include it otherwise */
        made->geometry->requireHalfedgeVectorsInFace();
        made->geometry->requireHalfedgeVectorsInVertex();
        made->geometry->requireVertexAngleSums();
        return made.release();
    } catch (const std::exception &) {
        return nullptr;
    }
}

bool field(void *surface, uint32_t source, double *out)
{
    auto *at = static_cast<model *>(surface);
    VertexData<double> distances =
        exactGeodesicDistance(*at->mesh, *at->geometry, at->mesh->vertex(source));
    for (Vertex v : at->mesh->vertices()) out[v.getIndex()] = distances[v];
    return true;
}

bool trace(void *surface, uint32_t face, double length, peer_lines *out)
{
    auto *at = static_cast<model *>(surface);
    const SurfacePoint middle(at->mesh->face(face), Vector3{1.0 / 3, 1.0 / 3, 1.0 / 3});
    TraceOptions options;
    options.includePath = true;
    for (int i = 0; i < PEER_LINES; i++) {
        double angle = 2 * M_PI * i / PEER_LINES;
        auto line = traceGeodesic(*at->geometry, middle,
                                  Vector2{std::cos(angle), std::sin(angle)} * length, options);
        Vector3 end = line.endPoint.interpolate(at->geometry->vertexPositions);
        out->crossings += line.pathPoints.size() - 2;
        out->ends += end.x + end.y + end.z;
    }
    return true;
}

void release(void *surface)
{
    delete static_cast<model *>(surface);
}

const peer geometry_central = {
    "gd_bench_geometry_central", create, field, nullptr, trace, nullptr, release};

} // namespace

int main(int argc, char **argv)
{
    if (argc > 1) return peer_run(&geometry_central, argv + 1);
    std::fputs("usage: gd_bench_geometry_central [--trace] mesh.obj NUMBER...\n", stderr);
    return 2;
}
