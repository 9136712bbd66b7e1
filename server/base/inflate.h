/* Inflate: what packed bytes unpack to, as they come, within a ratio: a small body that unpacks to
 * a huge one is an attack (a zip bomb). Gzip, RFC 1952, of one member or several. */
#ifndef SERVER_BASE_INFLATE_H
#define SERVER_BASE_INFLATE_H

#include <stdbool.h>
#include <stddef.h>

#define SERVER_INFLATE_BYTES ((size_t)48 << 10) /* that an inflater holds */
/* most times its size that a body unpacks to, past the first mebibyte */
#define SERVER_INFLATE_RATIO 100

struct server_inflater;

enum server_inflate_outcome {
    SERVER_INFLATE_OK,
    SERVER_INFLATE_DAMAGED,
    SERVER_INFLATE_RATIO_PASSED,
    SERVER_INFLATE_STOPPED
};

/* NULL without memory. */
struct server_inflater *server_inflater_create(void);
void server_inflater_destroy(struct server_inflater *inflater); /* NULL is harmless */

/* Unpacks `size` bytes and gives what comes out to `take`, piece by piece, which returns false to
 * stop. */
enum server_inflate_outcome server_inflate(struct server_inflater *inflater, const void *bytes,
                                           size_t size,
                                           bool (*take)(void *user, const void *bytes, size_t size),
                                           void *user);

/* Has all come that belongs to what was begun? */
bool server_inflater_is_whole(const struct server_inflater *inflater);

#endif
