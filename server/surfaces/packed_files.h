/* Packed files: compressed (gzip) forms of mesh files, cached in memory.
 *
 *     file = server_packed_files_find(files, tag);
 *     if (!file) ... compress; file = server_packed_files_add(files, tag, bytes, size);
 *     ... send file->bytes; server_packed_file_release(file);
 *
 * DESIGN. Compressing a mesh file takes about six times as long as writing it, and the result never
 * changes: the key is the ETag of the file. A file counts as SERVER_BUDGET_PACKED until the last
 * answer that sends it has ended. The cache takes only free memory, at most one 16th of the budget.
 * It is the first cache to be emptied when memory is short, beginning with the least recently used
 * file (lru.h). All functions are thread-safe. */
#ifndef SERVER_SURFACES_PACKED_FILES_H
#define SERVER_SURFACES_PACKED_FILES_H

#include "server/exchange/etag.h"
#include "server/fields/lru.h"

/* size in bytes; smaller files are not cached, but compressed for each answer */
#define SERVER_PACKED_FROM ((size_t)64 << 10)
#define SERVER_PACKED_PART 16 /* the cache may hold 1/16 of the budget */

struct server_packed_file {
    struct server_lru_item item;   /* must be the first member */
    struct server_lru_item *place; /* the file itself while it is in the list */
    char tag[SERVER_ETAG_TEXT];
    char *bytes;
    size_t size;
};

struct server_packed_files;

/* Creates a cache, which registers as a reclaimer of the budget. Returns NULL if out of memory. */
struct server_packed_files *server_packed_files_create(struct server_budget *budget);
void server_packed_files_destroy(struct server_packed_files *files); /* NULL is allowed */

/* Returns the file with that tag, which the caller releases, or NULL if the file is not cached. */
struct server_packed_file *server_packed_files_find(struct server_packed_files *files,
                                                    const char *tag);

/* Takes ownership of the bytes, allocated by malloc, as the file with that tag. Returns a reference
 * to the file. If memory is short or the file is too large, returns NULL; the caller still owns the
 * bytes. */
struct server_packed_file *server_packed_files_add(struct server_packed_files *files,
                                                   const char *tag, char *bytes, size_t size);

void server_packed_file_release(struct server_packed_file *file); /* NULL is allowed */

#endif
