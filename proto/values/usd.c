#include "proto/values/usd.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/decode.h"

#define MOST_INDICES (UINT32_C(1) << 30)

bool proto_usd_is(const void *bytes, size_t size)
{
    static const char name[] = "\"faceVertexIndices\"";
    return size && memmem(bytes, size, name, sizeof name - 1) != NULL;
}

/* --- arrays of numbers ------------------------------------------------------------------------ */

struct indices { /* all zero: empty */
    uint32_t *items;
    uint32_t count;
};

struct reals {
    double *items;
    uint32_t count;
};

/* Allocates room for a member's numbers, of `size` bytes each, and one more. Returns NULL if the
 * member is missing, or with a problem and `*ok` false. */
static void *make_room(const json_t *document, const char *member, size_t size, uint32_t *count,
                       bool *ok, struct proto_problem *problem)
{
    const json_t *array = json_object_get(document, member);
    *ok = true;
    if (!array) return NULL;
    if (!json_is_array(array) || json_array_size(array) >= MOST_INDICES) {
        *ok = proto_problem_refuse_member(problem, "", member, "expected an array of numbers");
        return NULL;
    }
    *count = (uint32_t)json_array_size(array);
    void *items = malloc((*count + (size_t)1) * size);
    if (!items) *ok = proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    return items;
}

/* Reads a list of indices. The caller frees it also on failure. */
static bool read_indices(const json_t *document, const char *member, struct indices *out,
                         struct proto_problem *problem)
{
    bool ok;
    out->items = make_room(document, member, sizeof *out->items, &out->count, &ok, problem);
    return out->items ? proto_decode_indices(document, "", member, out->count, out->items, problem)
                      : ok;
}

static bool read_reals(const json_t *document, const char *member, struct reals *out,
                       struct proto_problem *problem)
{
    bool ok;
    out->items = make_room(document, member, sizeof *out->items, &out->count, &ok, problem);
    return out->items ? proto_decode_numbers(document, "", member, out->count, out->items, problem)
                      : ok;
}

/* --- polygons --------------------------------------------------------------------------------- */

static bool refuse_flaw(enum gd_status status, const char *place, const char *sentence,
                        struct proto_problem *problem)
{
    struct gd_detail detail = {0};
    (void)gd_fail(&detail, status, "%s", sentence);
    proto_problem_from_status(problem, status, &detail);
    return proto_problem_at(problem, place);
}

static bool check_limit(uint64_t count, uint32_t most, const char *place,
                        struct proto_problem *problem)
{
    if (most == 0 || count <= most) return true;
    refuse_flaw(GD_TOO_LARGE, place,
                "the control mesh has more elements than the configured maximum", problem);
    return proto_problem_limit(problem, most);
}

static bool read_points(const json_t *document, const struct gd_read_options *limits,
                        struct gd_polygons *out, struct proto_problem *problem)
{
    const json_t *array = proto_decode_member(document, "", "points", problem);
    if (!array) return false;
    if (!json_is_array(array))
        return proto_problem_refuse(problem, "/points", "expected an array of [x, y, z]");
    size_t count = json_array_size(array);
    if (!check_limit(count, limits && limits->max_vertices ? limits->max_vertices : MOST_INDICES,
                     "/points", problem))
        return false;
    out->positions = malloc((count + 1) * sizeof *out->positions);
    if (!out->positions) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    out->position_count = (uint32_t)count;
    for (size_t i = 0; i < count; i++) {
        char place[40];
        if (proto_read_numbers(json_array_get(array, i), 3, out->positions[i])) continue;
        snprintf(place, sizeof place, "/points/%zu", i);
        return proto_problem_refuse(problem, place, "expected [x, y, z]");
    }
    return true;
}

/* Sums the polygons' corner counts to offsets; the total must be `corner_count`. */
static bool sum_counts(const struct indices *counts, uint32_t corner_count, struct gd_polygons *out,
                       struct proto_problem *problem)
{
    uint64_t sum = 0;
    out->first = malloc((counts->count + (size_t)1) * sizeof *out->first);
    if (!out->first) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < counts->count && sum <= corner_count; i++) {
        out->first[i] = (uint32_t)sum;
        sum += counts->items[i];
    }
    if (sum != corner_count)
        return proto_problem_refuse(problem, "/faceVertexCounts",
                                    "the faces have %s corners than faceVertexIndices has members",
                                    sum > corner_count ? "more" : "fewer");
    out->first[counts->count] = corner_count;
    out->polygon_count = counts->count;
    return true;
}

