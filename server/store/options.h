/* Options: what an upload asked for, as the text that its record keeps, which is written like a
 * query string: "format=obj&triangulate=true". Each kind of surface reads and writes its own
 * (kind.h). */
#ifndef SERVER_STORE_OPTIONS_H
#define SERVER_STORE_OPTIONS_H

#include <stdbool.h>

#include "proto/options.h"

#define SERVER_OPTIONS      256 /* most bytes of the text, with the NUL */
#define SERVER_OPTIONS_MOST 8   /* pairs */

struct server_options {
    char text[SERVER_OPTIONS];
    char *names[SERVER_OPTIONS_MOST], *values[SERVER_OPTIONS_MOST];
    unsigned count;
};

/* Takes a text apart; false: it is none. */
bool server_options_split(const char *text, struct server_options *out);

/* View of the options for proto's decoders; lives as long as they stay where they are. */
struct proto_parameters server_options_parameters(struct server_options *options);

#endif
