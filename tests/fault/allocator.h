/* Allocator: malloc and its kin, mmap and mremap as the engine calls them, which fail on order. The
 * program is linked with --wrap. */
#ifndef TESTS_FAULT_ALLOCATOR_H
#define TESTS_FAULT_ALLOCATOR_H

#include <stdbool.h>
#include <stddef.h>

#include "tests/fault/stacks.h"

/* What is known of the calls; in memory that processes share. */
struct allocator_book {
    struct stacks stacks; /* ways of calling that have failed */
    struct stacks sites;  /* the calls themselves: return addresses */
};

/* Which calls fail from the time of arming on. All zero: none. */
struct allocator_order {
    unsigned long nth; /* the nth, from 1 on; 0: none by number */
    bool fresh;        /* the first that comes by a way by which none has failed */
    bool lasting;      /* and all that follow it */
};

void allocator_open(struct allocator_book *book);
void allocator_arm(struct allocator_order order);

/* How many calls failed since allocator_arm; from now on none does. */
unsigned long allocator_disarm(void);

/* Blocks and mapped bytes that are held. */
struct allocator_live {
    long blocks, mapped;
};

struct allocator_live allocator_live(void);

#endif
