/* Fuzzes landmark images in the form of the store. Opened landmarks have only finite numbers, and
 * searches with them read nothing outside the image. The store's checksum, not this code,
 * guarantees that such searches find the right distance. */
#include <math.h>
#include <stdlib.h>

#include "gd/query.h"
#include "tests/fuzz/patched.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char *image(size_t *size)
{
    static char *bytes;
    static size_t length;
    if (!bytes) {
        struct gd_landmarks *landmarks;
        promise(gd_landmarks_build(patched_surface(), 3, NULL, &landmarks) == GD_OK);
        length = gd_landmarks_image_size(landmarks);
        bytes = malloc(length);
        promise(bytes != NULL);
        gd_landmarks_write_image(landmarks, bytes);
        gd_landmarks_release(landmarks);
    }
    *size = length;
    return bytes;
}

/* Searches with damaged landmarks may fail, but must report the failure. */
static void search_with(const struct gd_landmarks *landmarks)
{
    static const double place[3] = {0.2, 0.3, 0.5};
    struct gd_point from, to;
    promise(gd_point_in_face(patched_surface(), (struct gd_face){0}, place, &from, NULL) == GD_OK);
    for (uint32_t face = 1; face < gd_mesh_summary(patched_surface())->faces; face++) {
        struct gd_pair_answer answer = {.distance = -1};
        struct gd_detail detail = {.text = ""};
        promise(gd_point_in_face(patched_surface(), (struct gd_face){face}, place, &to, NULL) ==
                GD_OK);
        enum gd_status status = gd_pair_solve(
            patched_surface(),
            &(struct gd_pair_request){
                .from = &from, .to = &to, .output = GD_PAIR_PATH, .landmarks = landmarks},
            NULL, &answer, &detail);
        promise(status ? detail.text[0] != '\0' : answer.distance > 0 && isfinite(answer.distance));
        gd_pair_answer_free(&answer);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    size_t length, left;
    const char *whole = image(&length);
    char *patched = patched_copy(whole, length, data, size, &left);
    struct gd_landmarks *landmarks = NULL;
    enum gd_status status = gd_landmarks_open_image(patched_surface(), patched, left, &landmarks);
    promise((status == GD_OK) == (landmarks != NULL) && status != GD_INTERNAL);
    if (landmarks) search_with(landmarks);
    gd_landmarks_release(landmarks);
    free(patched);
    return 0;
}