static bool check_corners(const struct gd_polygons *polygons, uint32_t corner_count,
                          struct proto_problem *problem)
{
    char place[48];
    for (uint32_t i = 0; i < corner_count; i++) {
        if (polygons->corners[i] < polygons->position_count) continue;
        snprintf(place, sizeof place, "/faceVertexIndices/%u", i);
        return refuse_flaw(GD_INDEX, place, "a face names a vertex that does not exist", problem);
    }
    return true;
}

static bool read_faces(const json_t *document, const struct gd_read_options *limits,
                       struct gd_polygons *out, struct proto_problem *problem)
{
    struct indices counts = {0}, corners = {0};
    if (!proto_decode_member(document, "", "faceVertexCounts", problem) ||
        !proto_decode_member(document, "", "faceVertexIndices", problem))
        return false;
    bool ok = read_indices(document, "faceVertexCounts", &counts, problem) &&
              read_indices(document, "faceVertexIndices", &corners, problem);
    out->corners = corners.items;
    ok = ok && sum_counts(&counts, corners.count, out, problem) &&
         check_corners(out, corners.count, problem);
    uint64_t triangles =
        corners.count > 2 * (uint64_t)counts.count ? corners.count - 2 * (uint64_t)counts.count : 0;
    free(counts.items);
    if (!ok) return false;
    if (out->polygon_count == 0)
        return refuse_flaw(GD_EMPTY, "/faceVertexCounts", "the input has no faces", problem);
    return check_limit(triangles, limits ? limits->max_faces : 0, "/faceVertexCounts", problem);
}

/* --- tags ------------------------------------------------------------------------------------- */

struct chains {
    struct indices vertices, lengths;
    struct reals sharpnesses;
};

static void chains_free(struct chains *chains)
{
    free(chains->vertices.items);
    free(chains->lengths.items);
    free(chains->sharpnesses.items);
}

/* Sums the lengths and the edges of the chains, and checks them. */
static bool check_chains(const struct chains *chains, uint32_t *edges,
                         struct proto_problem *problem)
{
    uint64_t sum = 0;
    char place[40];
    for (uint32_t i = 0; i < chains->lengths.count; i++) {
        sum += chains->lengths.items[i];
        if (chains->lengths.items[i] >= 2) continue;
        snprintf(place, sizeof place, "/creaseLengths/%u", i);
        return proto_problem_refuse(problem, place, "a crease has at least two vertices");
    }
    if (sum != chains->vertices.count)
        return proto_problem_refuse(problem, "/creaseLengths",
                                    "they add up to %llu, and creaseIndices has %u members",
                                    (unsigned long long)sum, chains->vertices.count);
    *edges = chains->vertices.count - chains->lengths.count;
    if (chains->sharpnesses.count == chains->lengths.count || chains->sharpnesses.count == *edges)
        return true;
    return proto_problem_refuse(
        problem, "/creaseSharpnesses",
        "expected a sharpness for each of the %u creases, or for each of their %u edges",
        chains->lengths.count, *edges);
}

static bool make_creases(const struct chains *chains, struct gd_control_mesh *out,
                         struct proto_problem *problem)
{
    uint32_t edges = 0;
    if (!check_chains(chains, &edges, problem)) return false;
    out->creases = malloc((edges + (size_t)1) * sizeof *out->creases);
    if (!out->creases) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    bool each = chains->sharpnesses.count == edges;
    const uint32_t *vertex = chains->vertices.items;
    for (uint32_t chain = 0; chain < chains->lengths.count; chain++, vertex++) {
        for (uint32_t k = 1; k < chains->lengths.items[chain]; k++, vertex++) {
            uint32_t i = out->crease_count++;
            out->creases[i] = (struct gd_crease){{vertex[0], vertex[1]},
                                                 chains->sharpnesses.items[each ? i : chain]};
        }
    }
    return true;
}

static bool read_creases(const json_t *document, struct gd_control_mesh *out,
                         struct proto_problem *problem)
{
    struct chains chains = {0};
    bool ok = read_indices(document, "creaseIndices", &chains.vertices, problem) &&
              read_indices(document, "creaseLengths", &chains.lengths, problem) &&
              read_reals(document, "creaseSharpnesses", &chains.sharpnesses, problem) &&
              make_creases(&chains, out, problem);
    chains_free(&chains);
    return ok;
}

