/* See address.h. */
#include "server/config/address.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#define LISTEN_BACKLOG 4096 /* also what Linux allows by default */
#define UNIX_PREFIX    "unix:"

static bool address_refuse(char *error, size_t error_size, const char *text, const char *why)
{
    snprintf(error, error_size, "'%s' is no address to listen on: %s", text, why);
    return false;
}

static bool unix_parse(const char *text, struct server_address *out, char *error, size_t error_size)
{
    const char *path = text + strlen(UNIX_PREFIX);
    struct sockaddr_un name = {.sun_family = AF_UNIX};
    if (!*path || strlen(path) >= sizeof name.sun_path)
        return address_refuse(error, error_size, text,
                              "the path of a unix socket has 1 to 107 characters");
    strcpy(name.sun_path, path);
    *out = (struct server_address){.size = sizeof name};
    memcpy(&out->socket, &name, sizeof name);
    return true;
}

/* Splits "host:port" or "[host]:port" at the last colon. */
static bool split_host_port(const char *text, char host[64], const char **port)
{
    const char *colon = strrchr(text, ':');
    if (!colon || colon == text) return false;
    size_t size = (size_t)(colon - text);
    if (text[0] == '[' && size > 2 && text[size - 1] == ']') {
        text++;
        size -= 2;
    } else if (memchr(text, ':', size)) {
        return false;
    }
    if (size >= 64) return false;
    memcpy(host, text, size);
    host[size] = '\0';
    *port = colon + 1;
    return true;
}

static bool is_port(const char *text)
{
    size_t digits = strspn(text, "0123456789");
    return digits > 0 && digits <= 5 && !text[digits] && atoi(text) <= 65535;
}

bool server_address_parse(const char *text, struct server_address *out, char *error,
                          size_t error_size)
{
    if (strncmp(text, UNIX_PREFIX, strlen(UNIX_PREFIX)) == 0)
        return unix_parse(text, out, error, error_size);
    char host[64];
    const char *port;
    if (!split_host_port(text, host, &port))
        return address_refuse(error, error_size, text,
                              "write ADDR:PORT, [ADDR]:PORT for IPv6, or unix:PATH");
    if (!is_port(port))
        return address_refuse(error, error_size, text, "the port is a number from 0 to 65535");

    struct addrinfo hints = {.ai_family = AF_UNSPEC,
                             .ai_socktype = SOCK_STREAM,
                             .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV};
    struct addrinfo *found = NULL;
    if (getaddrinfo(strcmp(host, "localhost") == 0 ? "127.0.0.1" : host, port, &hints, &found) != 0)
        return address_refuse(error, error_size, text,
                              "the address is a numeric one or 'localhost'");
    *out = (struct server_address){.size = found->ai_addrlen};
    memcpy(&out->socket, found->ai_addr, found->ai_addrlen);
    freeaddrinfo(found);
    return true;
}

bool server_address_is_local(const struct server_address *address)
{
    switch (address->socket.ss_family) {
    case AF_UNIX:
        return true;
    case AF_INET:
        return ntohl(((const struct sockaddr_in *)&address->socket)->sin_addr.s_addr) >> 24 == 127;
    case AF_INET6:
        return IN6_IS_ADDR_LOOPBACK(&((const struct sockaddr_in6 *)&address->socket)->sin6_addr);
    default:
        return false;
    }
}

void server_address_format(const struct server_address *address, char text[SERVER_ADDRESS_TEXT])
{
    if (address->socket.ss_family == AF_UNIX) {
        snprintf(text, SERVER_ADDRESS_TEXT, UNIX_PREFIX "%s",
                 ((const struct sockaddr_un *)&address->socket)->sun_path);
        return;
    }
    char host[64] = "?", port[8] = "?";
    getnameinfo((const struct sockaddr *)&address->socket, address->size, host, sizeof host, port,
                sizeof port, NI_NUMERICHOST | NI_NUMERICSERV);
    snprintf(text, SERVER_ADDRESS_TEXT, strchr(host, ':') ? "[%s]:%s" : "%s:%s", host, port);
}

/* Removes a unix socket that a dead process left. A live one, or any other file, stays and makes
 * bind fail. */
static void remove_stale_socket(const struct server_address *address)
{
    const char *path = ((const struct sockaddr_un *)&address->socket)->sun_path;
    struct stat found;
    if (stat(path, &found) != 0 || !S_ISSOCK(found.st_mode)) return;
    int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (probe < 0) return;
    if (connect(probe, (const struct sockaddr *)&address->socket, address->size) != 0 &&
        errno == ECONNREFUSED)
        unlink(path);
    close(probe);
}

static bool listen_refuse(const struct server_address *address, char *error, size_t error_size)
{
    int why = errno;
    char text[SERVER_ADDRESS_TEXT];
    server_address_format(address, text);
    snprintf(error, error_size, "can't listen on %s: %s", text, strerror(why));
    return false;
}

static bool tcp_bind(int descriptor, struct server_address *address)
{
    int on = 1;
    setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (bind(descriptor, (const struct sockaddr *)&address->socket, address->size) != 0)
        return false;
    address->size = sizeof address->socket;
    return getsockname(descriptor, (struct sockaddr *)&address->socket, &address->size) == 0;
}

int server_address_bind(struct server_address *address, char *error, size_t error_size)
{
    int descriptor =
        socket(address->socket.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (descriptor >= 0 && (address->socket.ss_family == AF_UNIX || tcp_bind(descriptor, address)))
        return descriptor;
    (void)listen_refuse(address, error, error_size);
    if (descriptor >= 0) close(descriptor);
    return -1;
}

/* Gives the socket its mode, which the umask of the daemon's files would narrow. */
static bool unix_bind(int descriptor, const struct server_address *address)
{
    remove_stale_socket(address);
    if (bind(descriptor, (const struct sockaddr *)&address->socket, address->size) != 0)
        return false;
    return !address->mode ||
           chmod(((const struct sockaddr_un *)&address->socket)->sun_path, address->mode) == 0;
}

bool server_address_listen(int descriptor, const struct server_address *address, char *error,
                           size_t error_size)
{
    bool is_bound = address->socket.ss_family != AF_UNIX || unix_bind(descriptor, address);
    return (is_bound && listen(descriptor, LISTEN_BACKLOG) == 0) ||
           listen_refuse(address, error, error_size);
}
