/* See grammar.h. RFC 9112, 2 to 7; RFC 9110, 5.5 and 5.6.2. */
#include "server/http/grammar.h"

#include <ctype.h>
#include <string.h>

#include "server/base/printable.h"

#define METHOD_MOST     32
#define NAME_MOST       256
#define VERSION_BYTES   8
#define SIZE_DIGITS     16
#define EXTENSION_BYTES 1024 /* of all chunks of a request */

typedef const char *(*step_function)(struct server_grammar *grammar, unsigned char byte);

/* What a byte may be part of: a token (RFC 9110, 5.6.2), a target, a value. */
enum { IN_TOKEN = 1, IN_TARGET = 2, IN_VALUE = 4 };
static const unsigned char classes[256] = {
#define TOKEN  (IN_TOKEN | IN_TARGET | IN_VALUE)
#define TARGET (IN_TARGET | IN_VALUE)
    ['\t'] = IN_VALUE,
    [' '] = IN_VALUE,
    ['!'] = TOKEN,
    ['"'] = TARGET,
    ['#'] = IN_TOKEN | IN_VALUE,
    ['$' ... '\''] = TOKEN,
    ['(' ... ')'] = TARGET,
    ['*' ... '+'] = TOKEN,
    [','] = TARGET,
    ['-' ... '.'] = TOKEN,
    ['/'] = TARGET,
    ['0' ... '9'] = TOKEN,
    [':' ... '@'] = TARGET,
    ['A' ... 'Z'] = TOKEN,
    ['[' ... ']'] = TARGET,
    ['^' ... 'z'] = TOKEN,
    ['{'] = TARGET,
    ['|'] = TOKEN,
    ['}'] = TARGET,
    ['~'] = TOKEN,
    [0x80 ... 0xff] = IN_VALUE,
#undef TOKEN
#undef TARGET
};

static bool is_token(unsigned char byte)
{
    return classes[byte] & IN_TOKEN;
}

/* Enters a part. */
static const char *enter(struct server_grammar *grammar, enum server_grammar_state state)
{
    grammar->state = state;
    grammar->head += grammar->count;
    grammar->count = 0;
    return NULL;
}

#define QUOTE_(number) #number
#define QUOTE(number)  QUOTE_(number)

/* Of what has no end of its own. */
static const char *find_excess(const struct server_grammar *grammar)
{
    if (grammar->state == SERVER_GRAMMAR_TARGET && grammar->count > SERVER_GRAMMAR_TARGET_MOST)
        return "the request target has more than " QUOTE(
            SERVER_GRAMMAR_TARGET_MOST) " bytes; POST takes a body";
    return grammar->head + grammar->count > SERVER_GRAMMAR_HEAD_MOST
               ? "the request line and the headers have more than " QUOTE(
                     SERVER_GRAMMAR_HEAD_MOST) " bytes"
               : NULL;
}

/* Keeps the byte of a name or a value, in lower case, if there is room; a cut word ends differently
 * from any that counts. */
static void keep(char word[SERVER_GRAMMAR_WORD], unsigned at, unsigned char byte)
{
    if (at < SERVER_GRAMMAR_WORD - 1) word[at] = (char)tolower(byte);
    word[at < SERVER_GRAMMAR_WORD - 1 ? at + 1 : SERVER_GRAMMAR_WORD - 1] = '\0';
}

/* --- the request line ------------------------------------------------------------------------- */

/* One empty line may stand before a request: old clients send one after a body. */
static const char *start(struct server_grammar *grammar, unsigned char byte)
{
    if (byte == '\r' && !grammar->count++) {
        grammar->state = SERVER_GRAMMAR_START_LF;
        return NULL;
    }
    if (!is_token(byte)) return "a request begins with a method";
    grammar->is_http10 = grammar->has_length = grammar->is_chunked = grammar->in_trailer = false;
    grammar->hosts = grammar->extra = grammar->headers = 0;
    grammar->left = 0;
    enter(grammar, SERVER_GRAMMAR_METHOD);
    grammar->count = 1;
    grammar->head = 0;
    return NULL;
}

static const char *start_lf(struct server_grammar *grammar, unsigned char byte)
{
    grammar->state = SERVER_GRAMMAR_START; /* keeps the count: one empty line */
    return byte == '\n' ? NULL : "a CR stands without its LF";
}

static const char *method(struct server_grammar *grammar, unsigned char byte)
{
    if (byte == ' ') return enter(grammar, SERVER_GRAMMAR_TARGET);
    if (!is_token(byte)) return "the method is no token";
    return ++grammar->count > METHOD_MOST ? "the method is too long" : NULL;
}

