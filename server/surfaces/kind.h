/* Kind: what a surface can be (a mesh, and what else there is), as the hooks by which its files
 * become surfaces. Names, store, registry and the handlers that upload, list, describe and delete
 * know of a kind nothing but these: to add one is a table of hooks, a line in kinds.c and its paths
 * in openapi.yaml. */
#ifndef SERVER_SURFACES_KIND_H
#define SERVER_SURFACES_KIND_H

#include <stddef.h>

#include "gd/status.h"
#include "proto/options.h"
#include "proto/writer.h"
#include "server/store/options.h"

struct server_builder;
struct server_record;
struct server_surface;

/* The bytes of an upload, as far as they say how they are to be read. */
struct server_file {
    const void *bytes;
    size_t size;
    const char *content_type; /* the header; NULL: there was none */
};

struct server_kind {
    const char *word;   /* "mesh": in records and keys, lower-case letters, never changed */
    const char *plural; /* "meshes": in paths, and the name of the list */
    const char *noun;   /* "mesh": in sentences, behind an article */

    /* Writes the one text of what the parameters ask for, which record and entity tag are made of,
     * and refuses parameters that the kind does not have: two uploads with the same text and bytes
     * are the same surface, and the text of options that are added later leaves out what is not
     * asked for. What they leave open `file` shows; NULL: they leave nothing open, since they are a
     * text that this wrote. */
    bool (*read_options)(const struct proto_parameters *parameters, const struct server_file *file,
                         char text[SERVER_OPTIONS], struct proto_problem *problem);

    /* Makes the object of record->size bytes and record->options. Memory is taken from the
     * builder's budget before it is used; what the object holds, `*size` bytes, is left in
     * SERVER_BUDGET_FLIGHT. Else a status and a problem (build.h). */
    enum gd_status (*build)(const struct server_builder *builder,
                            const struct server_record *record, const void *bytes, void **object,
                            size_t *size, struct proto_problem *problem);
    void (*release)(void *object);

    /* Writes the surface as GET answers it: one JSON object, of SERVER_DESCRIPTION_MOST bytes at
     * most. */
    void (*describe)(struct proto_writer *writer, const struct server_surface *surface);

    /* A stored description that is longer than those written now, cut as they are, malloc'ed; NULL:
     * it stays. May be NULL. */
    char *(*shorten)(const char *description);
};

extern const struct server_kind server_kind_mesh, server_kind_nurbs, server_kind_subdivision;

/* All kinds, NULL-terminated (kinds.c). */
extern const struct server_kind *const server_kinds[];

/* By its word, or by its plural; NULL: there is none. */
const struct server_kind *server_kind_by_word(const char *word);
const struct server_kind *server_kind_by_plural(const char *plural);

#endif
