/* glTF primitives: converts triangles, strips and fans to triangles. Points and lines are counted
 * and skipped. See gltf.h. */
#include "io/gltf.h"

#include <string.h>

#define LOOK_ELEMENTS 8192 /* number of vertices and corners between two checks of the control */

/* Largest number of primitives of a scene. A primitive that is placed several times counts each
 * time. */
#define MOST_PRIMITIVES (UINT64_C(1) << 20)

enum mode { MODE_TRIANGLES = 4, MODE_STRIP = 5, MODE_FAN = 6 };

/* A primitive: its mode and its accessors. */
struct primitive {
    uint32_t value;
    enum mode mode;
    /* JSON values of accessors. If `positions` is GD__NO_VALUE, the primitive has no triangles. If
     * `indices` is GD__NO_VALUE, the corners are the vertices in their order. */
    uint32_t positions, indices;
    uint32_t vertex_count, corner_count;
};

/* --- members ---------------------------------------------------------------------------------- */

static uint64_t triangle_count(const struct primitive *primitive)
{
    if (primitive->mode == MODE_TRIANGLES) return primitive->corner_count / 3;
    return primitive->corner_count < 3 ? 0 : primitive->corner_count - 2;
}

/* Rejects a primitive whose positions exist only as data compressed by Draco. The accessors of such
 * a primitive describe the decoded data and have no data themselves. */
static enum gd_status refuse_draco(const struct gd__gltf *gltf, const struct primitive *primitive)
{
    uint32_t extensions = gd__json_member(&gltf->json, primitive->value, "extensions");
    if (extensions == GD__NO_VALUE) return GD_OK;
    if (gd__json_member(&gltf->json, extensions, "KHR_draco_mesh_compression") == GD__NO_VALUE)
        return GD_OK;
    if (gd__json_member(&gltf->json, primitive->positions, "bufferView") != GD__NO_VALUE)
        return GD_OK;
    return gd__gltf_fail(
        gltf, primitive->value, GD_UNSUPPORTED,
        "the primitive is compressed by Draco: store the file without compression");
}

static enum gd_status read_counts(const struct gd__gltf *gltf, struct primitive *primitive)
{
    enum gd_status status = refuse_draco(gltf, primitive);
    if (status == GD_OK)
        status = gd__gltf_reference(gltf, primitive->value, "indices", &gltf->accessors,
                                    &primitive->indices);
    if (status == GD_OK)
        status = gd__gltf_accessor_count(gltf, primitive->positions, &primitive->vertex_count);
    if (status != GD_OK) return status;
    primitive->corner_count = primitive->vertex_count;
    if (primitive->indices != GD__NO_VALUE)
        status = gd__gltf_accessor_count(gltf, primitive->indices, &primitive->corner_count);
    return status;
}

/* Reads a primitive. `out->positions` is GD__NO_VALUE if it has no triangles. */
static enum gd_status read_primitive(const struct gd__gltf *gltf, uint32_t value,
                                     struct primitive *out)
{
    uint64_t mode = 0;
    *out = (struct primitive){.value = value, .positions = GD__NO_VALUE, .indices = GD__NO_VALUE};
    enum gd_status status = gd__gltf_whole(gltf, value, "mode", MODE_TRIANGLES, MODE_FAN, &mode);
    uint32_t attributes = gd__json_member(&gltf->json, value, "attributes");
    if (status != GD_OK || mode < MODE_TRIANGLES || attributes == GD__NO_VALUE) return status;
    out->mode = (enum mode)mode;
    status = gd__gltf_reference(gltf, attributes, "POSITION", &gltf->accessors, &out->positions);
    return status == GD_OK && out->positions != GD__NO_VALUE ? read_counts(gltf, out) : status;
}

/* Finds the list of primitives of a mesh: the JSON values from `*begin` to before `*end`. */
static enum gd_status primitives_of(const struct gd__gltf *gltf, uint32_t mesh, uint32_t *begin,
                                    uint32_t *end)
{
    uint32_t list = gd__json_member(&gltf->json, mesh, "primitives");
    if (list == GD__NO_VALUE || !gd__json_is(&gltf->json, list, '['))
        return gd__gltf_fail(gltf, mesh, GD_SYNTAX, "the mesh has no array of 'primitives'");
    *begin = list + 1;
    *end = gd__json_next(&gltf->json, list);
    return GD_OK;
}