static const char *target(struct server_grammar *grammar, unsigned char byte)
{
    if (byte == ' ' && grammar->count) return enter(grammar, SERVER_GRAMMAR_VERSION);
    if (!(classes[byte] & IN_TARGET))
        return "the request target holds a byte that has to be percent-encoded, or two blanks "
               "stand around it";
    grammar->count++;
    return find_excess(grammar);
}

static const char *version(struct server_grammar *grammar, unsigned char byte)
{
    static const char text[] = "HTTP/1.";
    const unsigned size = sizeof text - 1;
    if (grammar->count == VERSION_BYTES)
        return byte == '\r' ? enter(grammar, SERVER_GRAMMAR_LINE_LF)
                            : "the request line does not end after HTTP/1.1";
    bool is_right = grammar->count < size ? byte == (unsigned char)text[grammar->count]
                                          : byte == '0' || byte == '1';
    if (!is_right) return "the version is neither HTTP/1.1 nor HTTP/1.0";
    grammar->is_http10 = byte == '0';
    grammar->count++;
    return NULL;
}

static const char *line_lf(struct server_grammar *grammar, unsigned char byte)
{
    enter(grammar, SERVER_GRAMMAR_FIELD);
    return byte == '\n' ? NULL : "a CR stands without its LF";
}

/* --- headers and trailers --------------------------------------------------------------------- */

static const char *field(struct server_grammar *grammar, unsigned char byte)
{
    if (byte == '\r') return enter(grammar, SERVER_GRAMMAR_END_LF);
    if (byte == ' ' || byte == '\t')
        return "a header is folded, or the first one begins with a blank";
    if (!is_token(byte)) return "a header line begins with no name";
    if (grammar->headers++ == SERVER_GRAMMAR_HEADERS_MOST)
        return "the request has more than " QUOTE(SERVER_GRAMMAR_HEADERS_MOST) " headers";
    enter(grammar, SERVER_GRAMMAR_NAME);
    keep(grammar->name, grammar->count++, byte);
    return NULL;
}

static enum server_grammar_field find_header(const char *name)
{
    if (strcmp(name, "host") == 0) return SERVER_GRAMMAR_HOST;
    if (strcmp(name, "content-length") == 0) return SERVER_GRAMMAR_LENGTH;
    return strcmp(name, "transfer-encoding") == 0 ? SERVER_GRAMMAR_CODING : SERVER_GRAMMAR_OTHER;
}

static const char *name(struct server_grammar *grammar, unsigned char byte)
{
    if (byte == ':') {
        grammar->header = find_header(grammar->name);
        grammar->value[0] = '\0';
        return enter(grammar, SERVER_GRAMMAR_VALUE);
    }
    if (!is_token(byte))
        return "the name of a header holds a byte that it can't, or a blank stands before its "
               "colon";
    keep(grammar->name, grammar->count++, byte);
    return grammar->count > NAME_MOST ? "the name of a header is too long" : find_excess(grammar);
}

static const char *take_length(struct server_grammar *grammar)
{
    size_t digits = strspn(grammar->value, "0123456789");
    if (grammar->has_length) return "Content-Length stands twice";
    if (digits == 0 || digits > 18 || grammar->value[digits])
        return "Content-Length is not a decimal number of bytes";
    grammar->has_length = true;
    for (size_t i = 0; i < digits; i++)
        grammar->left = 10 * grammar->left + (uint64_t)(grammar->value[i] - '0');
    return NULL;
}

static const char *take_coding(struct server_grammar *grammar)
{
    if (grammar->is_chunked) return "Transfer-Encoding stands twice";
    if (grammar->is_http10) return "HTTP/1.0 has no Transfer-Encoding";
    if (strcmp(grammar->value, "chunked") != 0) return "the only Transfer-Encoding is chunked";
    grammar->is_chunked = true;
    return NULL;
}

/* A header is whole; its value is known up to blanks before it. */
static const char *take_field(struct server_grammar *grammar)
{
    if (grammar->in_trailer && grammar->header)
        return "a trailer can't say how a request is framed";
    switch (grammar->header) {
    case SERVER_GRAMMAR_LENGTH:
        return take_length(grammar);
    case SERVER_GRAMMAR_CODING:
        return take_coding(grammar);
    case SERVER_GRAMMAR_HOST:
        return grammar->hosts++ ? "Host stands twice" : NULL;
    case SERVER_GRAMMAR_OTHER:
        break;
    }
    return NULL;
}

static const char *value(struct server_grammar *grammar, unsigned char byte)
{
    if (byte == '\r') {
        const char *fault = take_field(grammar);
        return fault ? fault : enter(grammar, SERVER_GRAMMAR_VALUE_LF);
    }
    if (!(classes[byte] & IN_VALUE)) return "the value of a header holds a control character";
    if (grammar->count || (byte != ' ' && byte != '\t'))
        keep(grammar->value, grammar->count++, byte);
    return find_excess(grammar);
}

