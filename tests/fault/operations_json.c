/* JSON decoding: jansson allocates through proto/json/parse.c. */
#include "tests/fault/operations.h"

#include <string.h>

#include "proto/json/decode.h"
#include "proto/values/set.h"

static const char text[] =
    "{\"points\":[{\"xyz\":[0.1234567890123456789,1e-300,-2.5],\"max_snap\":"
    "12345678901234567890,\"label\":\"a label of some length, "
    "\\u00e9\\ud83d\\ude00 and escapes: \\\"\\\\\\n\\t, so that the buffer of the parser grows "
    "more than once\",\"offset\":0.25},{\"vertex\":3}],"
    "\"curves\":[{\"points\":[{\"vertex\":1},{\"edge\":[1,2],\"t\":0.5}],\"closed\":true,"
    "\"label\":\"c\"}],\"boundaries\":[0,{\"boundary\":1,"
    "\"offset\":2}]}";

static json_t *document, *curve;

static void open_json(void)
{
    struct proto_problem problem;
    document = proto_decode_document(text, strlen(text), &problem);
    static const char line[] =
        "{\"curve\":{\"points\":[{\"vertex\":1},{\"vertex\":2}],\"closed\":true}}";
    curve = proto_decode_document(line, strlen(line), &problem);
}

static enum gd_status status_of(bool ok, const struct proto_problem *problem)
{
    return ok                                                   ? GD_OK
           : problem->code == PROTO_PROBLEM_INSUFFICIENT_MEMORY ? GD_NO_MEMORY
                                                                : GD_SYNTAX;
}

static void digest_document(struct digest *digest, const void *out)
{
    char *written = json_dumps(*(json_t *const *)out, JSON_SORT_KEYS);
    json_free_t give_back;
    json_get_alloc_funcs(NULL, &give_back);
    digest_bytes(digest, written, strlen(written));
    give_back(written);
}

static void discard_document(void *out)
{
    json_decref(*(json_t **)out);
}

static void digest_set(struct digest *digest, const void *out)
{
    const struct proto_set *set = out;
    digest_number(digest, set->point_count);
    digest_number(digest, set->curve_count);
    for (uint32_t i = 0; i < set->point_count + set->curve_count; i++) {
        const char *label = set->namings[i].label;
        digest_number(digest, set->namings[i].offset);
        if (label) digest_bytes(digest, label, strlen(label));
    }
}

static void discard_set(void *out)
{
    proto_set_free(out);
}

static const struct answer a_document = {sizeof(json_t *), digest_document, discard_document};
static const struct answer a_set = {sizeof(struct proto_set), digest_set, discard_set};

static enum gd_status decode_document(void *out)
{
    struct proto_problem problem;
    json_t *made = proto_decode_document(text, strlen(text), &problem);
    if (made) *(json_t **)out = made;
    return status_of(made, &problem);
}

static enum gd_status refuse_document(void *out)
{
    struct proto_problem problem;
    json_t *made = proto_decode_document(text, strlen(text) - 1, &problem);
    if (made) *(json_t **)out = made;
    return status_of(made, &problem);
}

static enum gd_status decode_set(void *out)
{
    struct proto_problem problem;
    return status_of(proto_set_decode(document, "/set", out, &problem), &problem);
}

static enum gd_status decode_curve(void *out)
{
    struct proto_problem problem;
    return status_of(proto_set_decode_curve(curve, "curve", out, &problem), &problem);
}

static const struct operation items[] = {
    {"JSON document", &a_document, decode_document, GD_OK, NULL},
    {"refuse a JSON document", &a_document, refuse_document, GD_SYNTAX, NULL},
    {"JSON of a set", &a_set, decode_set, GD_OK, NULL},
    {"JSON of a curve", &a_set, decode_curve, GD_OK, NULL},
};

const struct operations json_operations = {open_json, items, COUNT(items)};