static enum gd_status add_up(const struct gd__gltf *gltf, uint32_t value, struct gd__gltf_sum *sum)
{
    struct primitive primitive;
    enum gd_status status = read_primitive(gltf, value, &primitive);
    if (status != GD_OK) return status;
    if (++sum->primitives > MOST_PRIMITIVES)
        return gd__gltf_fail(gltf, value, GD_TOO_LARGE, "the scene has more than %llu primitives",
                             (unsigned long long)MOST_PRIMITIVES);
    uint64_t triangles = primitive.positions == GD__NO_VALUE ? 0 : triangle_count(&primitive);
    if (primitive.positions == GD__NO_VALUE) sum->skipped++;
    if (triangles > 0 && primitive.vertex_count > sum->largest)
        sum->largest = primitive.vertex_count;
    sum->triangles += triangles;
    if (triangles > 0) sum->vertices += primitive.vertex_count;
    return GD_OK;
}

enum gd_status gd__gltf_count_mesh(const struct gd__gltf *gltf, uint32_t mesh,
                                   const struct gd__place *place, void *user)
{
    struct gd__gltf_sum *sum = user;
    uint32_t value = 0, end = 0;
    (void)place;
    enum gd_status status = primitives_of(gltf, mesh, &value, &end);
    for (; status == GD_OK && value < end; value = gd__json_next(&gltf->json, value)) {
        status = add_up(gltf, value, sum);
        if (status == GD_OK && sum->primitives % 64 == 0)
            status = gd_control_check(gltf->control, 0);
    }
    return status;
}

/* --- vertices --------------------------------------------------------------------------------- */

static enum gd_status look(struct gd__gltf_making *making)
{
    if (making->done++ % LOOK_ELEMENTS != 0) return GD_OK;
    double fraction = (double)making->done / (double)making->all;
    making->builder->done = fraction < 1 ? fraction : 1;
    return gd_control_check(making->gltf->control, making->builder->done);
}

static enum gd_status add_vertices(struct gd__gltf_making *making,
                                   const struct primitive *primitive, const struct gd__place *place)
{
    const char *at = gd__json_at(&making->gltf->json, primitive->positions);
    struct gd__gltf_accessor accessor;
    enum gd_status status =
        gd__gltf_accessor_open(making->gltf, primitive->positions, true, &accessor);
    for (uint32_t i = 0; status == GD_OK && i < primitive->vertex_count; i++) {
        double local[3], xyz[3];
        status = gd__gltf_accessor_next(&accessor, local);
        if (status != GD_OK) break;
        gd__place_apply(place, local, xyz);
        status = gd__weld_vertex(&making->weld, xyz, at, &making->vertices[i]);
        if (status == GD_OK) status = look(making);
    }
    return status;
}

/* Adds the vertices of a primitive, unless the previous primitive has the same vertices. Primitives
 * with different materials often share an accessor. */
static enum gd_status provide_vertices(struct gd__gltf_making *making,
                                       const struct primitive *primitive,
                                       const struct gd__place *place)
{
    if (making->accessor == primitive->positions &&
        memcmp(&making->place, place, sizeof *place) == 0)
        return GD_OK;
    making->accessor = GD__NO_VALUE;
    enum gd_status status = add_vertices(making, primitive, place);
    if (status != GD_OK) return status;
    making->accessor = primitive->positions;
    making->place = *place;
    return GD_OK;
}

/* --- triangles -------------------------------------------------------------------------------- */

/* Iterates over the corners of a primitive and the triangles that they form. */
struct run {
    struct gd__gltf_making *making;
    const struct primitive *primitive;
    struct gd__gltf_accessor indices; /* open if the primitive has indices */
    const char *at;                   /* position in the document that error texts name */
    /* true if the placement mirrors the mesh; the orientation of faces is then reversed (glTF 2.0,
       3.7.4) */
    bool is_mirrored;
    /* strip: the last three corners; fan: the first corner and the last two; list: the last
     * three */
    uint32_t recent[3];
};

