/* Address: where the daemon listens, ADDR:PORT or unix:PATH. */
#pragma once

#include <stdbool.h>
#include <sys/socket.h>
#include <sys/types.h>

#include "server/base/error.h"

struct server_address {
    struct sockaddr_storage socket;
    socklen_t size;
    mode_t mode; /* mode of a unix socket; 0 means set by the umask */
};

#define SERVER_ADDRESS_TEXT 128
#define SERVER_ADDRESS_HOST 128

/* Splits "host", "host:port", "[v6]" or "[v6]:port". `*port` then points at the digits or the end
 * of the text. */
bool server_address_split(const char *text, char host[SERVER_ADDRESS_HOST], const char **port);

/* Parses "127.0.0.1:80", "[::1]:80", "localhost:80" or "unix:PATH", without DNS. On failure,
 * returns false with a sentence in `error`. */
bool server_address_parse(const char *text, struct server_address *out, char error[SERVER_ERROR]);

/* Returns true if only this machine can reach the address: 127.0.0.0/8, ::1 and unix sockets. */
bool server_address_is_local(const struct server_address *address);

void server_address_format(const struct server_address *address, char text[SERVER_ADDRESS_TEXT]);

/* Returns a non-blocking socket, owned by the caller, or -1 with a sentence in `error`. A TCP
 * socket is bound, which may need a privilege; port 0 in `*address` is replaced by the actual
 * port. */
int server_address_bind(struct server_address *address, char error[SERVER_ERROR]);

/* Listens on the socket. On failure, returns false with a sentence in `error`. Also binds a unix
 * socket, and replaces a socket that a dead process left. A unix socket is not bound earlier,
 * because other processes regard a bound socket that does not listen as dead. */
bool server_address_listen(int descriptor, const struct server_address *address,
                           char error[SERVER_ERROR]);
