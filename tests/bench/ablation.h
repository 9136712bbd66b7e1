/* Functions of gd_bench ablation. */
#pragma once

#include "tests/bench/paper.h"
#include "tests/bench/trial.h"

/* Sets of methods that are measured. Each set is measured with one list of windows for each
 * half-edge, and with one list for each edge (enum structure). */
enum setting { PLAIN, PLAIN_APART, NO_FILTER, ALL_METHODS, SETTINGS };

const char *setting_name(enum setting setting);
struct gd__variant setting_methods(enum setting setting, enum structure structure);

/* tables.c: prints Table 1, and Tables 2 to 4 from `sources` random sources. */
void ablation_edges(const struct paper_model *model, const struct gd_mesh *mesh);
void ablation_wedges(const struct paper_model *model, const struct gd_mesh *mesh, uint32_t sources);

/* reach.c: prints the work that stopping at a target saves (Property 5), by the target's
 * distance. */
void ablation_reach(const struct paper_model *model, const struct gd_mesh *mesh,
                    enum setting setting, uint32_t sources);

/* agreement.c: checks that every combination of methods gives the same distances. Prints "ok" and
 * "not ok" lines. Returns false if any line is "not ok". */
bool ablation_agreement(void);
