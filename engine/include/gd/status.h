/* Status codes of all fallible functions of the engine: one list of codes, names and sentences.
 *
 * Zero is success. Numbers are never reused. The HTTP API returns the name as the `reason` of a
 * rejected mesh. On failure the outputs of a function are untouched; details go into a struct of
 * the caller, never into a global. */
#ifndef GD_STATUS_H
#define GD_STATUS_H

#include <stdint.h>

#include "gd/language.h"

GD_EXTERN_C_BEGIN

/* X(number, NAME, name, sentence) */
#define GD_STATUS_MAP(X)                                                                           \
    X(0, OK, ok, "success")                                                                        \
    /* the caller's request */                                                                     \
    X(1, INVALID_ARGUMENT, invalid_argument, "an argument is outside its documented domain")       \
    X(2, OUT_OF_RANGE, out_of_range, "an index names no element of the mesh")                      \
    X(3, NOT_ON_SURFACE, not_on_surface, "the point does not lie on the surface")                  \
    X(4, UNREFERENCED_VERTEX, unreferenced_vertex, "the vertex belongs to no face")                \
    X(5, NO_SUCH_EDGE, no_such_edge, "the two vertices share no edge")                             \
    X(6, BEYOND_REACH, beyond_reach, "the field was not computed as far as that point")            \
    /* the data: a file or mesh that is rejected */                                                \
    X(20, UNRECOGNIZED, unrecognized, "the bytes are in no known mesh format")                     \
    X(21, TRUNCATED, truncated, "the input ends before what it declares")                          \
    X(22, SYNTAX, syntax, "the input breaks the rules of its format")                              \
    X(23, UNSUPPORTED, unsupported,                                                                \
      "the input uses a feature of its format that is not supported")                              \
    X(24, INDEX, index, "a face names a vertex that does not exist")                               \
    X(25, EMPTY, empty, "the input has no faces")                                                  \
    X(26, NON_FINITE, non_finite, "a coordinate is not a finite number")                           \
    X(27, EXTENT, extent, "the coordinates' extent is too large or too small to compute with")     \
    X(28, DEGENERATE_FACE, degenerate_face,                                                        \
      "a face repeats a vertex or has an edge of length zero")                                     \
    X(29, DUPLICATE_FACE, duplicate_face, "two faces have the same vertices")                      \
    X(30, NON_MANIFOLD_EDGE, non_manifold_edge, "an edge belongs to more than two faces")          \
    X(31, NON_MANIFOLD_VERTEX, non_manifold_vertex,                                                \
      "the faces around a vertex form more than one fan")                                          \
    X(32, NON_ORIENTABLE, non_orientable, "a component has no consistent orientation")             \
    X(33, NOT_TRIANGLES, not_triangles, "a face is not a triangle and triangulation was refused")  \
    X(34, NOT_TRIANGULABLE, not_triangulable,                                                      \
      "a polygon can't be split by diagonals that are not edges already")                          \
    /* resources */                                                                                \
    X(50, NO_MEMORY, no_memory, "the system is out of memory")                                     \
    X(51, BUDGET, budget, "the byte budget does not allow it")                                     \
    X(52, TOO_LARGE, too_large, "the input has more elements than the configured maximum")         \
    /* control */                                                                                  \
    X(60, CANCELLED, cancelled, "the caller cancelled the work")                                   \
    X(61, DEADLINE, deadline, "the deadline passed")                                               \
    /* the engine's own failures */                                                                \
    X(80, INTERNAL, internal, "a self-check failed")                                               \
    X(81, RUNAWAY, runaway,                                                                        \
      "the work grew far beyond what a surface of this size needs, and was stopped")

enum gd_status {
#define GD_STATUS_ENUM(number, NAME, name, sentence) GD_##NAME = (number),
    GD_STATUS_MAP(GD_STATUS_ENUM)
#undef GD_STATUS_ENUM
};

#define GD_MUST_USE __attribute__((warn_unused_result))

/* Return the name of a status in snake_case ("non_manifold_edge"), and its sentence, as static
 * strings; "unknown" for an undefined number. Thread-safe. */
const char *gd_status_name(enum gd_status status);
const char *gd_status_sentence(enum gd_status status);

/* The kind of a detail's elements. Vertices and faces are numbered as in the caller's input; an
 * edge is named by its two vertices. */
enum gd_element {
    GD_ELEMENT_NONE,
    GD_ELEMENT_VERTEX,
    GD_ELEMENT_EDGE,
    GD_ELEMENT_FACE,
    GD_ELEMENT_LINE,
    GD_ELEMENT_BYTE
};

#define GD_DETAIL_ELEMENTS 8
#define GD_DETAIL_TEXT     200

/* Details of a failure. A function fills the struct if the caller passes one. It is untouched on
 * success. */
struct gd_detail {
    enum gd_element kind;
    uint64_t total; /* number of offending elements */
    /* number of listed elements, at most GD_DETAIL_ELEMENTS */
    uint32_t count;
    /* the first offending elements; [1] is only used for edges */
    uint64_t elements[GD_DETAIL_ELEMENTS][2];
    /* a sentence for users, NUL-terminated; may be empty */
    char text[GD_DETAIL_TEXT];
};

/* Formats a sentence into `detail` (may be NULL), without elements. Returns `status`, for use in a
 * return statement. */
enum gd_status gd_fail(struct gd_detail *detail, enum gd_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Calls gd_fail with the sentence of the status, gd_status_sentence. */
enum gd_status gd_fail_status(struct gd_detail *detail, enum gd_status status);

/* Counts an offending element in `detail` (may be NULL), and lists it if it is among the first
 * GD_DETAIL_ELEMENTS. */
void gd_detail_add(struct gd_detail *detail, enum gd_element kind, uint64_t a, uint64_t b);

GD_EXTERN_C_END

#endif
