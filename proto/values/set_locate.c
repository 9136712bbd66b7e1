#include "proto/values/set.h"

#include <stdlib.h>
#include <string.h>

#include "proto/values/curve.h"

/* State of locating a set's members. */
struct locating {
    const struct gd_mesh *mesh;
    const struct proto_set *set;
    const struct gd_control *control;
    struct proto_problem *problem;
    uint32_t boundaries; /* boundaries selected by "all" */
    /* curves of the set, then boundaries; only those that have been resolved */
    struct gd_curve *curves;
    uint32_t curve_count;
};

static enum gd_status fail(const struct locating *locating, enum gd_status status)
{
    proto_problem_from_status(locating->problem, status, NULL);
    return status;
}

/* --- curves ----------------------------------------------------------------------------------- */

static enum gd_status resolve(struct locating *locating, const struct proto_curve *curve)
{
    struct proto_located_curve located;
    struct gd_detail detail = {0};
    if (!proto_curve_locate(locating->mesh, curve, &located, locating->problem))
        return GD_INVALID_ARGUMENT;
    enum gd_status status = proto_curve_resolve(locating->mesh, &located, NULL, locating->control,
                                                &locating->curves[locating->curve_count], &detail);
    if (status)
        proto_curve_fail(&located, status, &detail, locating->problem);
    else
        locating->curve_count++;
    proto_located_curve_free(&located);
    return status;
}

static enum gd_status resolve_curves(struct locating *locating)
{
    const struct proto_set *set = locating->set;
    enum gd_status status = GD_OK;
    locating->curves =
        calloc(set->curve_count + locating->boundaries + (size_t)1, sizeof *locating->curves);
    if (!locating->curves) return fail(locating, GD_NO_MEMORY);
    for (uint32_t i = 0; i < set->curve_count && !status; i++)
        status = resolve(locating, &set->curves[i]);
    for (uint32_t i = 0; i < locating->boundaries && !status; i++)
        status =
            resolve(locating, &(struct proto_curve){.form = PROTO_CURVE_BOUNDARY, .boundary = i});
    return status;
}

/* Counts the boundaries selected by "all". Fails if there are too many, or if there are none and
 * the set has no other member. */
static enum gd_status count_boundaries(struct locating *locating)
{
    const struct proto_set *set = locating->set;
    if (set->all_boundaries) locating->boundaries = gd_mesh_summary(locating->mesh)->boundaries;
    if (locating->boundaries > PROTO_SET_CURVES) {
        proto_problem_set(locating->problem, PROTO_PROBLEM_TOO_LARGE,
                          "the mesh has %u boundaries, more than the %d that a set may have",
                          locating->boundaries, PROTO_SET_CURVES);
        proto_problem_limit(locating->problem, PROTO_SET_CURVES);
        return GD_INVALID_ARGUMENT;
    }
    if (set->point_count + set->curve_count + locating->boundaries) return GD_OK;
    proto_problem_refuse(locating->problem, "/set/boundaries",
                         "the mesh has no boundary, and the set no other member");
    return GD_INVALID_ARGUMENT;
}

/* --- seeds ------------------------------------------------------------------------------------ */

/* Writable arrays of the located set under construction. */
struct layout {
    struct proto_located_set *set;
    struct gd_seed *seeds;
    uint32_t *members, *label_offsets;
    char *labels;
};

static size_t label_size(const struct proto_set *set)
{
    size_t size = 0;
    for (uint32_t i = 0; i < set->point_count + set->curve_count; i++)
        if (set->namings[i].label) size += strlen(set->namings[i].label) + 1;
    return size;
}

static enum gd_status allocate(const struct locating *locating, struct layout *out)
{
    size_t members = (size_t)locating->set->point_count + locating->curve_count,
           seeds = locating->set->point_count, text = label_size(locating->set);
    for (uint32_t i = 0; i < locating->curve_count; i++)
        seeds += gd_curve_seed_count(&locating->curves[i]);
    size_t bytes = sizeof(struct proto_located_set) +
                   seeds * (sizeof(struct gd_seed) + sizeof(uint32_t)) +
                   members * sizeof(uint32_t) + text;
    enum gd_status status =
        seeds > INT32_MAX ? GD_TOO_LARGE : gd_control_afford(locating->control, bytes);
    struct proto_located_set *set = status ? NULL : calloc(1, bytes);
    if (!set) return fail(locating, status ? status : GD_NO_MEMORY);
    struct gd_seed *first = (struct gd_seed *)(set + 1);
    uint32_t *owners = (uint32_t *)(first + seeds), *offsets = owners + seeds;
    *set = (struct proto_located_set){.count = (uint32_t)members,
                                      .seed_count = (uint32_t)seeds,
                                      .seeds = first,
                                      .members = owners,
                                      .label_offsets = offsets,
                                      .labels = (char *)(offsets + members),
                                      .label_size = text,
                                      .bytes = bytes};
    *out = (struct layout){set, first, owners, offsets, (char *)(offsets + members)};
    return GD_OK;
}

static enum gd_status put_points(const struct locating *locating, struct layout *out)
{
    const struct proto_set *set = locating->set;
    double snap_distance;
    for (uint32_t i = 0; i < set->point_count; i++) {
        if (!proto_point_locate(locating->mesh, &set->points[i], &out->seeds[i].point,
                                &snap_distance, locating->problem))
            return GD_INVALID_ARGUMENT;
        out->seeds[i].offset = set->namings[i].offset;
        out->members[i] = i;
    }
    return GD_OK;
}

static void put_curves(const struct locating *locating, struct layout *out)
{
    const struct proto_set *set = locating->set;
    uint32_t at = set->point_count;
    for (uint32_t i = 0; i < locating->curve_count; i++) {
        uint32_t member = set->point_count + i, count = gd_curve_seed_count(&locating->curves[i]);
        gd_curve_seeds(&locating->curves[i], i < set->curve_count ? set->namings[member].offset : 0,
                       out->seeds + at);
        for (uint32_t k = 0; k < count; k++) out->members[at + k] = member;
        out->set->has_segments |= count > 1;
        at += count;
    }
}

static void put_labels(const struct proto_set *set, struct layout *out)
{
    size_t used = 0;
    for (uint32_t i = 0; i < out->set->count; i++) {
        const char *label = i < set->point_count + set->curve_count ? set->namings[i].label : NULL;
        out->label_offsets[i] = label ? (uint32_t)used : UINT32_MAX;
        if (label) used = (size_t)(stpcpy(out->labels + used, label) + 1 - out->labels);
    }
}

enum gd_status proto_set_locate(const struct gd_mesh *mesh, const struct proto_set *set,
                                const struct gd_control *control, struct proto_located_set **out,
                                struct proto_problem *problem)
{
    struct locating locating = {.mesh = mesh, .set = set, .control = control, .problem = problem};
    struct layout layout = {0};
    enum gd_status status = count_boundaries(&locating);
    if (!status) status = resolve_curves(&locating);
    if (!status) status = allocate(&locating, &layout);
    if (!status) status = put_points(&locating, &layout);
    if (!status) put_curves(&locating, &layout);
    if (!status) put_labels(set, &layout);
    for (uint32_t i = 0; i < locating.curve_count; i++) gd_curve_free(&locating.curves[i]);
    free(locating.curves);
    if (status)
        free(layout.set);
    else
        *out = layout.set;
    return status;
}

const char *proto_located_set_label(const struct proto_located_set *set, uint32_t member)
{
    uint32_t at = set->label_offsets[member];
    return at == UINT32_MAX ? NULL : set->labels + at;
}
