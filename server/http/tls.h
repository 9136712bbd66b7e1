/* TLS: certificate and private key. Each handshake reads the current pair, so a reload can replace
 * the pair. */
#pragma once

#include "server/base/error.h"

struct server_tls;

/* A GnuTLS priority string: TLS 1.2 and 1.3 without key exchange by RSA. Key exchange by RSA lacks
 * forward secrecy. If the private key leaked later, an attacker could decrypt recorded traffic. */
#define SERVER_TLS_PRIORITIES "NORMAL:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2:-RSA"

/* Reads both files (PEM; the certificate first, then its issuers). On failure, returns NULL with a
 * sentence in `error`. A process can have only one open pair, because GnuTLS passes no user pointer
 * to the callback. */
struct server_tls *server_tls_open(const char *certificate, const char *key,
                                   char error[SERVER_ERROR]);

/* Reads the files again. Only one thread at a time may call this function. On failure, returns
 * false with a sentence in `error`; the old pair stays in use. */
bool server_tls_reload(struct server_tls *tls, char error[SERVER_ERROR]);

/* Call this function after the last handshake. NULL is allowed. */
void server_tls_close(struct server_tls *tls);

/* Returns the gnutls_certificate_retrieve_function2 for MHD_OPTION_HTTPS_CERT_CALLBACK. */
void *server_tls_retrieve(void);
