/* Reads a 3MF package, a zip archive with model parts in XML. Places the objects as the package's
 * list of build items specifies. See 3mf.h. */
#include "io/3mf.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "io/readers.h"

#define DEPTH         64   /* largest depth of nested components */
#define LOOK_ELEMENTS 8192 /* number of vertices and triangles between two checks of the control */
#define DEFAULT_MODEL "3D/3dmodel.model"

bool gd__3mf_recognise(struct gd__scan scan)
{
    return scan.end - scan.begin >= 4 && memcmp(scan.begin, "PK\3\4", 4) == 0;
}

/* --- parts ------------------------------------------------------------------------------------ */

bool gd__3mf_grow(void **array, uint32_t count, uint32_t *capacity, size_t item)
{
    if (count < *capacity) return true;
    uint32_t more = count < 64 ? 64 : count + count / 2;
    void *grown = realloc(*array, more * item);
    if (!grown) return false;
    *array = grown;
    *capacity = more;
    return true;
}

enum gd_status gd__3mf_name_part(struct gd__3mf *package, const char *name, uint32_t *out)
{
    struct gd__3mf_part part = {.unit = 1};
    name += *name == '/';
    if (strlen(name) >= sizeof part.name) return GD_UNSUPPORTED;
    strcpy(part.name, name);
    for (*out = 0; *out < package->part_count; ++*out)
        if (strcasecmp(package->parts[*out].name, name) == 0) return GD_OK;
    if (package->part_count == GD__3MF_PARTS) return GD_UNSUPPORTED;
    if (!gd__3mf_grow((void **)&package->parts, package->part_count, &package->part_capacity,
                      sizeof part))
        return GD_NO_MEMORY;
    package->parts[package->part_count++] = part;
    return GD_OK;
}

/* Reads the main model part that the package names, and the parts that it refers to. */
static enum gd_status read_parts(struct gd__3mf *package)
{
    char model[GD__3MF_PATH] = DEFAULT_MODEL;
    uint32_t first;
    enum gd_status status = gd__3mf_find_model(package, model);
    if (status == GD_OK) status = gd__3mf_name_part(package, model, &first);
    if (status == GD_NO_MEMORY) return gd_fail_status(package->detail, status);
    for (uint32_t part = 0; status == GD_OK && part < package->part_count; part++)
        status = gd__3mf_read_model(package, part);
    return status;
}

/* --- objects ---------------------------------------------------------------------------------- */

static int compare_ids(uint32_t a_part, uint32_t a, uint32_t b_part, uint32_t b)
{
    if (a_part != b_part) return a_part < b_part ? -1 : 1;
    return a < b ? -1 : a > b;
}

static int compare_objects(const void *a, const void *b, void *package)
{
    const struct gd__3mf_object *objects = ((const struct gd__3mf *)package)->objects,
                                *x = &objects[*(const uint32_t *)a],
                                *y = &objects[*(const uint32_t *)b];
    return compare_ids(x->part, x->id, y->part, y->id);
}

/* Returns the object with that id, or GD_NONE if there is none. `order` lists the objects, sorted
 * by part and id. */
