/* Runs parts of a test in a child process. */
#pragma once

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* Exit statuses of a child. */
enum { FINE, WRONG = 10, SKIPPED = 77 };

/* Ends the child. Its parent skips the test, and the reason is printed. */
#define SKIP_CHILD(reason)                                                                         \
    do {                                                                                           \
        fputs("# skipped: " reason "\n", stderr); /* unbuffered */                                 \
        _exit(SKIPPED);                                                                            \
    } while (0)

/* Ends the child with a message that names the line, unless `holds` is true. */
#define INSIST(holds)                                                                              \
    do {                                                                                           \
        if (!(holds)) {                                                                            \
            fprintf(stderr, "line %d does not hold (%s)\n", __LINE__, strerror(errno));            \
            _exit(WRONG);                                                                          \
        }                                                                                          \
    } while (0)
