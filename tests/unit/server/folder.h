/* A folder for one test. */
#pragma once

#include "records.h"

#include <ftw.h>
#include <stdio.h>
#include <unistd.h>

#include "server/base/disk.h"

#define FOLDER_PATH 256

static inline int folder_remove_one(const char *path, const struct stat *facts, int kind,
                                    struct FTW *place)
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

/* Calls a function for each file. Returns false if the folder can't be read. */
static inline bool folder_each(const char *folder,
                               void (*visit)(void *user, const char *path, const char *name),
                               void *user)
{
    struct server_listing listing = server_disk_list(folder);
    while (server_listing_next(&listing)) visit(user, listing.path, listing.name);
    return listing.is_readable;
}
