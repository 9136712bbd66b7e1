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
    mode_t mode; /* of a unix socket; 0: by umask */
};

#define SERVER_ADDRESS_TEXT 128
#define SERVER_ADDRESS_HOST 128

/* Splits "host", "host:port", "[v6]" or "[v6]:port". `*port` points into the text, at digits or the
 * end. False: it has another form. */
bool server_address_split(const char *text, char host[SERVER_ADDRESS_HOST], const char **port);

/* Parses "127.0.0.1:8080", "[::1]:8080", "localhost:8080" or "unix:PATH", without DNS. False with a
 * sentence in `error`. */
bool server_address_parse(const char *text, struct server_address *out, char *error,
                          size_t error_size);

/* Whether only this machine can reach it: 127.0.0.0/8, ::1 and unix sockets. */
bool server_address_is_local(const struct server_address *address);

void server_address_format(const struct server_address *address, char text[SERVER_ADDRESS_TEXT]);

/* Returns a non-blocking socket, which the caller owns, or -1 with a sentence in `error`. A TCP
 * socket is bound, which may take a privilege, and `*address` becomes the bound address: port 0 is
 * replaced. */
int server_address_bind(struct server_address *address, char *error, size_t error_size);

/* Listens on the socket; false with a sentence in `error`. A unix socket is bound here, and not
 * before, because other processes take one that is bound and does not listen for a dead one. It
 * replaces a dead one. */
bool server_address_listen(int descriptor, const struct server_address *address, char *error,
                           size_t error_size);

#endif
