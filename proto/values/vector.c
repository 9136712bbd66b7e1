#include "proto/values/vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generated/requests.h"
#include "proto/json/writer.h"

enum { PLACE = 2 * PROTO_KEPT_PLACE };

void proto_vectors_free(struct proto_vectors *vectors)
{
    free(vectors->segments);
    free(vectors->first);
    free(vectors->factors);
    *vectors = (struct proto_vectors){0};
}

/* --- segments --------------------------------------------------------------------------------- */

static bool decode_length(const json_t *value, const char *place, double *out,
                          struct proto_problem *problem)
{
    if (!proto_decode_number(value, place, "length", out, problem)) return false;
    if (*out >= 0 && *out <= PROTO_VECTOR_LENGTH) return true;
    return proto_problem_refuse_member(problem, place, "length",
                                       "a length is a number from 0 to %g", PROTO_VECTOR_LENGTH);
}

bool proto_segment_decode(const json_t *value, const char *place, struct proto_segment *out,
                          struct proto_problem *problem)
{
    char where[PLACE];
    const json_t *direction = proto_decode_member(value, place, "direction", problem);
    if (!direction) return false;
    snprintf(where, sizeof where, "%s/direction", place);
    out->has_direction = !json_is_null(direction);
    if (out->has_direction && !proto_direction_decode(direction, where, &out->direction, problem))
        return false;
    if (!decode_length(value, place, &out->length, problem)) return false;
    return out->has_direction || out->length == 0 ||
           proto_problem_refuse(problem, where, "only a vector of length 0 has no direction");
}

static bool decode_segments(const json_t *array, const char *place, struct proto_segment *out,
                            struct proto_problem *problem)
{
    static const char *const members[] = {"direction", "length", NULL};
    for (size_t i = 0; i < json_array_size(array); i++) {
        char where[PLACE];
        const json_t *value = json_array_get(array, i);
        snprintf(where, sizeof where, "%s/segments/%zu", place, i);
        if (!proto_decode_object(value, where, members, problem)) return false;
        if (!proto_segment_decode(value, where, &out[i], problem)) return false;
        if (!out[i].has_direction)
            return proto_problem_refuse(problem, where, "a segment has a direction");
    }
    return true;
}

/* --- vectors ---------------------------------------------------------------------------------- */

static bool refuse_number(const char *place, struct proto_problem *problem)
{
    return proto_problem_exceed(problem, place, PROTO_VECTORS,
                                "at most %d are taken here; send fewer", PROTO_VECTORS);
}

bool proto_vector_check(const json_t *value, const char *place, struct proto_problem *problem)
{
    static const char *const members[] = {"direction", "length",    "reason",
                                          "segments",  "cut_locus", NULL};
    bool is_cut;
    if (!proto_decode_object(value, place, members, problem)) return false;
    const json_t *reason = json_object_get(value, "reason");
    if (reason && !json_is_string(reason))
        return proto_problem_refuse_member(problem, place, "reason", "expected a string here");
    return proto_decode_flag(value, place, "cut_locus", &is_cut, problem);
}

/* Returns whether the vector exists. An answer of log has null for a vertex without faces. If there
 * is no path, the direction and the length are null. */
static bool exists(const json_t *value)
{
    const json_t *direction = json_object_get(value, "direction"),
                 *length = json_object_get(value, "length");
    return !json_is_null(value) && !(json_is_null(direction) && json_is_null(length));
}

/* Returns the segments to use, or NULL if the vector's own direction and length are to be used. */
static const json_t *segments_of(const json_t *value, bool is_straight)
{
    return is_straight && json_object_get(value, "direction") ? NULL
                                                              : json_object_get(value, "segments");
}

static void place_of(char place[PROTO_KEPT_PLACE], uint32_t i)
{
    snprintf(place, PROTO_KEPT_PLACE, "/vectors/%u", i);
}

/* Appends the segments of vector i. All vectors together have at most PROTO_VECTORS segments. */
static bool append_vector(const json_t *value, uint32_t i, bool is_straight,
                          struct proto_vectors *vectors, struct proto_problem *problem)
{
    char place[PROTO_KEPT_PLACE];
    place_of(place, i);
    vectors->first[i + 1] = vectors->first[i];
    if (!json_is_null(value) && !proto_vector_check(value, place, problem)) return false;
    if (!exists(value)) return true;
    const json_t *segments = segments_of(value, is_straight);
    size_t count = segments ? json_array_size(segments) : 1;
    if (!count)
        return proto_problem_refuse(problem, place,
                                    "segments is an array of at least one direction and length");
    if (vectors->first[i] + count > PROTO_VECTORS) return refuse_number("/vectors", problem);
    vectors->first[i + 1] += (uint32_t)count;
    struct proto_segment *out = &vectors->segments[vectors->first[i]];
    return segments ? decode_segments(segments, place, out, problem)
                    : proto_segment_decode(value, place, out, problem);
}

static bool decode_list(const json_t *document, bool is_straight, struct proto_vectors *vectors,
                        struct proto_problem *problem)
{
    const json_t *array = proto_decode_member(document, "", "vectors", problem);
    size_t room = 0, count = json_array_size(array);
    if (!array) return false;
    if (!count) return proto_problem_refuse(problem, "/vectors", "name at least one vector");
    if (count > PROTO_VECTORS) return refuse_number("/vectors", problem);
    for (size_t i = 0; i < count; i++)
        room += 1 + json_array_size(json_object_get(json_array_get(array, i), "segments"));
    if (room > PROTO_VECTORS) room = PROTO_VECTORS;
    vectors->count = (uint32_t)count;
    vectors->first = calloc(count + 1, sizeof *vectors->first);
    vectors->segments = malloc(room * sizeof *vectors->segments);
    bool ok = (vectors->first && vectors->segments) ||
              proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < count && ok; i++)
        ok = append_vector(json_array_get(array, i), i, is_straight, vectors, problem);
    return ok;
}

