/* Operations: one call of the engine each, over inputs made beforehand, for the sweep of failing
 * allocations (alloc_engine.c). */
#ifndef TESTS_FAULT_OPERATIONS_H
#define TESTS_FAULT_OPERATIONS_H

#include <stddef.h>
#include <stdint.h>

#include "gd/status.h"

struct gd_path;
struct gd_curve;
struct gd_mesh;

#define COUNT(array) ((uint32_t)(sizeof(array) / sizeof *(array)))

/* FNV-1a of what an answer says. */
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
    size_t size; /* of the outputs, which lie together */
    void (*digest)(struct digest *digest, const void *out);
    void (*discard)(void *out); /* NULL: it holds nothing */
};

struct operation {
    const char *name;
    const struct answer *answer;
    enum gd_status (*run)(void *out);
    enum gd_status status; /* what comes of it when nothing fails */
    /* gives back what the call may leave behind for the next; NULL: nothing */
    void (*settle)(void);
};

/* `open` makes the inputs, which live as long as the program. */
struct operations {
    void (*open)(void);
    const struct operation *items;
    uint32_t count;
};

extern const struct operations file_operations, mesh_operations, field_operations, query_operations,
    curve_operations, line_operations, parametric_operations, limit_operations, json_operations,
    picture_operations;

#endif
