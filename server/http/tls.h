/* TLS: the daemon's certificate and private key, as GnuTLS asks for them at each handshake, so that
 * they can be exchanged while it runs. TLS 1.2 and 1.3 are spoken. */
#ifndef SERVER_HTTP_TLS_H
#define SERVER_HTTP_TLS_H

#include <stdbool.h>
#include <stddef.h>

struct server_tls;

/* What may be spoken, in GnuTLS' words: no exchange of keys by RSA, since it lets whoever gets the
 * private key later read what was recorded before (no forward secrecy). */
#define SERVER_TLS_PRIORITIES "NORMAL:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2:-RSA"

/* Reads both files (PEM; the certificate first, then those that it rests on). NULL with a sentence
 * in `error`. One at a time can be open in a process: GnuTLS passes no pointer on. */
struct server_tls *server_tls_open(const char *certificate, const char *key, char *error,
                                   size_t error_size);

/* Reads them again. False with a sentence in `error`: those of before stay in use. Not to be called
 * by two threads at once. */
bool server_tls_reload(struct server_tls *tls, char *error, size_t error_size);

/* When no handshake is under way any more. NULL is harmless. */
void server_tls_close(struct server_tls *tls);

/* The gnutls_certificate_retrieve_function2 to give to the library. */
void *server_tls_retrieve(void);

#endif
