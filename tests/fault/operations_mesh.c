/* Meshes, built with and without repairs. */
#include "tests/fault/operations.h"

#include <string.h>

#include "gd/io.h"
#include "gd/locate.h"
#include "gd/path.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

static struct gd_polygons terrain, large, solid, broken, refused, twice, flat;
static struct gd_mesh *mesh;

/* Polygons of four, five and eight corners, one of them concave. */
static const char polygons_text[] = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 2 0\nv 1 1 0\nv 0.5 1.5 0\nv 0 "
                                    "2 0\nv -1 1 0.5\nv 3 0 1\nv 3 2 1\n"
                                    "f 1 2 3 4 5 6 7\nf 1 7 8\nf 2 9 10 3\n";

/* Defects: edges of three faces, two fans at a vertex, repeated faces, faces without extent, flat
 * faces, reversed faces, and vertices that nearly coincide. */
static const char broken_text[] =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n"
    "v 5 0 0\nv 6 0 0\nv 5 1 0\nv 4 0 0\nv 4 -1 0\nf 6 7 8\nf 6 9 10\n"
    "v 10 0 0\nv 11 0 0\nv 10 1 0\nv 11 1 0\nf 11 12 13\nf 11 12 13\nf 12 14 13\nf 11 11 12\n"
    "v 20 0 0\nv 22 0 0\nv 21 0 0\nv 21 1 0\nv 21 -1 0\nf 15 16 18\nf 15 17 16\nf 15 19 17\nf 17 "
    "19 16\n"
    "v 30 0 0\nv 31 0 0\nv 30 1 0\nv 31 0.0000001 0\nv 30 1.0000001 0\nv 31 1 0\nf 20 21 22\nf 23 "
    "24 25\n"
    "v 40 0 0\nv 41 0 0\nv 40 1 0\nv 41 1 0\nf 26 27 28\nf 27 28 29\n";

/* Repeated faces at an edge of more than two faces, and a repeated face that touches no other
 * face. */
static const char refused_text[] =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nf 1 2 3\nf 2 1 4\nf 3 1 2\nf 1 3 2\n";
static const char twice_text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\nf 1 2 3\n";

/* A flat face, and no other defect. */
static const char flat_text[] =
    "v 0 0 0\nv 2 0 0\nv 1 0 0\nv 1 1 0\nv 1 -1 0\nf 1 2 4\nf 1 3 2\nf 1 5 3\nf 3 5 2\n";

static void read_text(const char *text, struct gd_polygons *out)
{
    struct gd_detail detail = {0};
    check_ok(gd_read_polygons(text, strlen(text),
                              &(struct gd_read_options){.format = GD_FORMAT_OBJ}, out, &detail),
             &detail);
}

static void open_meshes(void)
{
    check_ok(sample_terrain(16, 0.4, 7, &terrain), NULL);
    check_ok(sample_terrain(80, 0.4, 7, &large), NULL);
    read_text(polygons_text, &solid);
    read_text(broken_text, &broken);
    read_text(refused_text, &refused);
    read_text(twice_text, &twice);
    read_text(flat_text, &flat);
    mesh = test_mesh(&terrain);
}

static void digest_built(struct digest *digest, const void *out)
{
    digest_mesh(digest, *(struct gd_mesh *const *)out);
}

static void discard_built(void *out)
{
    gd_mesh_release(*(struct gd_mesh **)out);
}

static void digest_polygons(struct digest *digest, const void *out)
{
    const struct gd_polygons *p = out;
    digest_bytes(digest, p->positions, p->position_count * sizeof *p->positions);
    digest_bytes(digest, p->corners, gd_polygons_corner_count(p) * sizeof *p->corners);
}

static void discard_polygons(void *out)
{
    gd_polygons_free(out);
}

static void digest_point(struct digest *digest, const void *out)
{
    digest_path(digest, &(struct gd_path){.count = 1, .points = (struct gd_point *)out});
}

static const struct answer built = {sizeof(struct gd_mesh *), digest_built, discard_built};
static const struct answer polygons_of = {sizeof(struct gd_polygons), digest_polygons,
                                          discard_polygons};
static const struct answer place = {sizeof(struct gd_point), digest_point, NULL};

static enum gd_status build(const struct gd_polygons *polygons,
                            const struct gd_mesh_options *options, void *out)
{
    struct gd_detail detail = {0};
    return gd_mesh_build(polygons, options, NULL, out, &detail);
}

static enum gd_status build_terrain(void *out)
{
    return build(&terrain, NULL, out);
}

/* The sides fill more than a huge page, so their memory also holds scratch arrays. */
static enum gd_status build_large(void *out)
{
    return build(&large, NULL, out);
}

static enum gd_status build_consuming(void *out)
{
    struct gd_polygons polygons = {0};
    struct gd_detail detail = {0};
    enum gd_status status = sample_terrain(80, 0.4, 7, &polygons);
    if (!status) status = gd_mesh_build_consuming(&polygons, NULL, NULL, out, &detail);
    gd_polygons_free(&polygons);
    return status;
}

static enum gd_status build_polygons(void *out)
{
    return build(&solid, NULL, out);
}

static enum gd_status build_repaired(void *out)
{
    return build(&broken, &(struct gd_mesh_options){.repair_split = true}, out);
}

static enum gd_status build_welded(void *out)
{
    return build(
        &broken,
        &(struct gd_mesh_options){.repair_split = true, .weld = true, .weld_tolerance = 1e-5}, out);
}

static enum gd_status build_refused(void *out)
{
    return build(&refused, NULL, out);
}

static enum gd_status build_without_doubles(void *out)
{
    return build(&twice, &(struct gd_mesh_options){.repair_split = true}, out);
}

static enum gd_status build_without_flats(void *out)
{
    return build(&flat, &(struct gd_mesh_options){.repair_split = true}, out);
}

static enum gd_status make_polygons(void *out)
{
    return gd_mesh_polygons(mesh, out);
}

static enum gd_status locate_nearest(void *out)
{
    struct gd_detail detail = {0};
    return gd_locate_nearest(mesh, (struct gd_vec3){0.3, 0.4, 1}, -1, out, &detail);
}

static enum gd_status locate_first_hit(void *out)
{
    struct gd_detail detail = {0};
    return gd_locate_first_hit(mesh, (struct gd_vec3){0.3, 0.4, 9}, (struct gd_vec3){0, 0, -1}, out,
                               &detail);
}

static const struct operation items[] = {
    {"build a mesh", &built, build_terrain, GD_OK, NULL},
    {"build a large mesh", &built, build_large, GD_OK, NULL},
    {"build a mesh from consumed polygons", &built, build_consuming, GD_OK, NULL},
    {"build a mesh of polygons", &built, build_polygons, GD_OK, NULL},
    {"build and repair a mesh", &built, build_repaired, GD_OK, NULL},
    {"build, weld and repair a mesh", &built, build_welded, GD_OK, NULL},
    {"build a mesh without doubles", &built, build_without_doubles, GD_OK, NULL},
    {"build a mesh without flat faces", &built, build_without_flats, GD_OK, NULL},
    {"refuse a mesh", &built, build_refused, GD_DUPLICATE_FACE, NULL},
    {"polygons of a mesh", &polygons_of, make_polygons, GD_OK, NULL},
    {"nearest point", &place, locate_nearest, GD_OK, NULL},
    {"first hit of a ray", &place, locate_first_hit, GD_OK, NULL},
};

const struct operations mesh_operations = {open_meshes, items, COUNT(items)};
