/* Entity tags: lists of them as clients send them, and what they demand. RFC 9110, 8.8.3 and 13.
 *
 * A resource has one tag, "abc". An answer that goes out packed is another representation of it,
 * whose tag is "abc-gzip": so that a strong tag never names two sequences of bytes. A client may
 * name the resource by either. */
#ifndef SERVER_EXCHANGE_ETAG_H
#define SERVER_EXCHANGE_ETAG_H

#include <stdbool.h>
#include <stddef.h>

#define SERVER_ETAG_PACKED_SUFFIX "-gzip"
#define SERVER_ETAG_LINES         64 /* of one header: as many as a request may have headers */

struct server_exchange;

/* If-Match and If-None-Match: each the lines that the client sent, in order, which count as one
 * list; NULL: no more of them, and no such header when the first one is. The lines are borrowed. */
struct server_precondition {
    const char *if_match[SERVER_ETAG_LINES + 1], *if_none_match[SERVER_ETAG_LINES + 1];
};

/* That of a request; borrowed from it. */
struct server_precondition server_precondition_read(const struct server_exchange *exchange);

enum server_etag_form { SERVER_ETAG_NONE, SERVER_ETAG_PLAIN, SERVER_ETAG_PACKED };

/* Does If-Match hold for a resource of that entity tag (without quotes, strong; NULL: there is no
 * such resource)? By strong comparison: a weak tag equals nothing. */
bool server_precondition_matches(const struct server_precondition *precondition, const char *etag);

/* Which form of the resource If-None-Match lists, the first of them. By weak comparison: W/"a"
 * equals "a". */
enum server_etag_form server_precondition_known(const struct server_precondition *precondition,
                                                const char *etag);

/* Do both allow a change, or a query by POST? */
bool server_precondition_holds(const struct server_precondition *precondition, const char *etag);

#endif
