/* Allocator: replaces malloc and its relatives, mmap and mremap by functions that fail on order
 * when the engine calls them. The program is linked with --wrap. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "tests/fault/stacks.h"

/* Record of failed calls, in memory that processes share. */
struct allocator_book {
    struct stacks stacks; /* call paths that have failed */
    struct stacks sites;  /* return addresses of the failed calls */
};

/* Selects the calls that fail after allocator_arm. If all members are zero, no call fails. */
struct allocator_order {
    unsigned long nth; /* the number of the call that fails, from 1; 0 selects no call by number */
    bool fresh;        /* makes the first call fail whose call path has not failed yet */
    bool lasting;      /* also makes all later calls fail */
    /* if `fresh`, two sorts of new call paths fail: every step-th one, and each one whose call site
     * has not failed yet; 0 means 1 */
    uint32_t step;
};

void allocator_open(struct allocator_book *book);
void allocator_arm(struct allocator_order order);

/* Returns how many calls failed since allocator_arm. No later call fails. */
unsigned long allocator_disarm(void);

/* The numbers of held blocks and of mapped bytes. */
struct allocator_live {
    long blocks, mapped;
};

struct allocator_live allocator_live(void);