static bool decode_factors(const json_t *document, struct proto_vectors *vectors,
                           struct proto_problem *problem)
{
    if (!json_object_get(document, "combine")) return true;
    vectors->factors = malloc(vectors->count * sizeof *vectors->factors);
    if (!vectors->factors) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    return proto_decode_numbers(document, "", "combine", vectors->count, vectors->factors, problem);
}

/* Checks that each vector of the sum exists and has its own direction and length. */
static bool check_combination(const struct proto_vectors *vectors, struct proto_problem *problem)
{
    for (uint32_t i = 0; vectors->factors && i < vectors->count; i++) {
        uint32_t segments = vectors->first[i + 1] - vectors->first[i];
        if (segments == 1) continue;
        char place[PROTO_KEPT_PLACE];
        place_of(place, i);
        return proto_problem_refuse(
            problem, place, "%s",
            segments ? "segments alone can't be combined; send direction and length as well"
                     : "no path leads there, so there is no vector to combine; leave it out");
    }
    return true;
}

/* Decodes the vectors. If `is_straight`, a vector with its own direction needs no segments. */
static bool decode_vectors(const json_t *document, bool is_straight, struct proto_vectors *out,
                           struct proto_problem *problem)
{
    struct proto_vectors vectors = {0};
    if (decode_list(document, is_straight, &vectors, problem) &&
        decode_factors(document, &vectors, problem) && check_combination(&vectors, problem)) {
        *out = vectors;
        return true;
    }
    proto_vectors_free(&vectors);
    return false;
}

/* --- the requests ----------------------------------------------------------------------------- */

bool proto_exp_decode(const json_t *document, struct proto_exp *out, struct proto_problem *problem)
{
    struct proto_exp_request request;
    struct proto_exp wanted;
    if (!proto_exp_request_decode(document, &request, problem)) return false;
    wanted.start = request.start;
    bool is_combined = json_object_get(document, "combine") != NULL;
    if (!decode_vectors(document, is_combined, &wanted.vectors, problem)) return false;
    *out = wanted;
    return true;
}

static bool decode_targets(const json_t *document, struct proto_points *out,
                           struct proto_problem *problem)
{
    const json_t *to = proto_decode_member(document, "", "to", problem);
    if (!to) return false;
    if (json_is_string(to) && strcmp(json_string_value(to), "all") == 0) return true;
    if (!json_array_size(to))
        return proto_problem_refuse(problem, "/to",
                                    "to is an array of at least one point, or \"all\"");
    if (proto_points_decode(out, to, "/to", PROTO_VECTORS, problem)) return true;
    proto_points_free(out);
    return false;
}

bool proto_log_decode(const json_t *document, struct proto_log *out, struct proto_problem *problem)
{
    struct proto_log_request request;
    struct proto_log log = {0};
    if (!proto_log_request_decode(document, &request, problem) ||
        !decode_targets(document, &log.to, problem))
        return false;
    log.from = request.from;
    log.first_vector_only = request.first_vector_only;
    *out = log;
    return true;
}

bool proto_transport_decode(const json_t *document, struct proto_transport *out,
                            struct proto_problem *problem)
{
    struct proto_transport transport = {0};
    if (!proto_decode_object(document, "", proto_transport_request_members, problem)) return false;
    if (proto_points_decode_member(&transport.ends, document, "/from", problem) &&
        proto_points_decode_member(&transport.ends, document, "/to", problem) &&
        decode_vectors(document, true, &transport.vectors, problem)) {
        *out = transport;
        return true;
    }
    proto_points_free(&transport.ends);
    return false;
}

bool proto_segment_locate(const struct gd_mesh *mesh, const struct gd_point *point,
                          const struct proto_segment *segment, struct gd_vector *out,
                          struct proto_problem *problem)
{
    *out = (struct gd_vector){.length = segment->length};
    if (!segment->has_direction) return true;
    return proto_direction_locate(mesh, point, &segment->direction, &out->direction, problem);
}

/* --- the answers ------------------------------------------------------------------------------ */

static void encode_members(struct proto_writer *writer, const struct gd_direction *direction,
                           double length)
{
    proto_write_key(writer, "direction");
    if (direction)
        proto_direction_encode(writer, direction);
    else
        proto_write_null(writer);
    proto_member_number(writer, "length", length);
    if (isfinite(length)) return;
    proto_member_string(writer, "reason", "no_path");
}

void proto_vector_encode(struct proto_writer *writer, const struct gd_direction *direction,
                         double length)
{
    proto_write_object_begin(writer);
    encode_members(writer, direction, length);
    proto_write_object_end(writer);
}

void proto_log_encode(struct proto_writer *writer, const struct gd_log *log, bool is_cut)
{
    proto_write_object_begin(writer);
    encode_members(writer, log->count ? &log->vector.direction : NULL, log->vector.length);
    if (log->count > 1) {
        proto_member_array(writer, "segments");
        for (uint32_t i = 0; i < log->count; i++)
            proto_vector_encode(writer, &log->segments[i].direction, log->segments[i].length);
        proto_write_array_end(writer);
    }
    if (is_cut) proto_member_bool(writer, "cut_locus", true);
    proto_write_object_end(writer);
}
