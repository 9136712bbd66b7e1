/* Address: where the daemon listens, ADDR:PORT or unix:PATH. */
#ifndef SERVER_ADDRESS_H
#define SERVER_ADDRESS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/socket.h>

struct server_address {
    struct sockaddr_storage socket;
    socklen_t size;
};

#define SERVER_ADDRESS_TEXT 128

/* Parses "127.0.0.1:8080", "[::1]:8080", "localhost:8080" or "unix:PATH"; false with a sentence in `error` (of
 * `error_size` bytes). Nothing is looked up in the DNS. */
bool server_address_parse(const char *text, struct server_address *out, char *error, size_t error_size);

/* True when only this machine can reach it: 127.0.0.0/8, ::1 and unix sockets. */
bool server_address_is_local(const struct server_address *address);

void server_address_format(const struct server_address *address, char text[SERVER_ADDRESS_TEXT]);

/* A bound, listening, non-blocking socket, or -1 with a sentence in `error`. `*address` becomes the bound one (a
 * port 0 is replaced). A unix socket that nobody listens on any more is replaced. The caller owns the descriptor. */
int server_address_listen(struct server_address *address, char *error, size_t error_size);

#endif
