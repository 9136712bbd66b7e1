/* SHA-256 of a buffer. */
#ifndef SERVER_SHA256_H
#define SERVER_SHA256_H

#include <stddef.h>

#define SERVER_SHA256_HEX 65 /* with the NUL */

/* Lower-case hexadecimal. */
void server_sha256(const void *bytes, size_t size, char hex[SERVER_SHA256_HEX]);

#endif
