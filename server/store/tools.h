/* Store tools: what an operator does with a data folder: check it, copy it. */
#ifndef SERVER_STORE_TOOLS_H
#define SERVER_STORE_TOOLS_H

#include <stdbool.h>
#include <stdio.h>

/* Reads every row, manifest, object, stored field and batch of a data folder that no daemon uses,
 * and prints what it finds to `out`: a line a fault, a line for each kind of thing that the next
 * start will tidy up, and the sums. Makes and changes nothing, but for what SQLite itself keeps
 * beside a database whose daemon was killed (-shm). False: there are faults, there is no data
 * folder, or it can't be checked. */
bool server_store_check(const char *folder, FILE *out);

/* The same of a PostgreSQL store, in use or not: every row, and every object that one names. */
bool server_store_check_postgres(const char *url, FILE *out);

/* Makes a complete data folder `copy`, which must not hold one, of `folder` as it is at one moment,
 * whether a daemon is using it or not. Objects become links where the file system can, since they
 * never change; each is verified. False with a sentence on `out`. */
bool server_store_backup(const char *folder, const char *copy, FILE *out);

/* The way back: makes the data folder `folder`, which must not hold one, of a backup, every file of
 * which is verified. Objects are copied: what becomes of the blocks of one folder later must not
 * harm the other. False with a sentence on `out`. */
bool server_store_restore(const char *folder, const char *backup, FILE *out);

#endif
