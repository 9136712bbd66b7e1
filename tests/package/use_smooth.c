/* A program in C and C++ that uses libgeodesic-smooth. It computes the distance between two
 * opposite corners of a unit square, on the limit surface of the square. The limit surface passes
 * through the corners. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <gd/smooth.h>

int main(void)
{
    double positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    uint32_t corners[] = {0, 1, 2, 3}, first[] = {0, 4};
    struct gd_control_mesh control;
    memset(&control, 0, sizeof control);
    control.polygons.positions = positions;
    control.polygons.position_count = 4;
    control.polygons.polygon_count = 1;
    control.polygons.corners = corners;
    control.polygons.first = first;
    struct gd_subdivision *surface;
    if (gd_subdivision_create(&control, GD_SCHEME_CATMULL_CLARK, NULL, &surface, NULL)) return 1;
    struct gd_limit_point places[2] = {{0, 0, 0, 0}, {0, 0, 1, 1}};
    struct gd_limit_jet jets[2];
    for (int i = 0; i < 2; i++) {
        if (gd_limit_evaluate(surface, &places[i], &jets[i], NULL)) return 2;
    }
    struct gd_vec3 a = jets[0].position, b = jets[1].position;
    printf("distance: %.17g\n", sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y)));
    gd_subdivision_release(surface);
    return 0;
}
