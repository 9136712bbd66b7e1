#include "server/query/edits.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/exchange/metrics.h"
#include "server/surfaces/derived.h"
#include "server/work/budgeted_call.h"
#include "server/work/executor.h"

static bool edits_fail(const struct server_edits *edits, enum gd_status status,
                       const struct gd_detail *detail, struct proto_problem *problem)
{
    if (status == GD_BUDGET) return server_budget_refuse(edits->budget, "the edit", 0, problem);
    return proto_problem_from_status(problem, status, detail);
}

bool server_edits_run(struct server_edits *edits, struct server_monitor *part,
                      struct proto_problem *problem)
{
    struct server_host *host = part->exchange->host;
    const struct gd_mesh *mesh = edits->surface->mesh;
    uint32_t faces = gd_mesh_summary(mesh)->faces;
    struct gd_edit_steps steps = proto_edits_steps(&edits->edits);
    struct gd_detail detail = {.text = ""};
    uint32_t failed = 0;
    struct server_budgeted_call call = {.workspaces = host->workspaces,
                                        .control = server_exchange_control(part),
                                        .grant = gd_edit_cost(faces),
                                        .held = &edits->held};
    edits->budget = host->budget;
    call.control.executor =
        server_executor_start_for(host->workers, faces, part->exchange->job.deadline_ns);
    steps.failed = &failed;
    while (server_budgeted_call_next(&call)) {
        detail.text[0] = '\0'; /* removes the text of an earlier attempt that had less memory */
        call.status = gd_edit_apply(mesh, &steps, &call.control, &edits->edited, &detail);
        if (!call.status) call.kept = edits->edited.bytes;
    }
    server_executor_stop(call.control.executor);
    if (!call.status) return true;
    server_metrics_count_status(host->metrics, call.status);
    edits_fail(edits, call.status, &detail, problem);
    /* the decoder has checked all members but `skip`, which depends on the mesh */
    if (call.status == GD_INVALID_ARGUMENT && !edits->is_upload) {
        char place[PROTO_PLACE];
        proto_place_of_element(place, "/operations", failed);
        proto_problem_at(problem, place);
        proto_problem_descend(problem, "skip");
    }
    return false;
}

void server_edits_free(struct server_edits *edits)
{
    gd_edited_free(&edits->edited);
    if (edits->held) server_budget_give(edits->budget, SERVER_BUDGET_FLIGHT, edits->held);
    edits->held = 0;
}

void server_edits_drop_mesh(struct server_edits *edits)
{
    struct gd_edited *edited = &edits->edited;
    size_t bytes = edited->mesh ? gd_mesh_memsize(edited->mesh) : 0;
    gd_mesh_release(edited->mesh);
    edited->mesh = NULL;
    edited->bytes -= bytes;
    edits->held -= bytes;
    server_budget_give(edits->budget, SERVER_BUDGET_FLIGHT, bytes);
}

/* --- the attachment --------------------------------------------------------------------------- */

static void write_origins(const struct gd_edited *edited, struct server_derived *derived)
{
    double(*items)[4] = (double(*)[4])(derived + 1);
    for (uint32_t i = 0; i < edited->polygons.position_count; i++) {
        const struct gd_origin *origin = &edited->origins[i];
        items[i][0] = origin->face;
        memcpy(&items[i][1], origin->barycentric, sizeof origin->barycentric);
    }
}

static bool write_derived(const struct server_edits *edits, const struct gd_edited *edited,
                          struct server_derived *derived)
{
    const struct server_record *record = edits->surface->record;
    struct proto_writer writer;
    proto_writer_init(&writer, sizeof derived->operations - 1);
    proto_edits_encode(&writer, &edits->edits);
    bool is_written = !writer.failure;
    if (is_written) {
        memcpy(derived->word, SERVER_DERIVED_WORD, sizeof derived->word);
        if (!edits->is_upload) strcpy(derived->mesh, record->name);
        strcpy(derived->etag, record->etag);
        derived->largest_distance = edited->largest_distance;
        memcpy(derived->operations, writer.data, writer.size);
        write_origins(edited, derived);
    }
    proto_writer_free(&writer);
    return is_written;
}

/* --- meshes ----------------------------------------------------------------------------------- */

bool server_edits_add(const struct server_edits *edits, const struct gd_edited *edited,
                      struct server_derived_meshes *meshes, const char *name,
                      struct proto_problem *problem)
{
    size_t size =
        sizeof(struct server_derived) + edited->polygons.position_count * 4 * sizeof(double);
    struct server_attachment attachment;
    if (!server_attachment_create(&attachment, size, edits->budget, problem)) return false;
    if (write_derived(edits, edited, attachment.bytes))
        return server_derived_meshes_add(
            meshes, name,
            &(struct server_derived_source){&edited->polygons, edited->mesh, &attachment}, problem);
    server_attachment_free(&attachment, edits->budget);
    return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
}

/* Splits the result into its components. `held` then counts their memory. */
static bool split(struct server_edits *edits, struct server_monitor *part,
                  struct gd_edited_parts *out, struct proto_problem *problem)
{
    const struct gd_control control = server_exchange_control(part);
    struct gd_detail detail = {.text = ""};
    server_edits_drop_mesh(edits);
    size_t cost = 2 * edits->edited.bytes;
    if (!server_budget_take(edits->budget, SERVER_BUDGET_FLIGHT, cost))
        return server_budget_refuse(edits->budget, "the meshes", cost, problem);
    edits->held += cost;
    enum gd_status status =
        gd_edited_split(&edits->edited, SERVER_DERIVED_MESHES_MOST, &control, out, &detail);
    if (status == GD_TOO_LARGE)
        return proto_problem_exceed(problem, "/split", SERVER_DERIVED_MESHES_MOST,
                                    "%s; keep some of them by components", detail.text);
    return !status || edits_fail(edits, status, &detail, problem);
}

bool server_edits_add_parts(struct server_edits *edits, struct server_monitor *part,
                            struct server_derived_meshes *meshes, const char *name,
                            struct proto_problem *problem)
{
    struct gd_edited_parts parts = {0};
    struct gd_edit_step *last = &edits->edits.steps[edits->edits.count++];
    bool is_good = split(edits, part, &parts, problem);
    for (uint32_t i = 0; is_good && i < parts.count; i++) {
        char numbered[PROTO_MESH_NAME + 16];
        snprintf(numbered, sizeof numbered, "%s-%u", name, i + 1);
        *last = (struct gd_edit_step){.kind = GD_EDIT_COMPONENTS, .components = {1, i}};
        is_good = server_edits_add(edits, &parts.items[i], meshes, numbered, problem);
    }
    gd_edited_parts_free(&parts);
    return is_good;
}
