/* Landlock: the part of the sandbox that is about files and ports. See sandbox.h for what is
 * allowed. */
#ifndef SERVER_ACCESS_LANDLOCK_H
#define SERVER_ACCESS_LANDLOCK_H

struct server_config;

/* Restricts the calling thread and those that it will start, for good. Makes the data folder first.
 * NULL: done; else why not, a sentence: nothing is restricted then. */
const char *server_landlock_enter(const struct server_config *config);

#endif
