/* Stacks: a set of call paths that have occurred, so that a test can make each of them fail once. A
 * set lies in shared memory, so threads and processes may share it. */
#pragma once

#include <execinfo.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

enum { STACKS_SLOTS = 1 << 16, STACKS_DEPTH = 24 };

/* If all members are zero, the set is empty. */
struct stacks {
    _Atomic uint32_t count;
    _Atomic uint64_t keys[STACKS_SLOTS];
};

/* Adds a key and returns whether the key was new. A full set regards all keys as known. */
static inline bool stacks_add(struct stacks *stacks, uint64_t key)
{
    key += !key;
    for (uint32_t i = 0; i < STACKS_SLOTS; i++) {
        uint64_t there = 0;
        _Atomic uint64_t *slot = &stacks->keys[(key + i) % STACKS_SLOTS];
        if (atomic_compare_exchange_strong(slot, &there, key)) {
            atomic_fetch_add(&stacks->count, 1);
            return true;
        }
        if (there == key) return false;
    }
    return false;
}

static inline bool stacks_has(struct stacks *stacks, uint64_t key)
{
    key += !key;
    for (uint32_t i = 0; i < STACKS_SLOTS; i++) {
        uint64_t there = atomic_load(&stacks->keys[(key + i) % STACKS_SLOTS]);
        if (!there || there == key) return there == key;
    }
    return false;
}

/* Returns a hash of the return addresses, beginning with the caller's caller. The first call in a
 * process allocates memory. */
static inline uint64_t stacks_here(void)
{
    void *frames[STACKS_DEPTH];
    int count = backtrace(frames, STACKS_DEPTH);
    uint64_t key = 0xcbf29ce484222325u;
    for (int i = 2; i < count; i++) {
        key = (key ^ (uintptr_t)frames[i]) * 0x100000001b3u;
        key ^= key >> 29;
    }
    return key;
}
