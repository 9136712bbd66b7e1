#include "field/layout.h"

#include <stdlib.h>
#include <string.h>

#include "mesh/segment.h"
#include "mesh/image_header.h"

/* An image has a header, which begins with gd__image_header, and then the arrays of the field, as
 * in memory. Each array is 8-byte aligned. Their order is that of struct layout below. */

static const char magic[8] = "GDFIELD";
static const uint32_t version = 5;

/* The seeds follow the wedges, so kernels may read behind the last chunk. */
_Static_assert(sizeof(struct gd__seed) >= GD__CHUNK_SLACK, "an image has slack behind its wedges");

struct header {
    struct gd__image_header image_header;
    uint64_t wedge_bytes; /* total size of all chunks */
    uint32_t vertex_count, edge_count, seed_count, reserved;
    double reach;
    struct gd_field_statistics statistics;
};

/* Offsets of the arrays, and the size of the image. */
struct layout {
    size_t distance, predecessor, newest, wedges, seeds, size;
};

static size_t place_array(size_t *end, size_t count, size_t item)
{
    size_t begin = *end;
    *end += (count * item + 7) & ~(size_t)7;
    return begin;
}

static struct layout layout_of(size_t vertices, size_t edges, size_t wedge_bytes, size_t seeds)
{
    struct layout l;
    size_t end = sizeof(struct header);
    l.distance = place_array(&end, vertices, sizeof(double));
    l.predecessor = place_array(&end, vertices, sizeof(struct gd__predecessor));
    l.newest = place_array(&end, edges, sizeof(uint32_t));
    l.wedges = place_array(&end, wedge_bytes, 1);
    l.seeds = place_array(&end, seeds, sizeof(struct gd__seed));
    l.size = end;
    return l;
}

/* --- writing ---------------------------------------------------------------------------------- */

static struct layout layout_of_field(const struct gd_field *field)
{
    return layout_of(field->mesh->vertex_count, field->mesh->edge_count, field->wedge_bytes,
                     field->seed_count);
}

size_t gd_field_image_size(const struct gd_field *field)
{
    return layout_of_field(field).size;
}

void gd_field_write_image(const struct gd_field *field, void *bytes)
{
    const struct gd_mesh *mesh = field->mesh;
    struct layout l = layout_of_field(field);
    /* includes the padding, so that the same field gives the same bytes */
    char *image = memset(bytes, 0, l.size);
    struct header header = {.image_header = gd__image_header(mesh, magic, version),
                            .wedge_bytes = field->wedge_bytes,
                            .vertex_count = mesh->vertex_count,
                            .edge_count = mesh->edge_count,
                            .seed_count = field->seed_count,
                            .reach = field->reach,
                            .statistics = field->statistics};
    memcpy(image, &header, sizeof header);
    memcpy(image + l.distance, field->distance, mesh->vertex_count * sizeof *field->distance);
    memcpy(image + l.predecessor, field->predecessor,
           mesh->vertex_count * sizeof *field->predecessor);
    memcpy(image + l.newest, field->newest, mesh->edge_count * sizeof *field->newest);
    memcpy(image + l.wedges, field->wedges, field->wedge_bytes);
    memcpy(image + l.seeds, field->seeds, field->seed_count * sizeof *field->seeds);
}

/* --- opening ---------------------------------------------------------------------------------- */

static enum gd_status check_header(const struct gd_mesh *mesh, const struct header *header,
                                   size_t size, struct gd_detail *detail)
{
    enum gd_status status =
        gd__image_header_check(mesh, &header->image_header, magic, version, detail);
    if (status) return status;
    if (header->vertex_count != mesh->vertex_count || header->edge_count != mesh->edge_count ||
        header->wedge_bytes > size || header->wedge_bytes % GD__CHUNK_UNIT != 0 ||
        header->seed_count == 0 || header->seed_count > size / sizeof(struct gd__seed))
        return gd_fail(
            detail, GD_INDEX,
            "the counts in the field image's header do not fit the mesh; compute the field again");
    if (layout_of(header->vertex_count, header->edge_count, header->wedge_bytes, header->seed_count)
            .size != size)
        return gd_fail(detail, GD_TRUNCATED,
                       "the field image's size does not match the counts in its header; compute "
                       "the field again");
    return GD_OK;
}

/* Returns true if a source is valid: a seed, a reached vertex (from which a path continues), or
 * GD_NONE (no source). */
static bool is_source(const struct gd_field *field, uint32_t source)
{
    if (source < field->mesh->vertex_count) return field->distance[source] < GD__FAR;
    if (source == GD_NONE) return true;
    uint32_t seed = gd__field_seed_of(field, source);
    return seed < field->seed_count &&
           field->seeds[seed].is_segment == gd__source_is_linear(source);
}

static bool is_point(const struct gd_mesh *mesh, const struct gd_point *point)
{
    switch (point->kind) {
    case GD_POINT_VERTEX:
        return point->element < mesh->vertex_count;
    case GD_POINT_EDGE:
        return point->element < mesh->edge_count;
    case GD_POINT_FACE:
        return point->element < mesh->face_count;
    }
    return false;
}

