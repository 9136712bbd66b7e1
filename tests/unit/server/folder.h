/* A folder of a test's own, and records for it. */
#ifndef TESTS_UNIT_SERVER_FOLDER_H
#define TESTS_UNIT_SERVER_FOLDER_H

#include "support.h"

#include <ftw.h>
#include <stdio.h>
#include <unistd.h>

#include "gd/io.h"
#include "server/disk.h"
#include "server/record.h"

#define FOLDER_PATH 256

static inline int folder_remove_one(const char *path, const struct stat *facts, int kind, struct FTW *place)
{
    (void)facts, (void)kind, (void)place;
    return remove(path);
}

static inline void folder_make(char folder[FOLDER_PATH])
{
    const char *place = getenv("TMPDIR");
    snprintf(folder, FOLDER_PATH, "%s/geodesicd-test-XXXXXX", place ? place : "/var/tmp");
    assert_non_null(mkdtemp(folder));
}

static inline void folder_remove(const char *folder)
{
    nftw(folder, folder_remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

static inline struct server_record *new_record(const char *name, const char *bytes)
{
    char sha256[SERVER_SHA256_HEX];
    server_sha256(bytes, strlen(bytes), sha256);
    struct server_record *record =
        server_record_create(name, sha256, strlen(bytes), &(struct proto_mesh_options){.format = GD_FORMAT_OBJ});
    record->description = strdup("{\"name\":\"it\"}");
    record->memory = 1234;
    return record;
}

#endif
