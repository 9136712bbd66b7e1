/* Models like those of Y.-J. Liu's tables (section 5.2): an eight, a sphere, a pot with a handle,
 * and scans, in the cube [-1,1]^3. The number of triangles and the evenness of edges are
 * parameters. Each model is made finer than needed and then remeshed. */
#include <math.h>

#include "tests/samples/builder.h"
#include "tests/samples/remesh.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

static uint32_t sphere_level(double faces)
{
    uint32_t level = 0;
    while (20 * ldexp(1, 2 * (int)level) < faces) level++;
    return level;
}

/* Remeshes the mesh and moves it to *out. On failure the mesh is lost. */
static enum gd_status remesh_fitted(struct gd_polygons *mesh, const struct remeshing *remeshing,
                                    uint64_t seed, struct gd_polygons *out)
{
    sample_fit(mesh);
    enum gd_status status = sample_remesh(mesh, remeshing, seed);
    if (status != GD_OK) return status;
    sample_fit(mesh);
    *out = *mesh;
    return GD_OK;
}

enum gd_status sample_eight(const struct remeshing *remeshing, uint64_t seed,
                            struct gd_polygons *out)
{
    struct gd_polygons mesh;
    enum gd_status status =
        sample_genus2((uint32_t)ceil(sqrt(0.06 * remeshing->faces)), 0.02, &mesh);
    return status == GD_OK ? remesh_fitted(&mesh, remeshing, seed, out) : status;
}

enum gd_status sample_ball(const struct remeshing *remeshing, uint64_t seed,
                           struct gd_polygons *out)
{
    struct gd_polygons mesh;
    enum gd_status status = sample_icosphere(sphere_level(4.0 * remeshing->faces), 1, &mesh);
    return status == GD_OK ? remesh_fitted(&mesh, remeshing, seed, out) : status;
}

/* Makes a closed tube around a circle. On one side the tube is as wide as the body of a pot, on the
 * other side as thin as its handle. */
enum gd_status sample_pot(const struct remeshing *remeshing, uint64_t seed, struct gd_polygons *out)
{
    struct sample_builder builder = {0};
    uint32_t rows = (uint32_t)ceil(sqrt(0.7 * remeshing->faces)) + 3, columns = 2 * rows;
    for (uint32_t row = 0; row < rows; row++) {
        for (uint32_t column = 0; column < columns; column++) {
            double u = 2 * M_PI * column / columns, v = 2 * M_PI * row / rows;
            double width = 0.1 + 0.7 * pow(0.5 + 0.5 * cos(u), 4), reach = 1 + width * cos(v);
            sample_add_vertex(&builder, reach * cos(u), reach * sin(u),
                              width * (1 + 0.3 * cos(u)) * sin(v));
        }
    }
    sample_add_lattice(
        &builder, (struct sample_lattice){
                      .columns = columns, .rows = rows, .wrap_columns = true, .wrap_rows = true});
    struct gd_polygons mesh;
    enum gd_status status = sample_finish(&builder, &mesh);
    return status == GD_OK ? remesh_fitted(&mesh, remeshing, seed, out) : status;
}

/* Adds lumps and folds of all sizes down to 1/100. */
static void carve(struct gd_polygons *mesh)
{
    for (uint32_t i = 0; i < mesh->position_count; i++) {
        double *p = mesh->positions[i], height = 1, size = 1;
        for (double wave = 2; wave < 100; wave *= 1.9, size *= 0.52)
            height += 0.2 * size * sin(wave * p[0] + 3 * size) * sin(wave * p[1] + size) *
                      cos(wave * p[2] - 2 * size);
        for (int k = 0; k < 3; k++) p[k] *= height;
    }
}

enum gd_status sample_scan(const struct remeshing *remeshing, uint64_t seed,
                           struct gd_polygons *out)
{
    struct gd_polygons mesh;
    enum gd_status status = sample_icosphere(sphere_level(1.5 * remeshing->faces), 1, &mesh);
    if (status != GD_OK) return status;
    carve(&mesh);
    return remesh_fitted(&mesh, remeshing, seed, out);
}
