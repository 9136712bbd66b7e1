/* Entity tags and the preconditions of requests. RFC 9110, 8.8.3 and 13.
 *
 * A strong tag never names two different sequences of bytes, so each representation has its own
 * tag:
 *     abc               the resource (a mesh, a NURBS surface, a page), and its description
 *     abc-d0123….1      its description with a client's own text, whose hash is 0123…
 *     abc-csv.1         an answer computed from abc, in the form "csv" of format version 1
 *     abc-csv.1-gzip    the same answer, compressed
 * The tag of a resource contains no "-". A change of the client's text changes the tag of the
 * description only. The conditions compare tags as follows:
 *     If-None-Match of GET and HEAD    weak, with the selected representation, compressed or not
 *     If-Match                         strong, with the resource and all its representations
 *     If-None-Match of other methods   weak, with the resource and all its representations
 * For a request that changes the resource, only the current tag of a description matches.
 * Conditions on dates and ranges are ignored: no resource has a date, and no range is served. */
#pragma once

#include <stdbool.h>

/* Part of the tags of computed answers. Increment this number with every change of an answer's
 * bytes. */
#define SERVER_FORMAT_VERSION "1"

#define SERVER_ETAG_PACKED_SUFFIX "-gzip"
#define SERVER_ETAG_TEXT          64 /* bytes of a representation's tag, with the NUL */
/* most values of one header; a request has at most 64 headers */
#define SERVER_ETAG_LINES 64

struct server_exchange;

/* The values of the headers If-Match and If-None-Match, in the order in which the client sent them.
 * Each array ends with NULL. Several values of one header count as one list. The values are
 * borrowed. */
struct server_precondition {
    const char *if_match[SERVER_ETAG_LINES + 1], *if_none_match[SERVER_ETAG_LINES + 1];
};

/* Returns the preconditions of a request; the values are borrowed from it. */
struct server_precondition server_precondition_read(const struct server_exchange *exchange);

#define SERVER_ETAG_CAPTION 18 /* bytes of server_etag_caption, with the NUL */

/* Writes the form of a description that contains this text of a client: "d" and 16 digits. Returns
 * `out`, or NULL if the text is empty. */
const char *server_etag_caption(char out[SERVER_ETAG_CAPTION], const char *text);

enum server_etag_form { SERVER_ETAG_NONE, SERVER_ETAG_PLAIN, SERVER_ETAG_PACKED };

/* Writes the tag of the representation in the form `form` ("json": lower case letters and digits).
 * If `form` is NULL, writes the resource's own tag `etag`. Here and below, tags are written without
 * quotes. */
void server_etag_write(char out[SERVER_ETAG_TEXT], const char *etag, const char *form);

/* Returns true if there is no If-Match, or if it lists a tag of the resource. `etag` is the
 * resource's tag or that of one of its representations; NULL means that the resource does not
 * exist. */
bool server_precondition_matches(const struct server_precondition *precondition, const char *etag);

/* A representation has a plain tag, `etag`, and a tag for its compressed form. Returns the form
 * whose tag If-None-Match lists first. */
enum server_etag_form server_precondition_known(const struct server_precondition *precondition,
                                                const char *etag);

/* Returns whether both conditions allow a query by POST; `etag` is the resource's tag. */
bool server_precondition_holds(const struct server_precondition *precondition, const char *etag);

/* Returns whether both conditions allow a change of the resource, whose description contains the
 * client's `text`. `etag` is NULL if the resource does not exist. */
bool server_precondition_allows(const struct server_precondition *precondition, const char *etag,
                                const char *text);
