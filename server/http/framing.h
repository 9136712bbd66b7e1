/* Framing: where a request's body ends. Two readers that disagree on it can be made to see
 * different requests (request smuggling), so whatever is ambiguous is refused here, before the
 * library's own reading counts. RFC 9112, 6.3 and 11.2. */
#ifndef SERVER_HTTP_FRAMING_H
#define SERVER_HTTP_FRAMING_H

#include "server/http/exchange.h"

struct server_framing {
    bool has_body;     /* one is announced, even if empty */
    uint64_t declared; /* Content-Length; 0: no body; SERVER_BODY_CHUNKED */
};

/* invalid_request: Content-Length together with Transfer-Encoding, either of them or Host twice, no
 * Host in HTTP/1.1, a length that is no number, a coding other than chunked, chunks in HTTP/1.0. */
bool server_framing_read(const struct server_exchange *exchange, struct server_framing *out,
                         struct proto_problem *problem);

#endif
