/* Grammar: the syntax of HTTP/1.1 requests, followed byte by byte, strictly. Two readers that
 * disagree on where a request ends can be made to see different requests (request smuggling), so
 * what RFC 9112 lets a recipient mend, or readers are known to mend in different ways, is a fault
 * here: a bare LF or CR, a folded line, blanks before a colon, a length that stands twice, ...
 *
 * It follows several requests on one connection, and where their bodies end. It keeps no bytes. */
#ifndef SERVER_HTTP_GRAMMAR_H
#define SERVER_HTTP_GRAMMAR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SERVER_GRAMMAR_WORD 20 /* of the header names and values that count here, with the NUL */

/* What a head may have: less than the library has room for, so that too much of it gets an answer
 * of ours. */
#define SERVER_GRAMMAR_TARGET_MOST 8192 /* bytes of the target */
/* bytes of all parts of it, line ends and blanks not counted */
#define SERVER_GRAMMAR_HEAD_MOST    12288
#define SERVER_GRAMMAR_HEADERS_MOST 64

/* What the next byte belongs to. */
enum server_grammar_state {
    SERVER_GRAMMAR_START, /* before a request */
    SERVER_GRAMMAR_START_LF,
    SERVER_GRAMMAR_METHOD,
    SERVER_GRAMMAR_TARGET,
    SERVER_GRAMMAR_VERSION,
    SERVER_GRAMMAR_LINE_LF, /* of the request line */
    SERVER_GRAMMAR_FIELD,   /* the first byte of a header line, or CR */
    SERVER_GRAMMAR_NAME,
    SERVER_GRAMMAR_VALUE,
    SERVER_GRAMMAR_VALUE_LF,
    SERVER_GRAMMAR_END_LF, /* of the empty line after the headers */
    SERVER_GRAMMAR_BODY,
    SERVER_GRAMMAR_CHUNK_SIZE,
    SERVER_GRAMMAR_CHUNK_EXTENSION,
    SERVER_GRAMMAR_CHUNK_SIZE_LF,
    SERVER_GRAMMAR_CHUNK_DATA,
    SERVER_GRAMMAR_CHUNK_CR,
    SERVER_GRAMMAR_CHUNK_LF
};

/* Headers that count here. */
enum server_grammar_field {
    SERVER_GRAMMAR_OTHER,
    SERVER_GRAMMAR_HOST,
    SERVER_GRAMMAR_LENGTH,
    SERVER_GRAMMAR_CODING
};

/* All zero: before the first request. */
struct server_grammar {
    enum server_grammar_state state;
    bool in_trailer; /* FIELD to END_LF are those after the last chunk */
    bool is_http10, has_length, is_chunked;
    unsigned hosts;
    /* bytes of the body or chunk; in CHUNK_SIZE the digits so far */
    uint64_t left;
    /* bytes of the part at hand: method, target, version, name, value, size */
    unsigned count;
    /* bytes of the parts of this head before that, and its headers so far */
    unsigned head, headers;
    /* bytes of chunk extensions of this request, with their first semicolons */
    unsigned extra;
    enum server_grammar_field header;                           /* in VALUE: whose it is */
    char name[SERVER_GRAMMAR_WORD], value[SERVER_GRAMMAR_WORD]; /* in lower case, cut */
    uint64_t heads;                                             /* ends of headers that were seen */
    const char *fault; /* a sentence; NULL: none. Once there is one, nothing is followed any more */
};

/* Follows `size` bytes up to the first fault. Returns how many are without fault. O(size); bodies
 * cost nothing. */
size_t server_grammar_follow(struct server_grammar *grammar, const char *bytes, size_t size);

/* Inside a request's headers, its request line included. */
bool server_grammar_is_in_head(const struct server_grammar *grammar);

/* What ends the request of a fault for a more lenient reader that was given all bytes before it: a
 * faulty head becomes a whole one, in chunks and trailers it is something that every reader
 * refuses. Static; "": nothing would. */
const char *server_grammar_ending(const struct server_grammar *grammar);

#endif
