/* What a test tries in a child process: what it ends with, and how it ends early. */
#ifndef TESTS_UNIT_SERVER_CHILD_H
#define TESTS_UNIT_SERVER_CHILD_H

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* What a child ends with. */
enum { FINE, WRONG = 10, SKIPPED = 77 };

/* Ends the child, naming the line, unless it holds. */
#define INSIST(holds)                                                                              \
    do {                                                                                           \
        if (!(holds)) {                                                                            \
            fprintf(stderr, "line %d does not hold (%s)\n", __LINE__, strerror(errno));            \
            _exit(WRONG);                                                                          \
        }                                                                                          \
    } while (0)

#endif
