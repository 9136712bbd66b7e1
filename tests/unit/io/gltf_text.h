/* Makes glTF documents for tests: unchanged documents, documents with one replaced text, and GLB
 * files. In the texts of the tests, ' stands for ". */
#pragma once

#include "io/base64.h"
#include "tests/unit/io/reading.h"

#define URI "data:application/octet-stream;base64,"

struct file {
    char *bytes; /* owned */
    size_t size;
};

/* Returns the text with the first `find` replaced, and with each ' replaced by ". If `find` is
 * NULL, only the quotes are replaced. */
static inline char *replaced(const char *text, const char *find, const char *by)
{
    size_t room = strlen(text) + (by ? strlen(by) : 0) + 1;
    char *out = malloc(room);
    const char *at = find ? strstr(text, find) : NULL;
    assert_non_null(out);
    if (find && !at) fail_msg("'%s' is not in the document", find);
    if (at)
        snprintf(out, room, "%.*s%s%s", (int)(at - text), text, by, at + strlen(find));
    else
        snprintf(out, room, "%s", text);
    for (char *quote = out; (quote = strchr(quote, '\'')) != NULL;) *quote = '"';
    return out;
}

/* Returns the document with "@" replaced by a data: URI of the bytes. */
static inline struct file gltf_file(const char *document, const void *bytes, size_t size)
{
    size_t length = gd__base64_characters(size);
    char *uri = malloc(sizeof URI + length);
    assert_non_null(uri);
    memcpy(uri, URI, sizeof URI - 1);
    gd__base64_write(bytes, size, uri + sizeof URI - 1);
    uri[sizeof URI - 1 + length] = '\0';
    struct file out = {.bytes = strchr(document, '@') ? replaced(document, "@", uri)
                                                      : replaced(document, NULL, NULL)};
    out.size = strlen(out.bytes);
    free(uri);
    return out;
}

static inline void put_u32(FILE *stream, size_t value)
{
    for (int i = 0; i < 4; i++) fputc((int)(value >> 8 * i & 255), stream);
}

/* Returns the document as GLB with the bytes in its binary chunk. Removes the buffer's URI. */
static inline struct file glb_file(const char *document, const void *bytes, size_t size)
{
    char *json = replaced(document, ",'uri':'@'", "");
    size_t length = strlen(json), padded = (length + 3) & ~(size_t)3;
    struct file out;
    FILE *stream = open_memstream(&out.bytes, &out.size);
    assert_non_null(stream);
    fputs("glTF", stream);
    put_u32(stream, 2);
    put_u32(stream, 12 + 8 + padded + 8 + size);
    put_u32(stream, padded);
    fputs("JSON", stream);
    fprintf(stream, "%s%*s", json, (int)(padded - length), "");
    put_u32(stream, size);
    fwrite("BIN\0", 1, 4, stream);
    fwrite(bytes, 1, size, stream);
    fclose(stream);
    free(json);
    return out;
}

static inline enum gd_status read_file(const struct file *file, struct gd_polygons *out,
                                       struct gd_detail *detail)
{
    return read_copy(file->bytes, file->size, GD_FORMAT_ANY, NULL, out, detail);
}

/* Reads the file and compares the mesh, as text, with `mesh`. Frees the file. */
static inline void check_file(struct file file, const char *mesh)
{
    struct gd_polygons polygons;
    struct gd_detail detail = {.text = ""};
    enum gd_status status = read_file(&file, &polygons, &detail);
    if (status != GD_OK) fail_msg("%s: %s", gd_status_name(status), detail.text);
    char *text = mesh_text(&polygons);
    assert_string_equal(text, mesh);
    free(text);
    gd_polygons_free(&polygons);
    free(file.bytes);
}
