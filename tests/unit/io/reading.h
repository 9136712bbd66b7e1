/* Helpers of the tests of readers. Tables have inputs with the expected mesh or error.
 *
 * Meshes are compared as text in the form "x y z; x y z | i j k; i j k l". Vertices are before the
 * bar, and polygons are after it. */
#pragma once

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/io.h"

#define COUNT_OF(array) (sizeof(array) / sizeof(array)[0])

/* Pointer and size of a string literal, which may contain NULs. */
#define BYTES(literal) (literal), sizeof(literal) - 1

struct good_input {
    const char *bytes;
    size_t size;
    const char *mesh;
};

struct bad_input {
    const char *bytes;
    size_t size;
    enum gd_status status;
    /* the expected line or byte; 0 if the error has no place or the place is not checked */
    uint64_t place;
    const char *says; /* part of the expected message, or NULL if the message is not checked */
};

/* Reads an exact copy of the bytes, so that AddressSanitizer detects reads beyond them. */
static inline enum gd_status read_copy(const char *bytes, size_t size, enum gd_format format,
                                       const struct gd_read_options *limits,
                                       struct gd_polygons *out, struct gd_detail *detail)
{
    char *copy = malloc(size ? size : 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    struct gd_read_options options = limits ? *limits : (struct gd_read_options){0};
    options.format = format;
    enum gd_status status = gd_read_polygons(copy, size, &options, out, detail);
    free(copy);
    return status;
}

/* Returns the mesh as text; the caller frees it. */
static inline char *mesh_text(const struct gd_polygons *polygons)
{
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    for (uint32_t i = 0; i < polygons->position_count; i++) {
        const double *xyz = polygons->positions[i];
        fprintf(stream, "%s%.17g %.17g %.17g", i ? "; " : "", xyz[0], xyz[1], xyz[2]);
    }
    fprintf(stream, " |");
    for (uint32_t i = 0; i < polygons->polygon_count; i++) {
        if (i) fputc(';', stream);
        for (uint32_t c = gd_polygons_first(polygons, i); c < gd_polygons_first(polygons, i + 1);
             c++) {
            fprintf(stream, " %u", polygons->corners[c]);
        }
    }
    fclose(stream);
    return text;
}

static inline void check_good(enum gd_format format, const struct good_input *inputs, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        struct gd_polygons polygons;
        struct gd_detail detail = {.text = ""};
        enum gd_status status =
            read_copy(inputs[i].bytes, inputs[i].size, format, NULL, &polygons, &detail);
        if (status != GD_OK) fail_msg("input %zu: %s: %s", i, gd_status_name(status), detail.text);
        char *text = mesh_text(&polygons);
        if (strcmp(text, inputs[i].mesh) != 0)
            fail_msg("input %zu: read '%s', not '%s'", i, text, inputs[i].mesh);
        free(text);
        gd_polygons_free(&polygons);
    }
}

static inline void check_bad(enum gd_format format, const struct bad_input *inputs, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct bad_input *input = &inputs[i];
        struct gd_polygons untouched = {.position_count = 77}, polygons = untouched;
        struct gd_detail detail = {.text = ""};
        enum gd_status status =
            read_copy(input->bytes, input->size, format, NULL, &polygons, &detail);
        if (status != input->status) {
            fail_msg("input %zu: %s ('%s'), not %s", i, gd_status_name(status), detail.text,
                     gd_status_name(input->status));
        }
        assert_memory_equal(&polygons, &untouched, sizeof polygons);
        if (detail.text[0] == '\0') fail_msg("input %zu: no sentence", i);
        if (input->place && (detail.total != 1 || detail.elements[0][0] != input->place)) {
            fail_msg("input %zu: '%s' should be at %llu", i, detail.text,
                     (unsigned long long)input->place);
        }
        if (input->says && !strstr(detail.text, input->says)) {
            fail_msg("input %zu: '%s' should say '%s'", i, detail.text, input->says);
        }
    }
}

struct skipped_input {
    const char *bytes;
    size_t size;
    const char *mesh;
    /* the number of skipped elements, and the line or byte of the first skipped element */
    uint32_t count, place;
};

/* Checks that each input is rejected without a counter for skipped elements, and is read with such
 * a counter. */
static inline void check_skipped(enum gd_format format, const struct skipped_input *inputs,
                                 size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct skipped_input *input = &inputs[i];
        struct gd_mended skipped = {0};
        struct gd_polygons polygons = {0};
        struct gd_detail detail = {.text = ""};
        enum gd_status status =
            read_copy(input->bytes, input->size, format, NULL, &polygons, &detail);
        if (status != GD_SYNTAX || !strstr(detail.text, "repair=split"))
            fail_msg("input %zu: %s ('%s')", i, gd_status_name(status), detail.text);
        const struct gd_read_options options = {.skipped = &skipped};
        status = read_copy(input->bytes, input->size, format, &options, &polygons, &detail);
        if (status != GD_OK) fail_msg("input %zu: %s: %s", i, gd_status_name(status), detail.text);
        char *text = mesh_text(&polygons);
        assert_string_equal(text, input->mesh);
        assert_int_equal(skipped.count, input->count);
        assert_int_equal(skipped.elements[0][0], input->place);
        free(text);
        gd_polygons_free(&polygons);
    }
}

/* Checks that every prefix of every valid input is read or refused with a message, and that format
 * recognition is safe for it. */
static inline void check_truncations(enum gd_format format, const struct good_input *inputs,
                                     size_t count)
{
    for (size_t i = 0; i < count; i++) {
        for (size_t size = 0; size < inputs[i].size; size++) {
            for (int any = 0; any < 2; any++) {
                struct gd_polygons polygons = {0};
                struct gd_detail detail = {.text = ""};
                enum gd_status status = read_copy(
                    inputs[i].bytes, size, any ? GD_FORMAT_ANY : format, NULL, &polygons, &detail);
                if (status == GD_OK)
                    assert_true(polygons.polygon_count > 0);
                else
                    assert_true(detail.text[0] != '\0' && status != GD_INTERNAL &&
                                status != GD_NO_MEMORY);
                gd_polygons_free(&polygons);
            }
        }
    }
}
