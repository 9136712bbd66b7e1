/* See sha256.h. The only file that includes GnuTLS' cryptography. */
#include "server/sha256.h"

#include <gnutls/crypto.h>
#include <stdlib.h>

void server_sha256(const void *bytes, size_t size, char hex[SERVER_SHA256_HEX])
{
    static const char digits[] = "0123456789abcdef";
    unsigned char digest[32];
    if (gnutls_hash_fast(GNUTLS_DIG_SHA256, bytes, size, digest) != 0) abort(); /* only if the library has no SHA-256 */
    for (int i = 0; i < 32; i++) {
        hex[2 * i] = digits[digest[i] >> 4];
        hex[2 * i + 1] = digits[digest[i] & 15];
    }
    hex[64] = '\0';
}
