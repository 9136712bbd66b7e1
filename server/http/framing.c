/* See framing.h. */
#include "server/http/framing.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool refuse(struct proto_problem *problem, const char *sentence)
{
    return proto_problem_set(problem, PROTO_PROBLEM_INVALID_REQUEST, "%s", sentence);
}

static bool read_length(const char *text, uint64_t *out)
{
    size_t digits = strspn(text, "0123456789");
    if (digits == 0 || text[digits]) return false;
    errno = 0;
    *out = strtoull(text, NULL, 10);
    return errno == 0 && *out != SERVER_BODY_CHUNKED;
}

bool server_framing_read(const struct server_exchange *exchange, struct server_framing *out,
                         struct proto_problem *problem)
{
    uint32_t lengths = server_exchange_count_headers(exchange, "Content-Length");
    uint32_t hosts = server_exchange_count_headers(exchange, "Host");
    uint32_t codings = server_exchange_count_headers(exchange, "Transfer-Encoding");
    struct server_framing framing = {.has_body = lengths || codings};
    if (hosts > 1 || (hosts == 0 && !exchange->is_http10))
        return refuse(problem, "send the Host header, once");
    if (lengths && codings)
        return refuse(problem, "send Content-Length or Transfer-Encoding, not both");
    if (lengths > 1 || codings > 1)
        return refuse(problem, "send Content-Length or Transfer-Encoding once");
    if (lengths &&
        !read_length(server_exchange_header(exchange, "Content-Length"), &framing.declared))
        return refuse(problem, "Content-Length is not a decimal number of bytes");
    if (codings) {
        if (exchange->is_http10 ||
            strcasecmp(server_exchange_header(exchange, "Transfer-Encoding"), "chunked") != 0)
            return refuse(problem, "the only Transfer-Encoding is chunked, from HTTP/1.1 on");
        framing.declared = SERVER_BODY_CHUNKED;
    }
    *out = framing;
    return true;
}
