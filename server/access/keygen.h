/* Keygen: `geodesicd keygen NAME [--role read|write|operator] [--expires TIME|DAYSd] [--rate N]
 * [--concurrent N]`. */
#ifndef SERVER_ACCESS_KEYGEN_H
#define SERVER_ACCESS_KEYGEN_H

#include <stdbool.h>
#include <stdio.h>

/* Makes a key and prints it to `out`, this once, and after it the line for the file of --keys; what
 * they are is said on `error`, so that a script reads two lines. `argv` begins with the name.
 * False: a sentence was printed to `error`. */
bool server_keygen(int argc, char *const argv[], FILE *out, FILE *error);

#endif
