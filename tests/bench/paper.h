/* The paper's models and the figures of its tables: Y.-J. Liu, "Exact geodesic metric in 2-manifold
 * triangle meshes using edge-based data structures", Tables 1 to 4. */
#pragma once

#include <stdint.h>

enum structure { HALF_EDGE, EDGE_BASED, STRUCTURES };

struct paper_figures {
    struct {
        uint32_t faces;
        double mean, sigma, max, min; /* edge lengths */
    } edges;                          /* Table 1 */
    double produced[STRUCTURES];      /* Table 2 */
    double kept[STRUCTURES];          /* Table 3 */
    double seconds[STRUCTURES];       /* Table 4 */
};

struct paper_model {
    const char *name;
    const char *sample; /* a sample of that size and kind, for bench_open */
    uint32_t sources;   /* number of sources; the paper always uses 100 */
    uint32_t targets;   /* number of sources in the table of Property 5 */
    const struct paper_figures *printed;
};

extern const struct paper_model paper_models[];
extern const uint32_t paper_model_count;

/* Returns the model of that name, or NULL. */
const struct paper_model *paper_find(const char *name);
