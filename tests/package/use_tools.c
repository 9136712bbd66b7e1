/* A program in C and C++ that uses libgeodesic-tools. It computes the length of the vector from one
 * corner of a unit square to the opposite corner. */
#include <stdio.h>

#include <gd/tools.h>

int main(void)
{
    const char text[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    struct gd_vertex first = {0}, third = {2};
    struct gd_mesh *mesh;
    struct gd_detail error;
    if (gd_mesh_load(text, sizeof text - 1, NULL, &mesh, &error)) return 1;
    struct gd_point from, to;
    struct gd_path path;
    struct gd_log log;
    if (gd_point_at_vertex(mesh, first, &from, NULL) || gd_point_at_vertex(mesh, third, &to, NULL))
        return 2;
    if (gd_path(mesh, &from, &to, &path)) return 3;
    if (gd_vector_log(mesh, &path, &log, NULL)) return 4;
    printf("distance: %.17g\n", log.vector.length);
    gd_log_free(&log);
    gd_path_free(&path);
    gd_mesh_release(mesh);
    return 0;
}