static bool is_seed(const struct gd_mesh *mesh, const struct gd__seed *seed)
{
    struct gd__segment_location location;
    if (!is_point(mesh, &seed->point)) return false;
    unsigned char flag; /* a bool of the image may hold any byte */
    memcpy(&flag, &seed->is_segment, 1);
    if (flag > 1) return false;
    return !flag || (is_point(mesh, &seed->end) &&
                     gd__segment_locate(mesh, &seed->point, &seed->end, &location));
}

/* Returns true if a vertex' predecessor is valid. The predecessor of a vertex reached through a
 * face must be a side with a face. A vertex reached along an edge must be a neighbour of its
 * source. Only an unreached vertex has no predecessor. */
static bool is_predecessor(const struct gd_field *field, uint32_t vertex)
{
    const struct gd_mesh *mesh = field->mesh;
    const struct gd__predecessor *predecessor = &field->predecessor[vertex];
    if (!is_source(field, predecessor->source)) return false;
    if (predecessor->side != GD_NONE)
        return predecessor->side < 2 * mesh->edge_count &&
               !gd__side_is_boundary(mesh, predecessor->side) &&
               gd__side_apex(mesh, predecessor->side) == vertex;
    if (predecessor->source == GD_NONE) return field->distance[vertex] >= GD__FAR;
    if (predecessor->source >= mesh->vertex_count)
        return !gd__source_is_linear(predecessor->source);
    return gd__side_between(mesh, vertex, predecessor->source) != GD_NONE;
}

/* Returns true if a chunk lies within the wedges and its sources exist. Subtracts the chunk's bytes
 * from *left. */
static bool is_chunk(const struct gd_field *field, uint32_t at, uint64_t *left)
{
    uint64_t begin = (uint64_t)at * GD__CHUNK_UNIT, bytes = sizeof(struct gd__chunk);
    if (begin + bytes > field->wedge_bytes) return false;
    const struct gd__chunk *chunk = gd__field_chunk(field, at);
    if (chunk->form > GD__WEDGE_WIDE || !chunk->count) return false;
    bytes = gd__chunk_bytes(chunk);
    if (begin + bytes > field->wedge_bytes || bytes > *left) return false;
    *left -= bytes;
    struct gd__wedges wedges = gd__chunk_wedges(chunk);
    for (uint32_t i = 0; i < chunk->count; i++)
        if (!is_source(field, gd__wedge_source(&wedges, i))) return false;
    return !chunk->has_previous || gd__chunk_previous(chunk) < at;
}

/* Returns true if all chains are valid. Because all chains together must not exceed the bytes of
 * all wedges, no chain is endless. */
static bool are_chains_sound(const struct gd_field *field)
{
    uint64_t left = field->wedge_bytes;
    for (uint32_t e = 0; e < field->mesh->edge_count; e++)
        for (uint32_t at = field->newest[e]; at != GD_NONE;
             at = gd__chunk_previous(gd__field_chunk(field, at)))
            if (!is_chunk(field, at, &left)) return false;
    return true;
}

static bool are_indices_sound(const struct gd_field *field)
{
    const struct gd_mesh *mesh = field->mesh;
    for (uint32_t i = 0; i < field->seed_count; i++)
        if (!is_seed(mesh, &field->seeds[i])) return false;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        if (!is_predecessor(field, v)) return false;
    return are_chains_sound(field);
}

/* Points the field's arrays into the image. Dropping `const` is safe, because fields are
 * immutable. */
static void point_into(struct gd_field *field, const char *image, const struct header *header)
{
    struct layout l = layout_of(header->vertex_count, header->edge_count, header->wedge_bytes,
                                header->seed_count);
    field->is_image = true;
    field->reach = header->reach;
    field->seed_count = header->seed_count;
    field->statistics = header->statistics;
    field->wedge_bytes = header->wedge_bytes;
    field->distance = (double *)(image + l.distance);
    field->predecessor = (struct gd__predecessor *)(image + l.predecessor);
    field->newest = (uint32_t *)(image + l.newest);
    field->wedges = (char *)image + l.wedges;
    field->seeds = (struct gd__seed *)(image + l.seeds);
}

enum gd_status gd_field_open_image(const struct gd_mesh *mesh, const struct gd_field_image *image,
                                   struct gd_field **out, struct gd_detail *detail)
{
    struct header header;
    if (image->size < sizeof header)
        return gd_fail(detail, GD_TRUNCATED,
                       "the field image ends within its header; compute the field again");
    memcpy(&header, image->bytes, sizeof header);
    enum gd_status status = check_header(mesh, &header, image->size, detail);
    if (status) return status;
    struct gd_field *field = gd__field_create(mesh);
    if (!field) return gd_fail_status(detail, GD_NO_MEMORY);
    point_into(field, image->bytes, &header);
    status = are_indices_sound(field) ? gd__field_index_seeds(field)
                                      : gd_fail(detail, GD_INDEX,
                                                "the field image refers to elements that the mesh "
                                                "does not have; compute the field again");
    if (status) {
        gd_field_release(field);
        return status;
    }
    field->release_image = image->release;
    field->image_user = image->user;
    field->bytes = gd__field_bytes(field);
    *out = field;
    return GD_OK;
}