static bool read_corners(const json_t *document, struct gd_control_mesh *out,
                         struct proto_problem *problem)
{
    struct indices vertices = {0};
    struct reals sharpnesses = {0};
    bool ok = read_indices(document, "cornerIndices", &vertices, problem) &&
              read_reals(document, "cornerSharpnesses", &sharpnesses, problem);
    if (ok && vertices.count != sharpnesses.count)
        ok =
            proto_problem_refuse(problem, "/cornerSharpnesses",
                                 "expected a sharpness for each of the %u corners", vertices.count);
    if (ok) out->corners = malloc((vertices.count + (size_t)1) * sizeof *out->corners);
    if (ok && !out->corners) ok = proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; ok && i < vertices.count; i++)
        out->corners[i] = (struct gd_corner){vertices.items[i], sharpnesses.items[i]};
    if (ok) out->corner_count = vertices.count;
    free(vertices.items);
    free(sharpnesses.items);
    return ok;
}

/* --- words ------------------------------------------------------------------------------------ */

/* Reads one of the words as its index; untouched if the member is missing. */
static bool read_word(const json_t *document, const char *member, const char *const *words,
                      unsigned *out, struct proto_problem *problem)
{
    const json_t *value = json_object_get(document, member);
    if (!value) return true;
    for (unsigned i = 0; words[i] && json_is_string(value); i++) {
        if (strcmp(json_string_value(value), words[i]) != 0) continue;
        *out = i;
        return true;
    }
    return proto_problem_refuse_member(problem, "", member, "expected one of: %s %s %s", words[0],
                                       words[1], words[2] ? words[2] : "");
}

static bool read_words(const json_t *document, struct proto_usd *out, struct proto_problem *problem)
{
    static const char *const boundaries[] = {[GD_INTERPOLATE_EDGE_AND_CORNER] = "edgeAndCorner",
                                             [GD_INTERPOLATE_EDGE_ONLY] = "edgeOnly",
                                             [GD_INTERPOLATE_NONE] = "none",
                                             NULL};
    static const char *const schemes[] = {
        [GD_SCHEME_CATMULL_CLARK] = "catmullClark", [GD_SCHEME_LOOP] = "loop", NULL};
    unsigned boundary = GD_INTERPOLATE_EDGE_AND_CORNER, scheme = GD_SCHEME_CATMULL_CLARK;
    if (!read_word(document, "interpolateBoundary", boundaries, &boundary, problem) ||
        !read_word(document, "subdivisionScheme", schemes, &scheme, problem))
        return false;
    out->control_mesh.boundary = (enum gd_interpolate_boundary)boundary;
    out->has_scheme = json_object_get(document, "subdivisionScheme") != NULL;
    out->scheme = (enum gd_scheme)scheme;
    return true;
}

/* --- the whole -------------------------------------------------------------------------------- */

static bool read_document(const json_t *document, const struct gd_read_options *limits,
                          struct proto_usd *out, struct proto_problem *problem)
{
    static const char *const members[] = {"points",
                                          "faceVertexCounts",
                                          "faceVertexIndices",
                                          "creaseIndices",
                                          "creaseLengths",
                                          "creaseSharpnesses",
                                          "cornerIndices",
                                          "cornerSharpnesses",
                                          "interpolateBoundary",
                                          "subdivisionScheme",
                                          NULL};
    struct gd_control_mesh *mesh = &out->control_mesh;
    return proto_decode_object(document, "", members, problem) &&
           read_words(document, out, problem) &&
           read_points(document, limits, &mesh->polygons, problem) &&
           read_faces(document, limits, &mesh->polygons, problem) &&
           read_creases(document, mesh, problem) && read_corners(document, mesh, problem);
}

bool proto_usd_read(const void *bytes, size_t size, const struct gd_read_options *limits,
                    struct proto_usd *out, struct proto_problem *problem)
{
    struct proto_usd usd = {0};
    json_t *document =
        proto_decode_document_within(bytes, size, limits ? limits->control : NULL, problem);
    if (!document) return false;
    bool ok = read_document(document, limits, &usd, problem);
    json_decref(document);
    if (ok)
        *out = usd;
    else
        gd_control_mesh_free(&usd.control_mesh);
    return ok;
}
