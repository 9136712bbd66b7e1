/* Exact run: the main function of programs that compare many random answers with exact ones.
 *
 *     test_exact_X                          runs each section in short form, as cmocka tests
 *     test_exact_X --long [SECTION...]      runs the long form on all processors; prints rows for
 *                                           tests/fault/table.py
 *         --count N  --jobs N  --first N    how many answers and processes; the first scene
 *         --cases FOLDER                    writes the meshes and points of failures there
 *     test_exact_X --replay SECTION SCENE   runs one scene and describes each of its failures
 *     test_exact_X --ask MESH POINT... --to POINT
 *                                           prints the distances of the engine and the solver
 *
 * A point is v:VERTEX, e:FROM,TO,T or f:FACE,W0,W1,W2. */
#pragma once

#include "tests/support/exact.h"

/* Results of one section. A field, a path or a curve counts once, however many of its values are
 * wrong. */
struct exact_tally {
    uint64_t asked, failed, wrong;
    /* number of units that are wrong only within 1e-6 edge lengths of a source */
    uint64_t wrong_near;
    double worst; /* largest relative error, except within 1e-6 edge lengths of a source */
    double worst_near;
    uint64_t scene; /* the current scene */
};

enum exact_flag {
    EXACT_HOLDS,
    EXACT_MAY_FAIL /* the section may have failed calls, which are counted, but no wrong values */
};

struct exact_section {
    const char *name, *promise;
    void (*run)(uint64_t scene, struct exact_tally *tally); /* tests a scene */
    uint64_t short_count, long_count;                       /* number of units (tally->asked) */
    enum exact_flag flag;
};

int exact_main(int argc, char **argv, const struct exact_section *sections, uint32_t count);

struct exact_answer {
    /* the error divided by the permitted error; the value is wrong if this exceeds 1 */
    double excess;
    double error; /* relative error */
    double answered, expected;
    struct gd_point point;
};

/* One unit of a tally while its values are compared. At first, only the members of the first line
 * are set, and the others are zero. */
struct exact_unit {
    const struct exact_scene *scene;
    const struct gd_seed *seeds; /* the sources, which reports print */
    uint32_t seed_count;
    struct exact_answer worst; /* the value with the largest excess */
    /* the value with the largest excess among values within 1e-6 edge lengths of a source */
    struct exact_answer nearby;
    const char *failure; /* name of the failed call, or NULL if no call failed */
    enum gd_status status;
    struct gd_point failed_at;
};

void exact_answer(struct exact_unit *unit, struct exact_truth *truth, const struct gd_point *point,
                  double distance);
void exact_failure(struct exact_unit *unit, const char *call, enum gd_status status,
                   const struct gd_point *point);

/* Adds a value that a law compares with the value `expected`. `excess` has the meaning of the
 * member in struct exact_answer. */
void exact_law(struct exact_unit *unit, const struct gd_point *point, double answered,
               double expected, double excess);
void exact_conclude(struct exact_unit *unit, struct exact_tally *tally);
