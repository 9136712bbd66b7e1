/* Uploads a mesh and computes a shortest path: example MESH.obj */
#include <stdio.h>

#include "geodesicd.h"

int main(int count, char **arguments)
{
    struct gdc_client *client = gdc_client_create(NULL, NULL);
    struct gdc_problem problem = {.detail = "usage: example MESH"};
    struct gdc_path path = {.xyz = NULL};
    int is_done = count == 2 && !gdc_upload_file(client, "example", arguments[1], &problem) &&
                  !gdc_shortest_path(client, "example", gdc_vertex(0), gdc_near(0.5, 0.5, 0.5),
                                     &path, &problem);
    if (is_done)
        printf("%.12g over %zu points\n", path.length, path.count);
    else
        fprintf(stderr, "%s\n", problem.detail);
    gdc_free(path.xyz);
    gdc_client_destroy(client);
    return !is_done;
}
