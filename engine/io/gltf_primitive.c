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
static void refuse_draco(struct gd__gltf *gltf, const struct primitive *primitive)
{
    uint32_t extensions = gd__json_member(&gltf->json, primitive->value, "extensions");
    if (extensions != GD__NO_VALUE &&
        gd__json_member(&gltf->json, extensions, "KHR_draco_mesh_compression") != GD__NO_VALUE &&
        gd__json_member(&gltf->json, primitive->positions, "bufferView") == GD__NO_VALUE)
        gd__gltf_fail(gltf, primitive->value, GD_UNSUPPORTED,
                      "the primitive is compressed by Draco: store the file without compression");
}

/* Reads a primitive. `positions` of the result is GD__NO_VALUE if it has no triangles. */
static struct primitive read_primitive(struct gd__gltf *gltf, uint32_t value)
{
    struct primitive out = {.value = value, .positions = GD__NO_VALUE, .indices = GD__NO_VALUE};
    uint64_t mode = gd__gltf_whole(gltf, value, "mode", MODE_TRIANGLES, MODE_FAN);
    uint32_t attributes = gd__json_member(&gltf->json, value, "attributes");
    if (mode < MODE_TRIANGLES || attributes == GD__NO_VALUE) return out;
    out.mode = (enum mode)mode;
    out.positions = gd__gltf_reference(gltf, attributes, "POSITION", &gltf->accessors);
    if (out.positions == GD__NO_VALUE) return out;
    refuse_draco(gltf, &out);
    out.indices = gd__gltf_reference(gltf, value, "indices", &gltf->accessors);
    out.vertex_count = out.corner_count = gd__gltf_accessor_count(gltf, out.positions);
    if (out.indices != GD__NO_VALUE) out.corner_count = gd__gltf_accessor_count(gltf, out.indices);
    return out;
}

/* Returns the list of primitives of a mesh. */
static struct gd__gltf_items primitives_of(struct gd__gltf *gltf, uint32_t mesh)
{
    uint32_t list = gd__json_member(&gltf->json, mesh, "primitives");
    if (list != GD__NO_VALUE && gd__json_is(&gltf->json, list, '['))
        return (struct gd__gltf_items){list + 1, gd__json_next(&gltf->json, list)};
    gd__gltf_fail(gltf, mesh, GD_SYNTAX, "the mesh has no array of 'primitives'");
    return (struct gd__gltf_items){0};
}

static void add_up(struct gd__gltf *gltf, uint32_t value, struct gd__gltf_sum *sum)
{
    struct primitive primitive = read_primitive(gltf, value);
    if (gltf->status) return;
    if (++sum->primitives > MOST_PRIMITIVES)
        gd__gltf_fail(gltf, value, GD_TOO_LARGE, "the scene has more than %llu primitives",
                      (unsigned long long)MOST_PRIMITIVES);
    uint64_t triangles = primitive.positions == GD__NO_VALUE ? 0 : triangle_count(&primitive);
    if (primitive.positions == GD__NO_VALUE) sum->skipped++;
    if (triangles > 0 && primitive.vertex_count > sum->largest)
        sum->largest = primitive.vertex_count;
    sum->triangles += triangles;
    if (triangles > 0) sum->vertices += primitive.vertex_count;
}

void gd__gltf_count_mesh(struct gd__gltf *gltf, uint32_t mesh, const struct gd__place *place,
                         void *user)
{
    struct gd__gltf_sum *sum = user;
    struct gd__gltf_items items = primitives_of(gltf, mesh);
    (void)place;
    for (uint32_t value = items.begin; value < items.end && !gltf->status;
         value = gd__json_next(&gltf->json, value)) {
        add_up(gltf, value, sum);
        if (!gltf->status && sum->primitives % 64 == 0)
            gltf->status = gd_control_check(gltf->control, 0);
    }
}

/* --- vertices --------------------------------------------------------------------------------- */

/* Checks the control after every LOOK_ELEMENTS elements. Returns the reader's status. */
static enum gd_status look(struct gd__gltf_making *making)
{
    struct gd__gltf *gltf = making->gltf;
    if (gltf->status || making->done++ % LOOK_ELEMENTS != 0) return gltf->status;
    double fraction = (double)making->done / (double)making->all;
    making->builder->done = fraction < 1 ? fraction : 1;
    return gltf->status = gd_control_check(gltf->control, making->builder->done);
}

