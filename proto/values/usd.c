#include "proto/values/usd.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generated/requests.h"

#define MOST_INDICES (UINT32_C(1) << 30)

bool proto_usd_is(const void *bytes, size_t size)
{
    static const char name[] = "\"faceVertexIndices\"";
    return size && memmem(bytes, size, name, sizeof name - 1) != NULL;
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
static bool sum_counts(const struct proto_indices *counts, uint32_t corner_count,
                       struct gd_polygons *out, struct proto_problem *problem)
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

/* Moves the corners out of the request. */
static bool make_faces(struct proto_usd_mesh *request, const struct gd_read_options *limits,
                       struct gd_polygons *out, struct proto_problem *problem)
{
    uint64_t corners = request->face_vertex_indices.count,
             ears = 2 * (uint64_t)request->face_vertex_counts.count;
    out->corners = request->face_vertex_indices.items;
    request->face_vertex_indices.items = NULL;
    if (!sum_counts(&request->face_vertex_counts, (uint32_t)corners, out, problem) ||
        !check_corners(out, (uint32_t)corners, problem))
        return false;
    if (out->polygon_count == 0)
        return refuse_flaw(GD_EMPTY, "/faceVertexCounts", "the input has no faces", problem);
    return check_limit(corners > ears ? corners - ears : 0, limits ? limits->max_faces : 0,
                       "/faceVertexCounts", problem);
}

/* --- tags ------------------------------------------------------------------------------------- */

/* Sums the lengths and the edges of the chains, and checks them. */
static bool check_chains(const struct proto_usd_mesh *request, uint32_t *edges,
                         struct proto_problem *problem)
{
    const struct proto_indices *lengths = &request->crease_lengths;
    uint32_t vertices = request->crease_indices.count,
             sharpnesses = request->crease_sharpnesses.count;
    uint64_t sum = 0;
    char place[40];
    for (uint32_t i = 0; i < lengths->count; i++) {
        sum += lengths->items[i];
        if (lengths->items[i] >= 2) continue;
        snprintf(place, sizeof place, "/creaseLengths/%u", i);
        return proto_problem_refuse(problem, place, "a crease has at least two vertices");
    }
    if (sum != vertices)
        return proto_problem_refuse(problem, "/creaseLengths",
                                    "they add up to %llu, and creaseIndices has %u members",
                                    (unsigned long long)sum, vertices);
    *edges = vertices - lengths->count;
    return sharpnesses == lengths->count || sharpnesses == *edges ||
           proto_problem_refuse(
               problem, "/creaseSharpnesses",
               "expected a sharpness for each of the %u creases, or for each of their %u edges",
               lengths->count, *edges);
}

static bool make_creases(const struct proto_usd_mesh *request, struct gd_control_mesh *out,
                         struct proto_problem *problem)
{
    uint32_t edges = 0;
    if (!check_chains(request, &edges, problem)) return false;
    out->creases = malloc((edges + (size_t)1) * sizeof *out->creases);
    if (!out->creases) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    bool each = request->crease_sharpnesses.count == edges;
    const uint32_t *vertex = request->crease_indices.items;
    for (uint32_t chain = 0; chain < request->crease_lengths.count; chain++, vertex++) {
        for (uint32_t k = 1; k < request->crease_lengths.items[chain]; k++, vertex++) {
            uint32_t i = out->crease_count++;
            out->creases[i] = (struct gd_crease){
                {vertex[0], vertex[1]}, request->crease_sharpnesses.items[each ? i : chain]};
        }
    }
    return true;
}

static bool make_corners(const struct proto_usd_mesh *request, struct gd_control_mesh *out,
                         struct proto_problem *problem)
{
    uint32_t count = request->corner_indices.count;
    if (count != request->corner_sharpnesses.count)
        return proto_problem_refuse(problem, "/cornerSharpnesses",
                                    "expected a sharpness for each of the %u corners", count);
    out->corners = malloc((count + (size_t)1) * sizeof *out->corners);
    if (!out->corners) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < count; i++)
        out->corners[i] = (struct gd_corner){request->corner_indices.items[i],
                                             request->corner_sharpnesses.items[i]};
    out->corner_count = count;
    return true;
}

/* --- the whole -------------------------------------------------------------------------------- */

static bool read_document(const json_t *document, const struct gd_read_options *limits,
                          struct proto_usd *out, struct proto_problem *problem)
{
    /* in the order of the contract */
    static const enum gd_interpolate_boundary boundaries[] = {
        GD_INTERPOLATE_EDGE_AND_CORNER, GD_INTERPOLATE_EDGE_ONLY, GD_INTERPOLATE_NONE};
    const struct proto_object object = {document, "", problem};
    struct gd_control_mesh *mesh = &out->control_mesh;
    struct proto_usd_mesh request;
    if (!proto_decode_object(document, "", proto_usd_mesh_members, problem) ||
        !proto_usd_mesh_read(&object, &request))
        return false;
    mesh->boundary = boundaries[request.interpolate_boundary];
    out->has_scheme = proto_object_has(&object, "subdivisionScheme");
    out->scheme = request.subdivision_scheme == PROTO_SUBDIVISION_SCHEME_LOOP
                      ? GD_SCHEME_LOOP
                      : GD_SCHEME_CATMULL_CLARK;
    bool ok = read_points(document, limits, &mesh->polygons, problem) &&
              make_faces(&request, limits, &mesh->polygons, problem) &&
              make_creases(&request, mesh, problem) && make_corners(&request, mesh, problem);
    proto_usd_mesh_free(&request);
    return ok;
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
