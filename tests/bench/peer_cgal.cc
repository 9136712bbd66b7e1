/* gd_bench_cgal: CGAL as a solver with the command line of peer.h. */
#include <cstdio>

#include "tests/bench/peer.h"
#include "tests/oracle/cgal_distances.h"

namespace
{

void *create(const gd_polygons *triangles)
{
    return cgal_surface_create(triangles);
}

bool field(void *surface, uint32_t source, double *out)
{
    return cgal_surface_solve(static_cast<cgal_surface *>(surface), source, out);
}

void release(void *surface)
{
    cgal_surface_free(static_cast<cgal_surface *>(surface));
}

const peer cgal = {"gd_bench_cgal", create, field, nullptr, nullptr, nullptr, release};

} // namespace

int main(int argc, char **argv)
{
    if (!cgal_is_available()) {
        std::fputs("gd_bench_cgal: was built without CGAL (libcgal-dev).\n", stderr);
        return 1;
    }
    if (argc > 1) return peer_run(&cgal, argv + 1);
    std::fputs("usage: gd_bench_cgal mesh.obj SOURCE...\n", stderr);
    return 2;
}
