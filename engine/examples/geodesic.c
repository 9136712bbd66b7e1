/* The five steps of gd/geodesic.h, in C and in C++: loads a mesh file, makes two points, computes
 * the distance and the path between them, and the distances of all vertices.
 *
 *     cc geodesic.c $(pkg-config --cflags --libs geodesic) -o example
 *     ./example mesh.obj 0 7
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gd/geodesic.h>

static void *read_file(const char *name, size_t *size)
{
    FILE *file = fopen(name, "rb");
    char *bytes = NULL;
    if (file && fseek(file, 0, SEEK_END) == 0 && ftell(file) > 0) {
        *size = (size_t)ftell(file);
        rewind(file);
        bytes = (char *)malloc(*size);
        if (bytes && fread(bytes, 1, *size, file) != *size) {
            free(bytes);
            bytes = NULL;
        }
    }
    if (file) fclose(file);
    return bytes;
}

static int fail(enum gd_status status, const char *text)
{
    fprintf(stderr, "%s: %s\n", gd_status_name(status), text);
    return 1;
}

/* Prints the shortest path between two points. */
static enum gd_status print_path(const struct gd_mesh *mesh, const struct gd_point *a,
                                 const struct gd_point *b)
{
    struct gd_path path;
    enum gd_status status = gd_path(mesh, a, b, &path);
    if (status) return status;
    printf("path of %u points:\n", (unsigned)path.count);
    for (uint32_t i = 0; i < path.count; i++) {
        struct gd_vec3 xyz = gd_point_position(mesh, &path.points[i]);
        printf("  %.17g %.17g %.17g\n", xyz.x, xyz.y, xyz.z);
    }
    gd_path_free(&path);
    return GD_OK;
}

/* Computes the distances from one point to all vertices with one field, and prints the farthest
 * vertex. */
static enum gd_status print_farthest(const struct gd_mesh *mesh, const struct gd_point *a)
{
    struct gd_seed seed;
    struct gd_field_request request;
    memset(&seed, 0, sizeof seed); /* all zero is the default */
    memset(&request, 0, sizeof request);
    seed.point = *a;
    request.seeds = &seed;
    request.seed_count = 1;
    struct gd_field *field;
    enum gd_status status = gd_field_build(mesh, &request, NULL, &field, NULL);
    if (status) return status;
    struct gd_point farthest;
    double distance;
    status = gd_field_farthest(field, NULL, &farthest, &distance);
    if (!status) {
        struct gd_vec3 xyz = gd_point_position(mesh, &farthest);
        printf("farthest: %.17g at %.17g %.17g %.17g\n", distance, xyz.x, xyz.y, xyz.z);
    }
    gd_field_release(field);
    return status;
}

static int measure(const struct gd_mesh *mesh, struct gd_vertex from, struct gd_vertex to)
{
    struct gd_point a, b;
    struct gd_detail error;
    double distance;
    enum gd_status status = gd_point_at_vertex(mesh, from, &a, &error);
    if (!status) status = gd_point_at_vertex(mesh, to, &b, &error);
    if (status) return fail(status, error.text);
    status = gd_distance(mesh, &a, &b, &distance);
    if (!status) printf("distance: %.17g\n", distance);
    if (!status) status = print_path(mesh, &a, &b);
    if (!status) status = print_farthest(mesh, &a);
    return status ? fail(status, gd_status_sentence(status)) : 0;
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "usage: %s FILE VERTEX VERTEX\n", argv[0]);
        return 2;
    }
    size_t size = 0;
    void *bytes = read_file(argv[1], &size);
    if (!bytes) {
        perror(argv[1]);
        return 1;
    }
    struct gd_mesh *mesh;
    struct gd_detail error;
    enum gd_status status = gd_mesh_load(bytes, size, NULL, &mesh, &error);
    free(bytes);
    if (status) return fail(status, error.text);
    struct gd_vertex from = {(uint32_t)atoi(argv[2])}, to = {(uint32_t)atoi(argv[3])};
    int code = measure(mesh, from, to);
    gd_mesh_release(mesh);
    return code;
}
