/* Exact run: the main function of programs that compare many random answers with exact ones.
 *
 *     test_exact_X                          each section in its short form, as cmocka tests
 *     test_exact_X --long [SECTION...]      ... in its long form, on all processors; prints rows
 *                                           for tests/fault/table.py
 *         --count N  --jobs N  --first N    number of answers, of processes, of the first scene
 *         --cases FOLDER                    meshes and points of what fails are written there
 *     test_exact_X --replay SECTION SCENE   one scene, and each of its failures in words
 *     test_exact_X --ask MESH POINT... --to POINT    what the engine and the solver say
 *
 * A point is v:VERTEX, e:FROM,TO,T or f:FACE,W0,W1,W2. */
#ifndef TESTS_SUPPORT_EXACT_RUN_H
#define TESTS_SUPPORT_EXACT_RUN_H

#include "tests/support/exact.h"

/* What was seen of one section. A field, a path, a curve... counts once, however many of its
 * answers are wrong. */
struct exact_tally {
    uint64_t asked, failed, wrong;
    uint64_t wrong_near; /* of the others: at points less than 1e-6 edge lengths away */
    double worst;        /* greatest relative error of what was answered, but for near points */
    double worst_near;
    uint64_t scene; /* that is under way */
};

enum exact_flag {
    EXACT_HOLDS,
    EXACT_MAY_FAIL /* errors are counted, and allowed; wrong answers are not */
};

struct exact_section {
    const char *name, *promise;
    void (*run)(uint64_t scene, struct exact_tally *tally); /* of one scene; adds to the tally */
    uint64_t short_count, long_count;                       /* of tally->asked */
    enum exact_flag flag;
};

int exact_main(int argc, char **argv, const struct exact_section *sections, uint32_t count);

struct exact_answer {
    double excess; /* error over the one that is allowed: wrong above 1 */
    double error;  /* relative */
    double answered, expected;
    struct gd_point point;
};

/* One unit of a tally while its answers come in. All zero but for the first line. */
struct exact_unit {
    const struct exact_scene *scene;
    const struct gd_seed *seeds; /* the sources, for reports */
    uint32_t seed_count;
    struct exact_answer worst;  /* of greatest excess */
    struct exact_answer nearby; /* the same of points less than 1e-6 edge lengths away */
    const char *failure;        /* a call's name, NULL: none failed */
    enum gd_status status;
    struct gd_point failed_at;
};

void exact_answer(struct exact_unit *unit, struct exact_truth *truth, const struct gd_point *point,
                  double distance);
void exact_failure(struct exact_unit *unit, const char *call, enum gd_status status,
                   const struct gd_point *point);

/* An answer that some law sets against another one, `expected`; `excess` as in struct
 * exact_answer. */
void exact_law(struct exact_unit *unit, const struct gd_point *point, double answered,
               double expected, double excess);
void exact_conclude(struct exact_unit *unit, struct exact_tally *tally);

#endif
