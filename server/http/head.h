/* Head: the checks of a request's head as the HTTP library has parsed it, and where the request's
 * body ends.
 *
 * Two readers that disagree on where a request ends can be made to see different requests (request
 * smuggling). So a head that readers are known to understand differently is refused, and the
 * connection is closed. RFC 9112, 3.2, 5.1, 6 and 11.2; RFC 9110, 5.5 and 5.6.2.
 * server/doc/019-http-library.md lists the bytes that the library does not show. */
#ifndef SERVER_HTTP_HEAD_H
#define SERVER_HTTP_HEAD_H

struct server_exchange;

/* Checks the target as it stands in the request line. Returns why it is refused, static; NULL: it
 * is not. */
const char *server_head_check_target(const char *target);

/* Checks the method, the version and the headers of the exchange; sets is_http10, has_body and
 * body.declared. Returns why the head is refused, static; NULL: it is not. O(bytes). */
const char *server_head_read(struct server_exchange *exchange, const char *version);

#endif
