/* See head.h. */
#include "server/http/head.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "server/exchange/exchange.h"

#define TARGET_MOST 8192  /* bytes */
#define HEAD_MOST   12288 /* bytes of all parts: leaves the library room for the answer (http.c) */

#define QUOTE_(number) #number
#define QUOTE(number)  QUOTE_(number)

static const bool is_token_byte[256] = {
    ['!'] = true,         ['#' ... '\''] = true, ['*' ... '+'] = true,
    ['-' ... '.'] = true, ['0' ... '9'] = true,  ['A' ... 'Z'] = true,
    ['^' ... 'z'] = true, ['|'] = true,          ['~'] = true,
};

/* The size of a token; 0: the text is none. */
static size_t token_size(const char *text)
{
    size_t size = 0;
    while (is_token_byte[(unsigned char)text[size]]) size++;
    return text[size] ? 0 : size;
}

static bool is_control(unsigned char byte)
{
    return (byte < ' ' && byte != '\t') || byte == 0x7f;
}

const char *server_head_check_target(const char *target)
{
    size_t size = 0;
    for (; target[size]; size++)
        if (target[size] <= ' ' || target[size] > '~' || target[size] == '#')
            return "the request target holds a byte that has to be percent-encoded";
    return size <= TARGET_MOST ? NULL
                               : "the request target has more than " QUOTE(
                                     TARGET_MOST) " bytes; send a POST with a body";
}

/* Adds the header's bytes to `*size`. */
static const char *check_header(const struct server_named_value *header, size_t *size)
{
    const char *value = header->value;
    size_t name_size = token_size(header->name);
    if (!name_size) return "the name of a header is no token, or a blank stands before its colon";
    while (*value && !is_control((unsigned char)*value)) value++;
    if (*value) return "the value of a header holds a control character";
    *size += name_size + (size_t)(value - header->value);
    return NULL;
}

static const char *check_headers(const struct server_exchange *exchange, size_t size)
{
    const char *fault = NULL;
    for (uint32_t i = 0; i < exchange->header_count && !fault; i++)
        fault = check_header(&exchange->headers[i], &size);
    if (fault || size <= HEAD_MOST) return fault;
    return "the request line and the headers have more than " QUOTE(HEAD_MOST) " bytes";
}

static bool read_length(const char *text, uint64_t *out)
{
    size_t digits = strspn(text, "0123456789");
    if (digits == 0 || text[digits]) return false;
    errno = 0;
    *out = strtoull(text, NULL, 10);
    return errno == 0 && *out != SERVER_BODY_CHUNKED;
}

/* Two equal lengths are refused, too: readers differ in which one they would take. */
static const char *read_framing(struct server_exchange *exchange)
{
    uint32_t lengths = server_exchange_count_headers(exchange, "Content-Length");
    uint32_t hosts = server_exchange_count_headers(exchange, "Host");
    uint32_t codings = server_exchange_count_headers(exchange, "Transfer-Encoding");
    exchange->has_body = lengths || codings;
    if (hosts > 1) return "Host stands twice; send it once";
    if (hosts == 0 && !exchange->is_http10) return "Host is missing; send it once";
    if (lengths && codings) return "send Content-Length or Transfer-Encoding, not both";
    if (lengths > 1) return "Content-Length stands twice; send it once";
    if (codings > 1) return "Transfer-Encoding stands twice; send it once";
    if (codings) {
        const char *coding = server_exchange_header(exchange, "Transfer-Encoding");
        exchange->body.declared = SERVER_BODY_CHUNKED;
        return !exchange->is_http10 && strcasecmp(coding, "chunked") == 0
                   ? NULL
                   : "the only Transfer-Encoding is chunked, from HTTP/1.1 on";
    }
    if (lengths &&
        !read_length(server_exchange_header(exchange, "Content-Length"), &exchange->body.declared))
        return "Content-Length is not a decimal number of bytes";
    return NULL;
}

const char *server_head_read(struct server_exchange *exchange, const char *version)
{
    size_t method_size = token_size(exchange->method);
    exchange->is_http10 = strcmp(version, "HTTP/1.0") == 0;
    if (!method_size) return "the method is no token";
    if (!exchange->is_http10 && strcmp(version, "HTTP/1.1") != 0)
        return "the version is neither HTTP/1.1 nor HTTP/1.0";
    const char *fault = check_headers(exchange, method_size + exchange->target_size);
    return fault ? fault : read_framing(exchange);
}
