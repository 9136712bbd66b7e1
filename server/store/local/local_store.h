/* Local store: SQLite and files in one folder; its inside, which opening and use share. See store.h
 * and store_files.h. */
#ifndef SERVER_STORE_LOCAL_LOCAL_STORE_H
#define SERVER_STORE_LOCAL_LOCAL_STORE_H

#include <stdatomic.h>

#include "server/store/quarantine.h"
#include "server/store/local/database.h"
#include "server/store/local/files.h"

struct server_store_local {
    struct server_store store; /* first */
    struct server_store_files files;
    /* NULL: it can't be opened or made; then nothing is written */
    struct server_database *database;
    struct server_quarantine quarantine;
    struct server_stored *found; /* given up once they were visited */
    uint32_t found_count;
    /* objects that the change under way took from a surface; empty: none */
    char left[SERVER_PARTS][SERVER_OBJECT];
    /* a row could not be mended: so the database can't tell which bytes are unused */
    bool lacks_rows;
    atomic_bool is_read_only;
    char reason[512];        /* why; written once, before is_read_only is set */
    atomic_bool was_missing; /* the folder, or a part of it, when its health was last asked for */
};

/* Nothing is written from now on; the first reason counts. */
void server_local_forbid(struct server_store_local *local, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Finds what the folder holds, mends what can be mended, collects what nothing refers to. False
 * with a sentence when a later version wrote it, or without memory. */
bool server_local_recover(struct server_store_local *local, char *error, size_t error_size);

void server_local_forget_found(struct server_store_local *local);

#endif