static const char *value_lf(struct server_grammar *grammar, unsigned char byte)
{
    enter(grammar, SERVER_GRAMMAR_FIELD);
    return byte == '\n' ? NULL : "a CR stands without its LF";
}

static const char *end_lf(struct server_grammar *grammar, unsigned char byte)
{
    if (byte != '\n') return "a CR stands without its LF";
    if (grammar->in_trailer) return enter(grammar, SERVER_GRAMMAR_START);
    if (grammar->has_length && grammar->is_chunked)
        return "Content-Length and Transfer-Encoding exclude each other";
    grammar->heads++;
    return enter(grammar, grammar->is_chunked ? SERVER_GRAMMAR_CHUNK_SIZE
                          : grammar->left     ? SERVER_GRAMMAR_BODY
                                              : SERVER_GRAMMAR_START);
}

/* --- chunks ----------------------------------------------------------------------------------- */

static const char *chunk_size(struct server_grammar *grammar, unsigned char byte)
{
    if (byte < 0x80 && isxdigit(byte)) {
        if (grammar->count++ == SIZE_DIGITS) return "the size of a chunk has too many digits";
        grammar->left =
            grammar->left << 4 | (uint64_t)(isdigit(byte) ? byte - '0' : tolower(byte) - 'a' + 10);
        return NULL;
    }
    if (!grammar->count) return "a chunk begins with no size";
    if (byte == ';') {
        grammar->extra++;
        return enter(grammar, SERVER_GRAMMAR_CHUNK_EXTENSION);
    }
    return byte == '\r' ? enter(grammar, SERVER_GRAMMAR_CHUNK_SIZE_LF)
                        : "the size of a chunk is no hexadecimal number";
}

static const char *chunk_extension(struct server_grammar *grammar, unsigned char byte)
{
    if (byte == '\r') return enter(grammar, SERVER_GRAMMAR_CHUNK_SIZE_LF);
    if ((byte < ' ' && byte != '\t') || byte >= 0x7f)
        return "the extension of a chunk holds a byte that it can't";
    return ++grammar->extra > EXTENSION_BYTES ? "the extensions of chunks are too long" : NULL;
}

static const char *chunk_size_lf(struct server_grammar *grammar, unsigned char byte)
{
    if (byte != '\n') return "a CR stands without its LF";
    if (grammar->left) return enter(grammar, SERVER_GRAMMAR_CHUNK_DATA);
    grammar->in_trailer = true;
    grammar->head = grammar->headers = 0;
    return enter(grammar, SERVER_GRAMMAR_FIELD);
}

static const char *chunk_cr(struct server_grammar *grammar, unsigned char byte)
{
    if (byte != '\r') return "a chunk is not as long as its size says";
    return enter(grammar, SERVER_GRAMMAR_CHUNK_LF);
}

static const char *chunk_lf(struct server_grammar *grammar, unsigned char byte)
{
    if (byte != '\n') return "a CR stands without its LF";
    return enter(grammar, SERVER_GRAMMAR_CHUNK_SIZE);
}

/* --- the whole -------------------------------------------------------------------------------- */

static const struct {
    step_function step; /* NULL: bytes that are counted only */
    const char *ending; /* see server_grammar_ending */
} states[] = {
    [SERVER_GRAMMAR_START] = {start, "GET / HTTP/1.1\r\n\r\n"},
    [SERVER_GRAMMAR_START_LF] = {start_lf, "\nGET / HTTP/1.1\r\n\r\n"},
    [SERVER_GRAMMAR_METHOD] = {method, " / HTTP/1.1\r\n\r\n"},
    [SERVER_GRAMMAR_TARGET] = {target, "/ HTTP/1.1\r\n\r\n"},
    [SERVER_GRAMMAR_VERSION] = {version, " HTTP/1.1\r\n\r\n"},
    [SERVER_GRAMMAR_LINE_LF] = {line_lf, "\n\r\n"},
    [SERVER_GRAMMAR_FIELD] = {field, "\r\n"},
    [SERVER_GRAMMAR_NAME] = {name, "-:\r\n\r\n"}, /* no name that counts */
    [SERVER_GRAMMAR_VALUE] = {value, "\r\n\r\n"},
    [SERVER_GRAMMAR_VALUE_LF] = {value_lf, "\n\r\n"},
    [SERVER_GRAMMAR_END_LF] = {end_lf, "\n"},
    [SERVER_GRAMMAR_BODY] = {NULL, ""},
    [SERVER_GRAMMAR_CHUNK_SIZE] = {chunk_size, "@\r\n\r\n"},
    [SERVER_GRAMMAR_CHUNK_EXTENSION] = {chunk_extension, ""},
    [SERVER_GRAMMAR_CHUNK_SIZE_LF] = {chunk_size_lf, "@\r\n\r\n"},
    [SERVER_GRAMMAR_CHUNK_DATA] = {NULL, ""},
    [SERVER_GRAMMAR_CHUNK_CR] = {chunk_cr, "@\r\n\r\n"},
    [SERVER_GRAMMAR_CHUNK_LF] = {chunk_lf, "@\r\n\r\n"},
};