static uint32_t find_object(const struct gd__3mf *package, const uint32_t *order, uint32_t part,
                            uint32_t id)
{
    uint32_t low = 0, high = package->object_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        const struct gd__3mf_object *object = &package->objects[order[middle]];
        int comparison = compare_ids(object->part, object->id, part, id);
        if (comparison == 0) return order[middle];
        if (comparison < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return GD_NONE;
}

static enum gd_status link_uses(struct gd__3mf *package, uint32_t *order)
{
    for (uint32_t i = 0; i < package->object_count; i++) order[i] = i;
    qsort_r(order, package->object_count, sizeof *order, compare_objects, package);
    for (uint32_t i = 1; i < package->object_count; i++) {
        if (compare_objects(&order[i - 1], &order[i], package) == 0)
            return gd_fail(package->detail, GD_SYNTAX,
                           "object %u is defined twice; give each object its own id",
                           package->objects[order[i]].id);
    }
    for (uint32_t i = 0; i < package->use_count; i++) {
        struct gd__3mf_use *use = &package->uses[i];
        use->object = find_object(package, order, use->part, use->id);
        if (use->object == GD_NONE)
            return gd_fail(package->detail, GD_SYNTAX,
                           "a component or item refers to object %u, which the file does not "
                           "define; define it, or remove this element",
                           use->id);
    }
    return GD_OK;
}

static uint64_t saturated(uint64_t sum)
{
    return sum < UINT32_MAX ? sum : UINT32_MAX;
}

/* Computes the number of vertices and triangles of object i with its components. Each component is
 * an earlier object of the same part, or an object of another part. */
static enum gd_status add_up(struct gd__3mf *package, uint32_t i)
{
    struct gd__3mf_object *object = &package->objects[i];
    object->vertices = object->vertex_count;
    object->triangles = object->triangle_count;
    for (uint32_t u = object->first_use; u < object->first_use + object->use_count; u++) {
        uint32_t other = package->uses[u].object;
        if (package->objects[other].part == object->part && other >= i)
            return gd_fail(
                package->detail, GD_SYNTAX,
                "object %u has a component that is not defined before it; reorder the objects",
                object->id);
        object->vertices = saturated(object->vertices + package->objects[other].vertices);
        object->triangles = saturated(object->triangles + package->objects[other].triangles);
    }
    if (object->is_left_out || object->triangles == 0) object->vertices = object->triangles = 0;
    return GD_OK;
}

/* Computes the numbers of vertices and triangles of all objects. Handles the first part last,
 * because only its objects may refer to other parts. */
static enum gd_status add_up_all(struct gd__3mf *package)
{
    enum gd_status status = GD_OK;
    for (int is_first = 0; is_first < 2; is_first++) {
        for (uint32_t i = 0; i < package->object_count && status == GD_OK; i++)
            if ((package->objects[i].part == 0) == is_first) status = add_up(package, i);
    }
    return status;
}

/* Numbers of vertices and triangles of all items of the build. */
struct sum {
    uint64_t vertices, triangles;
};

static enum gd_status survey(struct gd__3mf *package, struct sum *out)
{
    uint32_t *order = malloc((package->object_count + (size_t)1) * sizeof *order);
    if (!order) return gd_fail_status(package->detail, GD_NO_MEMORY);
    enum gd_status status = link_uses(package, order);
    free(order);
    if (status == GD_OK) status = add_up_all(package);
    *out = (struct sum){0, 0};
    for (uint32_t i = 0; i < package->item_count && status == GD_OK; i++) {
        uint32_t object = package->uses[package->first_item + i].object;
        out->vertices += package->objects[object].vertices;
        out->triangles += package->objects[object].triangles;
    }
    return status;
}

static enum gd_status check_sum(const struct gd__3mf *package, const struct sum *sum)
{
    if (sum->triangles == 0)
        return gd_fail(package->detail, GD_EMPTY,
                       "the build has %u items, but none of them contains a triangle",
                       package->item_count);
    if (sum->triangles > package->limits.max_faces)
        return gd_fail(package->detail, GD_TOO_LARGE,
                       "the build has more than the configured maximum of %u triangles",
                       package->limits.max_faces);
    if (sum->vertices > package->limits.max_vertices)
        return gd_fail(package->detail, GD_TOO_LARGE,
                       "the build has more than the configured maximum of %u vertices",
                       package->limits.max_vertices);
    return GD_OK;
}

/* --- the build -------------------------------------------------------------------------------- */

/* An object that is being placed: its next component, the end of its components, its part and its
 * transform. */
struct step {
    uint32_t use, end;
    uint32_t part;
    struct gd__place place;
};

struct placing {
    const struct gd__3mf *package;
    struct gd__builder *builder;
    struct step steps[DEPTH];
    unsigned depth;
    uint64_t done, all; /* placed and total numbers of vertices and triangles, for the progress */
};

static enum gd_status look(struct placing *placing)
{
    if (placing->done++ % LOOK_ELEMENTS != 0) return GD_OK;
    return gd_control_check(placing->package->limits.control,
                            (double)placing->done / (double)(placing->all + 1));
}

static enum gd_status place_mesh(struct placing *placing, const struct gd__3mf_object *object,
                                 const struct gd__place *place)
{
    const struct gd__3mf *package = placing->package;
    struct gd__builder *builder = placing->builder;
    const char *at = builder->scan->at;
    uint64_t base = builder->position_count;
    bool is_mirrored = gd__place_mirrors(place);
    enum gd_status status = GD_OK;
    for (uint32_t v = 0; v < object->vertex_count && status == GD_OK; v++) {
        double xyz[3];
        gd__place_apply(place, package->positions[object->first_vertex + v], xyz);
        status = gd__builder_add_position(builder, xyz, at);
        if (status == GD_OK) status = look(placing);
    }
    for (uint32_t t = 0; t < object->triangle_count && status == GD_OK; t++) {
        const uint32_t *corners = package->triangles[object->first_triangle + t];
        for (int k = 0; k < 3 && status == GD_OK; k++)
            status =
                gd__builder_add_corner(builder, base + corners[is_mirrored && k ? 3 - k : k], at);
        if (status == GD_OK) status = gd__builder_close_polygon(builder, at);
        if (status == GD_OK) status = look(placing);
    }
    return status;
}

/* Places the object of `use`, a reference in `part`; `outer` is the transform of the referring
 * object. */
static enum gd_status enter(struct placing *placing, const struct gd__3mf_use *use, uint32_t part,
                            const struct gd__place *outer)
{
    const struct gd__3mf *package = placing->package;
    const struct gd__3mf_object *object = &package->objects[use->object];
    if (object->triangles == 0) return GD_OK;
    struct gd__place place = gd__place_compose(outer, &use->place);
    double scale = package->parts[object->part].unit / package->parts[part].unit;
    for (int i = 0; i < 9; i++) place.columns[i / 3][i % 3] *= scale;
    enum gd_status status = place_mesh(placing, object, &place);
    if (status != GD_OK || object->use_count == 0) return status;
    if (placing->depth == DEPTH)
        return gd_fail(package->detail, GD_UNSUPPORTED,
                       "components are nested more than %d deep; flatten them", DEPTH);
    placing->steps[placing->depth++] = (struct step){
        object->first_use, object->first_use + object->use_count, object->part, place};
    return GD_OK;
}

static enum gd_status place_item(struct placing *placing, const struct gd__3mf_use *item)
{
    enum gd_status status = enter(placing, item, 0, &gd__unmoved);
    while (status == GD_OK && placing->depth > 0) {
        struct step *step = &placing->steps[placing->depth - 1];
        if (step->use == step->end)
            placing->depth--;
        else
            status = enter(placing, &placing->package->uses[step->use++], step->part, &step->place);
    }
    return status;
}

static enum gd_status place_build(struct gd__3mf *package, struct gd__builder *builder,
                                  const struct sum *sum)
{
    struct placing placing = {
        .package = package, .builder = builder, .all = sum->vertices + sum->triangles};
    enum gd_status status = gd__builder_reserve(builder, sum->vertices, sum->triangles);
    for (uint32_t i = 0; i < package->item_count && status == GD_OK; i++)
        status = place_item(&placing, &package->uses[package->first_item + i]);
    return status;
}

/* --- reading ---------------------------------------------------------------------------------- */

/* The caller must close `out` even after a failure. */
static enum gd_status open_package(const struct gd__scan *scan,
                                   const struct gd_read_options *limits, bool is_counting,
                                   struct gd__3mf *out)
{
    size_t size = (size_t)(scan->end - scan->begin);
    *out = (struct gd__3mf){.detail = scan->detail,
                            .limits = *limits,
                            .zip = gd__zip_open(scan->begin, size),
                            .size = size,
                            .is_counting = is_counting};
    if (!out->zip)
        return gd_fail(scan->detail, GD_SYNTAX,
                       "the archive is damaged or truncated: its directory can't be read; send the "
                       "file again");
    return read_parts(out);
}

static void close_package(struct gd__3mf *package)
{
    gd__zip_close(package->zip);
    free(package->parts);
    free(package->objects);
    free(package->uses);
    free(package->positions);
    free(package->triangles);
}

enum gd_status gd__3mf_read(struct gd__scan *scan, struct gd__builder *builder)
{
    struct gd__3mf package;
    struct sum sum;
    scan->by_byte = true;
    scan->at = scan->begin;
    builder->next_look = scan->end; /* place_build checks the control itself */
    enum gd_status status = open_package(scan, &builder->limits, false, &package);
    if (status == GD_OK) status = survey(&package, &sum);
    if (status == GD_OK) status = check_sum(&package, &sum);
    if (status == GD_OK) status = place_build(&package, builder, &sum);
    close_package(&package);
    return status;
}

/* Memory of the tables, the parser and the inflater. */
#define TABLE_BYTES (GD__3MF_XML_BYTES + ((size_t)16 << 20))
/* Arrays grow by half. While an array is copied, the old and the new array together take up to 2.5
 * times the old size. */
#define GROWTH 2.5

size_t gd__3mf_cost(const void *bytes, size_t size, const struct gd_read_options *options)
{
    struct gd__scan scan = gd__scan_begin(bytes, size, NULL);
    struct gd_read_options limits = options ? *options : (struct gd_read_options){0};
    if (!limits.max_faces) limits.max_faces = UINT32_MAX;
    if (!limits.max_vertices) limits.max_vertices = UINT32_MAX;
    struct gd__3mf package;
    struct sum sum = {0, 0};
    enum gd_status status = open_package(&scan, &limits, true, &package);
    if (status == GD_OK) status = survey(&package, &sum);
    if (status == GD_OK) status = check_sum(&package, &sum);
    if (status != GD_OK) sum = (struct sum){0, 0};
    double kept = GROWTH * (package.vertex_count * (double)sizeof *package.positions +
                            package.triangle_count * (double)sizeof *package.triangles);
    uint64_t placed =
        sum.vertices * sizeof *package.positions + sum.triangles * sizeof *package.triangles;
    close_package(&package);
    return TABLE_BYTES + size + (size_t)kept + placed;
}
