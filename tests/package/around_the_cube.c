/* An example of a user's program. It computes the distance between opposite corners of a unit cube,
 * which is sqrt(5). */
#include <stdio.h>

#include <gd/geodesic.h>

int main(void)
{
    double positions[8][3];
    uint32_t corners[] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    uint32_t first[] = {0, 4, 8, 12, 16, 20, 24};
    for (int i = 0; i < 8; i++)
        for (int axis = 0; axis < 3; axis++) positions[i][axis] = i >> axis & 1;
    const struct gd_polygons cube = {positions, 8, 6, corners, first};
    struct gd_mesh *mesh;
    struct gd_point from, to;
    double distance;
    if (gd_mesh_build(&cube, NULL, NULL, &mesh, NULL) != GD_OK) return 1;
    if (gd_point_at_vertex(mesh, (struct gd_vertex){0}, &from, NULL) != GD_OK) return 2;
    if (gd_point_at_vertex(mesh, (struct gd_vertex){7}, &to, NULL) != GD_OK) return 3;
    if (gd_distance(mesh, &from, &to, &distance) != GD_OK) return 4;
    printf("%.17g\n", distance);
    gd_mesh_release(mesh);
    return 0;
}