/* Passes over bytes of a body or a chunk; returns how many. */
static size_t skip(struct server_grammar *grammar, size_t size)
{
    size_t skipped = grammar->left < size ? (size_t)grammar->left : size;
    grammar->left -= skipped;
    if (!grammar->left)
        enter(grammar, grammar->state == SERVER_GRAMMAR_BODY ? SERVER_GRAMMAR_START
                                                             : SERVER_GRAMMAR_CHUNK_CR);
    return skipped;
}

/* Passes over bytes of a target, or of a value that says nothing here, as their steps would, up to
 * where those would look for an excess; returns how many. */
static size_t run(struct server_grammar *grammar, const char *bytes, size_t size)
{
    bool is_target = grammar->state == SERVER_GRAMMAR_TARGET,
         is_value = grammar->state == SERVER_GRAMMAR_VALUE,
         is_other =
             grammar->header == SERVER_GRAMMAR_OTHER || grammar->header == SERVER_GRAMMAR_HOST;
    if (!is_target && !(is_value && is_other)) return 0;
    unsigned class = is_target ? IN_TARGET : IN_VALUE,
             before = grammar->count + (is_target ? 0 : grammar->head),
             most = is_target ? SERVER_GRAMMAR_TARGET_MOST : SERVER_GRAMMAR_HEAD_MOST;
    size_t passed = 0, room = before < most ? most - before : 0;
    if (room > size) room = size;
    while (room - passed >= 8 && server_eight_are_visible(bytes + passed, '#', '#')) passed += 8;
    while (passed < room && classes[(unsigned char)bytes[passed]] & class) passed++;
    grammar->count += (unsigned)passed;
    return passed;
}

/* Passes over the version that nearly all requests have. */
static size_t pass_version(struct server_grammar *grammar, const char *bytes, size_t size)
{
    if (grammar->state != SERVER_GRAMMAR_VERSION || grammar->count || size < VERSION_BYTES)
        return 0;
    if (memcmp(bytes, "HTTP/1.1", VERSION_BYTES) != 0) return 0;
    grammar->count = VERSION_BYTES;
    return VERSION_BYTES;
}

size_t server_grammar_follow(struct server_grammar *grammar, const char *bytes, size_t size)
{
    size_t at = 0;
    while (at < size && !grammar->fault) {
        const enum server_grammar_state before = grammar->state;
        if (!states[grammar->state].step) {
            at += skip(grammar, size - at);
            continue;
        }
        at += pass_version(grammar, bytes + at, size - at);
        at += run(grammar, bytes + at, size - at);
        if (at == size) break;
        grammar->fault = states[grammar->state].step(grammar, (unsigned char)bytes[at]);
        if (grammar->fault)
            grammar->state = before;
        else
            at++;
    }
    return at;
}

bool server_grammar_is_in_head(const struct server_grammar *grammar)
{
    return grammar->state > SERVER_GRAMMAR_START && grammar->state <= SERVER_GRAMMAR_END_LF &&
           !grammar->in_trailer;
}

/* libmicrohttpd 0.9.75 answers a wrong Content-Length itself, and writes that answer's head twice;
 * with a coding it does not read the length. */
static const char *end_value(const struct server_grammar *grammar)
{
    return grammar->header == SERVER_GRAMMAR_LENGTH ? "\r\nTransfer-Encoding: chunked\r\n\r\n"
                                                    : states[SERVER_GRAMMAR_VALUE].ending;
}

const char *server_grammar_ending(const struct server_grammar *grammar)
{
    const char *ending = states[grammar->state].ending;
    bool is_field =
        grammar->state >= SERVER_GRAMMAR_FIELD && grammar->state <= SERVER_GRAMMAR_END_LF;
    if (grammar->in_trailer && is_field)
        return grammar->state == SERVER_GRAMMAR_FIELD ? "@\r\n" : "\r\n@\r\n\r\n";
    if (grammar->state == SERVER_GRAMMAR_VALUE) return end_value(grammar);
    if (grammar->state == SERVER_GRAMMAR_CHUNK_SIZE_LF && grammar->extra)
        return ""; /* the library looks for a LF only */
    if (grammar->state == SERVER_GRAMMAR_VERSION && grammar->count == VERSION_BYTES)
        return "\r\n\r\n";
    return grammar->state == SERVER_GRAMMAR_TARGET && grammar->count ? " HTTP/1.1\r\n\r\n" : ending;
}
