/* Uploads a mesh and computes a shortest path: example MESH.obj */
#include <cstdio>

#include "geodesicd.hpp"

int main(int, char **arguments)
try {
    geodesicd::Client client;
    auto mesh = client.upload_file("example", arguments[1]);
    auto path = mesh.path(gdc_vertex(0), gdc_near(0.5, 0.5, 0.5));
    std::printf("%.12g over %zu points\n", path.length, path.points.size());
} catch (const geodesicd::Error &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
