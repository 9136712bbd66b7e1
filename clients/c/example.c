/* Uploads a mesh, asks for a distance and a path, and for the vertex that is farthest away: example
 * MESH.obj */
#include <stdio.h>
#include <stdlib.h>

#include "geodesicd.h"

static enum gdc_status print_farthest(struct gdc_client *client, const struct gdc_point *from,
                                      struct gdc_problem *problem)
{
    double *values;
    size_t count, farthest = 0;
    enum gdc_status status = gdc_field(client, "example", from, 1, &values, &count, problem);
    if (status) return status;
    for (size_t i = 1; i < count; i++)
        if (values[i] > values[farthest]) farthest = i;
    printf("farthest vertex: %zu, %.17g away\n", farthest, values[farthest]);
    free(values);
    return GDC_OK;
}

static enum gdc_status run(struct gdc_client *client, const char *file, struct gdc_problem *problem)
{
    struct gdc_point from = gdc_vertex(0), to = gdc_near(0.5, 0.5, 0.5);
    struct gdc_path path;
    enum gdc_status status = gdc_upload_file(client, "example", file, problem);
    if (!status) status = gdc_shortest_path(client, "example", from, to, &path, problem);
    if (status) return status;
    printf("distance: %.17g, a path of %zu points\n", path.length, path.count);
    free(path.xyz);
    return print_farthest(client, &from, problem);
}

int main(int count, char **arguments)
{
    struct gdc_client *client = gdc_client_create(NULL, NULL);
    struct gdc_problem problem = {.detail = "usage: example MESH"};
    int failed = !client || count != 2 || run(client, arguments[1], &problem) != GDC_OK;
    if (failed) fprintf(stderr, "%s\n", problem.detail);
    gdc_client_destroy(client);
    return failed;
}
