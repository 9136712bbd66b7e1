/* Files of meshes, read and written. */
#include "tests/fault/operations.h"

#include <stdlib.h>
#include <string.h>

#include "gd/control_mesh.h"
#include "gd/result_file.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

static struct gd_polygons polygons, quads;

struct text {
    char *bytes;
    size_t size;
};

static struct text files[GD_FORMAT_GLTF + 1];

static const char tagged[] =
    "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
    "f 5 6 8 7\nf 1 3 4 2\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
    "t crease 3/1/0 0 1 3 2.5\nt corner 1/1/0 7 3\nt interpolateboundary 1/0/0 1\n";
static const char text_ply[] =
    "ply\nformat ascii 1.0\ncomment none\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\n"
    "end_header\n0 0 0 1\n1 0 0 2\n1 1 0 3\n0 1 0 4\n3 0 1 2\n3 0 2 3\n";
static const char text_stl[] =
    "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
    "endfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\n"
    "endfacet\nendsolid s\n";

static void open_files(void)
{
    check_ok(sample_terrain(10, 0.4, 7, &polygons), NULL);
    check_ok(gd_read_polygons(tagged, strlen(tagged),
                              &(struct gd_read_options){.format = GD_FORMAT_OBJ}, &quads, NULL),
             NULL);
    for (int format = GD_FORMAT_OBJ; format <= GD_FORMAT_GLTF; format++)
        check_ok(gd_write_polygons(&polygons, (enum gd_format)format, &files[format].bytes,
                                   &files[format].size),
                 NULL);
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

static void digest_control_mesh(struct digest *digest, const void *out)
{
    const struct gd_control_mesh *mesh = out;
    digest_polygons(digest, &mesh->polygons);
    digest_bytes(digest, mesh->creases, mesh->crease_count * sizeof *mesh->creases);
}

static void discard_control_mesh(void *out)
{
    gd_control_mesh_free(out);
}

static void digest_text(struct digest *digest, const void *out)
{
    const struct text *text = out;
    digest_bytes(digest, text->bytes, text->size);
}

static void discard_text(void *out)
{
    free(((struct text *)out)->bytes);
}

static const struct answer read_polygons = {sizeof(struct gd_polygons), digest_polygons,
                                            discard_polygons};
static const struct answer read_control = {sizeof(struct gd_control_mesh), digest_control_mesh,
                                           discard_control_mesh};
static const struct answer written = {sizeof(struct text), digest_text, discard_text};

static enum gd_status read_text(const void *bytes, size_t size, enum gd_format format, void *out)
{
    struct gd_detail detail = {0};
    return gd_read_polygons(bytes, size, &(struct gd_read_options){.format = format}, out, &detail);
}

#define FORMAT(NAME, name)                                                                         \
    static enum gd_status read_##name(void *out)                                                   \
    {                                                                                              \
        return read_text(files[GD_FORMAT_##NAME].bytes, files[GD_FORMAT_##NAME].size,              \
                         GD_FORMAT_ANY, out);                                                      \
    }                                                                                              \
    static enum gd_status write_##name(void *out)                                                  \
    {                                                                                              \
        struct text *text = out;                                                                   \
        return gd_write_polygons(&polygons, GD_FORMAT_##NAME, &text->bytes, &text->size);          \
    }

FORMAT(OBJ, obj)
FORMAT(PLY, ply)
FORMAT(STL, stl)
FORMAT(OFF, off)
FORMAT(JSON, json)
FORMAT(GLB, glb)
FORMAT(GLTF, gltf)

static enum gd_status read_text_ply(void *out)
{
    return read_text(text_ply, strlen(text_ply), GD_FORMAT_PLY, out);
}

static enum gd_status read_text_stl(void *out)
{
    return read_text(text_stl, strlen(text_stl), GD_FORMAT_STL, out);
}

static enum gd_status read_tagged(void *out)
{
    struct gd_detail detail = {0};
    return gd_read_control_mesh(tagged, strlen(tagged),
                                &(struct gd_read_options){.format = GD_FORMAT_OBJ}, out, &detail);
}

static enum gd_status write_quads(void *out)
{
    struct text *text = out;
    return gd_write_polygons(&quads, GD_FORMAT_JSON, &text->bytes, &text->size);
}

/* Writes a result with arbitrary distances, a line, and an object that moves along the line. */
static enum gd_status write_result(void *out)
{
    struct text *text = out;
    const uint32_t first[] = {0, polygons.position_count};
    const struct gd_pose poses[2] = {
        {.tangent = {1, 0, 0}, .normal = {0, 0, 1}},
        {.along = 1, .position = {1, 0, 0}, .tangent = {1, 0, 0}, .normal = {0, 0, 1}}};
    const struct gd_result result = {.mesh = &polygons,
                                     .distances = polygons.positions[0],
                                     .points = (const double(*)[3])polygons.positions,
                                     .first = first,
                                     .line_count = 1,
                                     .poses = poses,
                                     .pose_count = 2};
    return gd_write_result(&result, GD_RESULT_GLB, &text->bytes, &text->size);
}

static const struct operation items[] = {
    {"read OBJ", &read_polygons, read_obj, GD_OK, NULL},
    {"read PLY", &read_polygons, read_ply, GD_OK, NULL},
    {"read PLY, text", &read_polygons, read_text_ply, GD_OK, NULL},
    {"read STL", &read_polygons, read_stl, GD_OK, NULL},
    {"read STL, text", &read_polygons, read_text_stl, GD_OK, NULL},
    {"read OFF", &read_polygons, read_off, GD_OK, NULL},
    {"read JSON", &read_polygons, read_json, GD_OK, NULL},
    {"read GLB", &read_polygons, read_glb, GD_OK, NULL},
    {"read glTF", &read_polygons, read_gltf, GD_OK, NULL},
    {"read OBJ with tags", &read_control, read_tagged, GD_OK, NULL},
    {"write OBJ", &written, write_obj, GD_OK, NULL},
    {"write PLY", &written, write_ply, GD_OK, NULL},
    {"write STL", &written, write_stl, GD_OK, NULL},
    {"write OFF", &written, write_off, GD_OK, NULL},
    {"write JSON", &written, write_json, GD_OK, NULL},
    {"write GLB", &written, write_glb, GD_OK, NULL},
    {"write glTF", &written, write_gltf, GD_OK, NULL},
    {"write a result", &written, write_result, GD_OK, NULL},
    {"write quads", &written, write_quads, GD_OK, NULL},
};

const struct operations file_operations = {open_files, items, COUNT(items)};
