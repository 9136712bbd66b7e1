/* Fuzzes the readers of control meshes: OBJ with its tags, and OpenUSD's attributes as JSON. The
 * first byte selects the scheme and the format. The remaining bytes are the file. An accepted
 * surface is evaluated in the middle of some faces; the results must be finite. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/limit.h"
#include "proto/queries/subdivision.h"
#include "proto/json/writer.h"
#include "tests/fuzz/promise.h"

enum { MOST_FACES = 1000, PLACES = 8 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void evaluate(const struct gd_subdivision *surface)
{
    uint32_t faces = gd_subdivision_summary(surface).face_count;
    promise(faces > 0 && gd_subdivision_memsize(surface) > 0);
    for (uint32_t i = 0; i < PLACES; i++) {
        struct gd_limit_point place = {.face = i * 7 % faces, .u = 0.3, .v = 0.4};
        struct gd_limit_jet jet;
        struct gd_detail detail = {.text = ""};
        enum gd_status status = gd_limit_evaluate(surface, &place, &jet, &detail);
        promise(status ? detail.text[0] != '\0'
                       : isfinite(jet.position.x + jet.position.y + jet.position.z));
    }
}

static void create(const struct gd_control_mesh *control_mesh, enum gd_scheme scheme)
{
    struct gd_subdivision *surface;
    struct gd_detail detail = {.text = ""};
    enum gd_status status = gd_subdivision_create(control_mesh, scheme, NULL, &surface, &detail);
    if (status) {
        promise(status != GD_INTERNAL && detail.text[0] != '\0');
        return;
    }
    evaluate(surface);
    gd_subdivision_release(surface);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct gd_read_options limits = {.max_faces = MOST_FACES,
                                                  .max_vertices = MOST_FACES};
    if (size == 0) return 0;
    const struct proto_subdivision_options options = {
        .format = data[0] & 1 ? GD_FORMAT_ANY : GD_FORMAT_OBJ,
        .has_scheme = data[0] & 2,
        .scheme = data[0] & 4 ? GD_SCHEME_LOOP : GD_SCHEME_CATMULL_CLARK};
    char *file = malloc(size); /* allocates no additional byte, so that overruns are detected */
    promise(file != NULL);
    memcpy(file, data + 1, size - 1);
    struct gd_control_mesh control_mesh;
    struct proto_problem problem;
    enum gd_scheme scheme;
    if (proto_subdivision_read(file, size - 1, &options, &limits, &control_mesh, &scheme,
                               &problem)) {
        create(&control_mesh, scheme);
        gd_control_mesh_free(&control_mesh);
    } else {
        promise(problem.detail[0] != '\0');
    }
    free(file);
    return 0;
}
