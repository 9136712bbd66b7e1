/* Allocator: malloc and its relatives, mmap and mremap, which fail on order when the engine calls
 * them. The program is linked with --wrap. */
#ifndef TESTS_FAULT_ALLOCATOR_H
#define TESTS_FAULT_ALLOCATOR_H

#include <stdbool.h>
#include <stddef.h>

#include "tests/fault/stacks.h"

/* Record of failed calls, in memory that processes share. */
struct allocator_book {
    struct stacks stacks; /* call paths that have failed */
    struct stacks sites;  /* return addresses of the failed calls */
};

/* Which calls fail after allocator_arm. All zero: none. */
struct allocator_order {
    unsigned long nth; /* the nth call, from 1; 0: none by number */
    bool fresh;        /* the first call on a call path on which none has failed */
    bool lasting;      /* and all later calls */
};

void allocator_open(struct allocator_book *book);
void allocator_arm(struct allocator_order order);

/* Returns how many calls failed since allocator_arm. No later call fails. */
unsigned long allocator_disarm(void);

/* Number of blocks and of mapped bytes that are held. */
struct allocator_live {
    long blocks, mapped;
};

struct allocator_live allocator_live(void);

#endif
