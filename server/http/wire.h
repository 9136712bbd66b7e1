/* Wire: the bytes of requests before the HTTP library sees them.
 *
 * libmicrohttpd 0.9.75 takes a bare LF for a line's end, joins folded lines, and lets blanks stand
 * before a colon, and tells nobody; no option of it changes that. So the daemon defines the two
 * functions by which the library reads, recv and gnutls_record_recv, itself: what comes on a
 * watched socket passes the grammar, and where that finds a fault the library gets, instead of the
 * rest, an ending that makes a request of it, which http.c refuses. The alternatives are weighed in
 * server/doc/006. A third, accept4, waits a moment where there is no descriptor left: the library
 * would spin. */
#ifndef SERVER_HTTP_WIRE_H
#define SERVER_HTTP_WIRE_H

#include <stdbool.h>

struct server_connection;

/* From now on what is read from the socket passes the connection's grammar. False: its number is
 * too large. By the thread that reads, as detaching is. */
bool server_wire_attach(int descriptor, struct server_connection *connection);
void server_wire_detach(int descriptor);

#endif