static void add_vertices(struct gd__gltf_making *making, const struct primitive *primitive,
                         const struct gd__place *place)
{
    struct gd__gltf *gltf = making->gltf;
    const char *at = gd__json_at(&gltf->json, primitive->positions);
    struct gd__gltf_accessor accessor = gd__gltf_accessor_open(gltf, primitive->positions, true);
    for (uint32_t i = 0; !gltf->status && i < primitive->vertex_count; i++) {
        double local[3], xyz[3];
        gd__gltf_accessor_next(&accessor, local);
        if (gltf->status) break;
        gd__place_apply(place, local, xyz);
        gltf->status = gd__weld_vertex(&making->weld, xyz, at, &making->vertices[i]);
        (void)look(making);
    }
}

/* Adds the vertices of a primitive, unless the previous primitive has the same vertices. Primitives
 * with different materials often share an accessor. */
static void provide_vertices(struct gd__gltf_making *making, const struct primitive *primitive,
                             const struct gd__place *place)
{
    if (making->accessor == primitive->positions &&
        memcmp(&making->place, place, sizeof *place) == 0)
        return;
    add_vertices(making, primitive, place);
    making->accessor = primitive->positions;
    making->place = *place;
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

static uint32_t next_corner(struct run *run, uint32_t number)
{
    struct gd__gltf *gltf = run->making->gltf;
    double index[3] = {number};
    if (run->primitive->indices != GD__NO_VALUE) gd__gltf_accessor_next(&run->indices, index);
    if (index[0] >= run->primitive->vertex_count)
        gd__gltf_fail(
            gltf, run->primitive->value, GD_INDEX,
            "corner %u refers to vertex %.0f of the primitive, which has only %u vertices", number,
            index[0], run->primitive->vertex_count);
    return look(run->making) ? 0 : (uint32_t)index[0];
}

static enum gd_status add_triangle(struct run *run, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t corners[3] = {a, run->is_mirrored ? c : b, run->is_mirrored ? b : c};
    struct gd__builder *builder = run->making->builder;
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3 && !status; k++)
        status = gd__builder_add_corner(builder, run->making->vertices[corners[k]], run->at);
    return status ? status : gd__builder_close_polygon(builder, run->at);
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

static void add_triangles(struct run *run)
{
    enum gd_status *status = &run->making->gltf->status;
    for (uint32_t number = 0; number < run->primitive->corner_count && !*status; number++) {
        uint32_t corner = next_corner(run, number);
        if (*status) return;
        shift(run, number, corner);
        if (run->primitive->mode == MODE_TRIANGLES) {
            if (number % 3 == 2)
                *status = add_triangle(run, run->recent[0], run->recent[1], run->recent[2]);
        } else if (number >= 2) {
            *status = add_linked(run, number);
        }
    }
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

static void make_primitive(struct gd__gltf_making *making, uint32_t value,
                           const struct gd__place *place)
{
    struct gd__gltf *gltf = making->gltf;
    const char *at = gd__json_at(&gltf->json, value);
    struct primitive primitive = read_primitive(gltf, value);
    if (gltf->status || primitive.positions == GD__NO_VALUE) return;
    gltf->status = skip_excess(making->builder, &primitive, at);
    if (gltf->status || triangle_count(&primitive) == 0) return;
    struct run run = {.making = making,
                      .primitive = &primitive,
                      .at = at,
                      .is_mirrored = gd__place_mirrors(place)};
    provide_vertices(making, &primitive, place);
    if (primitive.indices != GD__NO_VALUE && !gltf->status)
        run.indices = gd__gltf_accessor_open(gltf, primitive.indices, false);
    add_triangles(&run);
}

void gd__gltf_make_mesh(struct gd__gltf *gltf, uint32_t mesh, const struct gd__place *place,
                        void *user)
{
    struct gd__gltf_making *making = user;
    struct gd__gltf_items items = primitives_of(gltf, mesh);
    for (uint32_t value = items.begin; value < items.end && !gltf->status;
         value = gd__json_next(&gltf->json, value)) {
        make_primitive(making, value, place);
        (void)look(making);
    }
}
