/* See sha256.h. Only this file includes GnuTLS' cryptography. */
#include "server/base/sha256.h"

#include <gnutls/crypto.h>
#include <stdlib.h>
#include <string.h>

#define DIGITS      "0123456789abcdef"
#define DIGEST      32
#define PIECE_BYTES ((size_t)1 << 20) /* number of bytes hashed between two checks of the control */

/* Prints the digest. The hash function fails only if the library lacks SHA-256. */
static void digest_print(int failed, const unsigned char digest[DIGEST],
                         char hex[SERVER_SHA256_HEX])
{
    if (failed) abort();
    for (int i = 0; i < DIGEST; i++) {
        hex[2 * i] = DIGITS[digest[i] >> 4];
        hex[2 * i + 1] = DIGITS[digest[i] & 15];
    }
    hex[2 * DIGEST] = '\0';
}

void server_sha256(const void *bytes, size_t size, char hex[SERVER_SHA256_HEX])
{
    unsigned char digest[DIGEST];
    digest_print(gnutls_hash_fast(GNUTLS_DIG_SHA256, bytes, size, digest), digest, hex);
}

bool server_sha256_check(const char *text)
{
    return strspn(text, DIGITS) == 2 * DIGEST;
}

/* A pointer to a struct server_sha256 is in fact a pointer to the library's state. */
struct server_sha256 *server_sha256_begin(void)
{
    gnutls_hash_hd_t state;
    return gnutls_hash_init(&state, GNUTLS_DIG_SHA256) == 0 ? (struct server_sha256 *)state : NULL;
}

void server_sha256_add(struct server_sha256 *sum, const void *bytes, size_t size)
{
    if (gnutls_hash((gnutls_hash_hd_t)sum, bytes, size)) abort();
}

void server_sha256_end(struct server_sha256 *sum, char hex[SERVER_SHA256_HEX])
{
    unsigned char digest[DIGEST];
    gnutls_hash_deinit((gnutls_hash_hd_t)sum, digest);
    digest_print(0, digest, hex);
}

enum gd_status server_sha256_within(const void *bytes, size_t size,
                                    const struct gd_control *control, char hex[SERVER_SHA256_HEX])
{
    /* gnutls_hash_fast allocates nothing; gnutls_hash_init leaks a block when memory is short. */
    if (size <= PIECE_BYTES) {
        server_sha256(bytes, size, hex);
        return GD_OK;
    }
    struct server_sha256 *sum = server_sha256_begin();
    enum gd_status status = sum ? GD_OK : GD_NO_MEMORY;
    for (size_t at = 0; !status && at < size; at += PIECE_BYTES) {
        server_sha256_add(sum, (const char *)bytes + at,
                          size - at < PIECE_BYTES ? size - at : PIECE_BYTES);
        if (size - at > PIECE_BYTES) status = gd_control_check(control, 0);
    }
    if (sum) server_sha256_end(sum, hex);
    return status;
}
