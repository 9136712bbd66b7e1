/* Entity tags: lists of them as clients send them, and what they demand. RFC 9110, 8.8.3 and 13. */
#ifndef SERVER_ETAG_H
#define SERVER_ETAG_H

#include <stdbool.h>
#include <stddef.h>

/* Strong comparison (for If-Match): a weak tag equals nothing. Weak comparison (for If-None-Match): W/"a" equals "a". */
enum server_etag_comparison { SERVER_ETAG_STRONG, SERVER_ETAG_WEAK };

/* Is the tag (`size` bytes, without quotes, strong) in the list `"a", W/"b"`, or is the list "*"? What can't be read
 * ends the list. */
bool server_etag_listed(const char *list, const char *tag, size_t size, enum server_etag_comparison comparison);

/* If-Match and If-None-Match as the client sent them; NULL: absent. */
struct server_precondition {
    const char *if_match, *if_none_match;
};

/* Does it hold for a resource of that entity tag (without quotes; NULL: there is no such resource)? */
bool server_precondition_holds(const struct server_precondition *precondition, const char *etag);

#endif
