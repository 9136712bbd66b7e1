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

#define LISTEN_BACKLOG 4096 /* the default limit of Linux on connections that wait to be accepted */
#define UNIX_PREFIX    "unix:"

static bool address_refuse(char error[SERVER_ERROR], const char *text, const char *why)
{
    return server_refuse(error, "'%s' is not an address to listen on: %s", text, why);
}

bool server_address_split(const char *text, char host[SERVER_ADDRESS_HOST], const char **port)
{
    bool is_bracketed = *text == '[';
    text += is_bracketed;
    size_t size = strcspn(text, is_bracketed ? "]" : ":[");
    if (!size || size >= SERVER_ADDRESS_HOST || (is_bracketed && !text[size])) return false;
    memcpy(host, text, size);
    host[size] = '\0';
    text += size + is_bracketed;
    *port = *text == ':' ? text + 1 : text;
    return (*text == ':' || !*text) && !(*port)[strspn(*port, "0123456789")];
}

bool server_address_parse(const char *text, struct server_address *out, char error[SERVER_ERROR])
{
    struct sockaddr_un name = {.sun_family = AF_UNIX};
    struct addrinfo hints = {.ai_family = AF_UNSPEC,
                             .ai_socktype = SOCK_STREAM,
                             .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV};
    struct addrinfo *found = NULL;
    char host[SERVER_ADDRESS_HOST];
    const char *port;
    if (strncmp(text, UNIX_PREFIX, strlen(UNIX_PREFIX)) == 0) {
        const char *path = text + strlen(UNIX_PREFIX);
        if (!*path || strlen(path) >= sizeof name.sun_path)
            return address_refuse(error, text, "the path of a unix socket has 1 to 107 characters");
        strcpy(name.sun_path, path);
        *out = (struct server_address){.size = sizeof name};
        memcpy(&out->socket, &name, sizeof name);
        return true;
    }
    if (!server_address_split(text, host, &port) || !*port)
        return address_refuse(error, text, "write ADDR:PORT, [ADDR]:PORT for IPv6, or unix:PATH");
    if (strlen(port) > 5 || atoi(port) > 65535)
        return address_refuse(error, text, "the port is a number from 0 to 65535");
    if (getaddrinfo(strcmp(host, "localhost") == 0 ? "127.0.0.1" : host, port, &hints, &found) != 0)
        return address_refuse(error, text, "write a numeric address or 'localhost'");
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

/* Removes a unix socket that a dead process left. Any other file is not removed, and makes bind
 * fail. The probe does not wait for a process that accepts no connections. */
static void stale_socket_remove(const struct server_address *address)
{
    const char *path = ((const struct sockaddr_un *)&address->socket)->sun_path;
    struct stat found;
    if (stat(path, &found) != 0 || !S_ISSOCK(found.st_mode)) return;
    int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (probe < 0) return;
    if (connect(probe, (const struct sockaddr *)&address->socket, address->size) != 0 &&
        errno == ECONNREFUSED)
        unlink(path);
    close(probe);
}

static bool listen_refuse(const struct server_address *address, char error[SERVER_ERROR])
{
    int why = errno;
    char text[SERVER_ADDRESS_TEXT];
    server_address_format(address, text);
    return server_refuse(error, "can't listen on %s: %s", text, strerror(why));
}

int server_address_bind(struct server_address *address, char error[SERVER_ERROR])
{
    const int on = 1;
    struct sockaddr *name = (struct sockaddr *)&address->socket;
    int descriptor = socket(name->sa_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    bool is_bound = descriptor >= 0;
    if (is_bound && name->sa_family != AF_UNIX) {
        setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
        is_bound = bind(descriptor, name, address->size) == 0;
        if (is_bound) address->size = sizeof address->socket;
        is_bound = is_bound && getsockname(descriptor, name, &address->size) == 0;
    }
    if (is_bound) return descriptor;
    (void)listen_refuse(address, error);
    if (descriptor >= 0) close(descriptor);
    return -1;
}

/* Also sets the mode of a unix socket, because the daemon's umask would restrict it to the daemon's
 * user. */
bool server_address_listen(int descriptor, const struct server_address *address,
                           char error[SERVER_ERROR])
{
    bool is_unix = address->socket.ss_family == AF_UNIX;
    const struct sockaddr *name = (const struct sockaddr *)&address->socket;
    const char *path = ((const struct sockaddr_un *)name)->sun_path;
    if (is_unix) stale_socket_remove(address);
    return ((!is_unix || bind(descriptor, name, address->size) == 0) &&
            (!is_unix || !address->mode || chmod(path, address->mode) == 0) &&
            listen(descriptor, LISTEN_BACKLOG) == 0) ||
           listen_refuse(address, error);
}
