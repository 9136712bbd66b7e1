#include "mesh/image_header.h"

#include <string.h>

static const uint32_t byte_order = 0x01020304;

static uint64_t image_header_mix(uint64_t hash, const void *bytes, size_t words)
{
    for (size_t i = 0; i < words; i++) {
        uint64_t word;
        memcpy(&word, (const char *)bytes + 8 * i, 8);
        hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
    }
    return hash;
}

/* Returns a hash of the positions and of the sides' origins. Meshes whose elements have different
 * numbers or positions have different hashes. */
static uint64_t fingerprint_of(const struct gd_mesh *mesh)
{
    uint64_t counts[3] = {mesh->vertex_count, mesh->face_count, mesh->edge_count};
    uint64_t hash = image_header_mix(image_header_mix(0, counts, 3), &mesh->unit, 1);
    hash = image_header_mix(hash, mesh->position, 3 * (size_t)mesh->vertex_count);
    /* two origins of 4 bytes per edge */
    return image_header_mix(hash, mesh->origin, mesh->edge_count);
}

struct gd__image_header gd__image_header(const struct gd_mesh *mesh, const char magic[8],
                                         uint32_t version)
{
    struct gd__image_header image_header = {
        .version = version, .byte_order = byte_order, .fingerprint = fingerprint_of(mesh)};
    memcpy(image_header.magic, magic, sizeof image_header.magic);
    return image_header;
}

enum gd_status gd__image_header_check(const struct gd_mesh *mesh,
                                      const struct gd__image_header *image_header,
                                      const char magic[8], uint32_t version,
                                      struct gd_detail *detail)
{
    if (memcmp(image_header->magic, magic, sizeof image_header->magic) != 0 ||
        image_header->byte_order != byte_order)
        return gd_fail(detail, GD_UNRECOGNIZED,
                       "the bytes are not a %s image that this machine can read; write the image "
                       "again on this machine",
                       magic);
    if (image_header->version != version)
        return gd_fail(
            detail, GD_UNRECOGNIZED,
            "the image has version %u, but this program reads version %u; write the image again",
            image_header->version, version);
    if (image_header->fingerprint != fingerprint_of(mesh))
        return gd_fail(
            detail, GD_INVALID_ARGUMENT,
            "the image was written for another mesh; pass the mesh for which it was written");
    return GD_OK;
}
