/* Address: where the daemon listens, ADDR:PORT or unix:PATH. */
#ifndef SERVER_CONFIG_ADDRESS_H
#define SERVER_CONFIG_ADDRESS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/socket.h>
#include <sys/types.h>

struct server_address {
    struct sockaddr_storage socket;
    socklen_t size;
    mode_t mode; /* that a unix socket gets; 0: by umask */
};

#define SERVER_ADDRESS_TEXT 128

/* Parses "127.0.0.1:8080", "[::1]:8080", "localhost:8080" or "unix:PATH"; false with a sentence in
 * `error` (of `error_size` bytes). Nothing is looked up in the DNS. */
bool server_address_parse(const char *text, struct server_address *out, char *error,
                          size_t error_size);

/* True when only this machine can reach it: 127.0.0.0/8, ::1 and unix sockets. */
bool server_address_is_local(const struct server_address *address);

void server_address_format(const struct server_address *address, char text[SERVER_ADDRESS_TEXT]);

/* A non-blocking socket, of TCP a bound one (which may take a privilege), or -1 with a sentence in
 * `error`. `*address` becomes the bound one (a port 0 is replaced). The caller owns the descriptor.
 */
int server_address_bind(struct server_address *address, char *error, size_t error_size);

/* Listens on that socket; false with a sentence in `error`. A unix socket is bound now, since
 * others take one that is bound and does not listen for a dead one. It takes the place of a dead
 * one. */
bool server_address_listen(int descriptor, const struct server_address *address, char *error,
                           size_t error_size);

#endif
