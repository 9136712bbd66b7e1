/* Operations: each is one call of the engine on prepared inputs, for the sweep of failing
 * allocations (alloc_engine.c). */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "gd/status.h"

struct gd_path;
struct gd_curve;
struct gd_mesh;

#define COUNT(array) ((uint32_t)(sizeof(array) / sizeof *(array)))

/* FNV-1a digest of an answer's contents. */
struct digest {
    uint64_t value;
};

void digest_bytes(struct digest *digest, const void *bytes, size_t size);
void digest_number(struct digest *digest, double number);
void digest_path(struct digest *digest, const struct gd_path *path);
void digest_curve(struct digest *digest, const struct gd_curve *curve);
void digest_mesh(struct digest *digest, const struct gd_mesh *mesh);

/* A kind of answer. */
struct answer {
    size_t size; /* size of the outputs, which are contiguous */
    void (*digest)(struct digest *digest, const void *out);
    void (*discard)(void *out); /* NULL if the answer holds no memory */
};

struct operation {
    const char *name;
    const struct answer *answer;
    enum gd_status (*run)(void *out);
    enum gd_status status; /* the status that `run` returns if no allocation fails */
    /* frees the memory that the call may keep for the next call; NULL if the call keeps no
       memory */
    void (*settle)(void);
};

/* A list of operations. `open` makes their inputs, which exist until the program ends. */
struct operations {
    void (*open)(void);
    const struct operation *items;
    uint32_t count;
};

extern const struct operations file_operations, mesh_operations, field_operations, query_operations,
    curve_operations, line_operations, parametric_operations, limit_operations, json_operations,
    picture_operations, edit_operations;