static enum gd_status next_corner(struct run *run, uint32_t number, uint32_t *out)
{
    double index[3] = {number};
    enum gd_status status = GD_OK;
    if (run->primitive->indices != GD__NO_VALUE)
        status = gd__gltf_accessor_next(&run->indices, index);
    if (status != GD_OK) return status;
    if (index[0] >= run->primitive->vertex_count)
        return gd__gltf_fail(
            run->making->gltf, run->primitive->value, GD_INDEX,
            "corner %u refers to vertex %.0f of the primitive, which has only %u vertices", number,
            index[0], run->primitive->vertex_count);
    *out = (uint32_t)index[0];
    return look(run->making);
}

static enum gd_status add_triangle(struct run *run, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t corners[3] = {a, run->is_mirrored ? c : b, run->is_mirrored ? b : c};
    struct gd__builder *builder = run->making->builder;
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3 && status == GD_OK; k++)
        status = gd__builder_add_corner(builder, run->making->vertices[corners[k]], run->at);
    return status == GD_OK ? gd__builder_close_polygon(builder, run->at) : status;
}

/* Adds a triangle of a strip or a fan. Skips triangles that repeat a corner, because they only
 * connect one strip to the next. */
static enum gd_status add_linked(struct run *run, uint32_t number)
{
    const uint32_t *recent = run->recent;
    bool is_fan = run->primitive->mode == MODE_FAN, is_odd = number % 2 != 0;
    if (recent[0] == recent[1] || recent[1] == recent[2] || recent[2] == recent[0]) return GD_OK;
    if (is_fan) return add_triangle(run, recent[1], recent[2], recent[0]);
    return is_odd ? add_triangle(run, recent[0], recent[2], recent[1])
                  : add_triangle(run, recent[0], recent[1], recent[2]);
}

/* Adds a corner to `recent` in place of the oldest one. In a fan, the first corner stays. */
static void shift(struct run *run, uint32_t number, uint32_t corner)
{
    if (run->primitive->mode != MODE_FAN || number <= 2) run->recent[0] = run->recent[1];
    run->recent[1] = run->recent[2];
    run->recent[2] = corner;
}

static enum gd_status add_triangles(struct run *run)
{
    enum gd_status status = GD_OK;
    for (uint32_t number = 0; number < run->primitive->corner_count && status == GD_OK; number++) {
        uint32_t corner = 0;
        status = next_corner(run, number, &corner);
        if (status != GD_OK) return status;
        shift(run, number, corner);
        if (run->primitive->mode == MODE_TRIANGLES) {
            if (number % 3 == 2)
                status = add_triangle(run, run->recent[0], run->recent[1], run->recent[2]);
        } else if (number >= 2) {
            status = add_linked(run, number);
        }
    }
    return status;
}

/* Skips the corners after the last whole triangle. */
static enum gd_status skip_excess(struct gd__builder *builder, const struct primitive *primitive,
                                  const char *at)
{
    if (primitive->mode != MODE_TRIANGLES || primitive->corner_count % 3 == 0) return GD_OK;
    return gd__builder_skip(
        builder, at, GD_SYNTAX,
        "%u corners do not form whole triangles; their number must be a multiple of 3",
        primitive->corner_count);
}

static enum gd_status make_primitive(struct gd__gltf_making *making, uint32_t value,
                                     const struct gd__place *place)
{
    struct primitive primitive;
    const char *at = gd__json_at(&making->gltf->json, value);
    enum gd_status status = read_primitive(making->gltf, value, &primitive);
    if (status != GD_OK || primitive.positions == GD__NO_VALUE) return status;
    status = skip_excess(making->builder, &primitive, at);
    if (status != GD_OK || triangle_count(&primitive) == 0) return status;
    struct run run = {.making = making,
                      .primitive = &primitive,
                      .at = at,
                      .is_mirrored = gd__place_mirrors(place)};
    status = provide_vertices(making, &primitive, place);
    if (status == GD_OK && primitive.indices != GD__NO_VALUE)
        status = gd__gltf_accessor_open(making->gltf, primitive.indices, false, &run.indices);
    return status == GD_OK ? add_triangles(&run) : status;
}

enum gd_status gd__gltf_make_mesh(const struct gd__gltf *gltf, uint32_t mesh,
                                  const struct gd__place *place, void *user)
{
    struct gd__gltf_making *making = user;
    uint32_t value = 0, end = 0;
    enum gd_status status = primitives_of(gltf, mesh, &value, &end);
    for (; status == GD_OK && value < end; value = gd__json_next(&gltf->json, value)) {
        status = make_primitive(making, value, place);
        if (status == GD_OK) status = look(making);
    }
    return status;
}
