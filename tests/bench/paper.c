#include "tests/bench/paper.h"

#include <stddef.h>
#include <string.h>

static const struct paper_figures non_uniform_eight = {
    {2022, 0.079710, 0.032766, 0.260810, 0.020274},
    {21059, 12643},
    {11846, 6481},
    {0.03976, 0.01985}};
static const struct paper_figures uniform_eight = {{2022, 0.068804, 0.007349, 0.103375, 0.042040},
                                                   {19289, 11809},
                                                   {11513, 6578},
                                                   {0.03533, 0.01756}};
static const struct paper_figures non_uniform_sphere = {
    {3996, 0.089625, 0.044386, 0.369710, 0.001317},
    {117045, 101227},
    {53167, 43539},
    {0.18345, 0.11741}};
static const struct paper_figures uniform_sphere = {{4074, 0.085278, 0.007969, 0.148602, 0.073768},
                                                    {116253, 103108},
                                                    {53371, 44468},
                                                    {0.17651, 0.11464}};
static const struct paper_figures non_uniform_teapot = {
    {11666, 0.044716, 0.027207, 0.571824, 0.000994},
    {172111, 129810},
    {80732, 55866},
    {0.30973, 0.17957}};
static const struct paper_figures uniform_teapot = {{11667, 0.042054, 0.012402, 0.103145, 0.002287},
                                                    {165996, 128409},
                                                    {76830, 58304},
                                                    {0.28969, 0.16996}};
static const struct paper_figures angel = {{181147, 0.007005, 0.002620, 0.086559, 0.000011},
                                           {1530506, 935655},
                                           {947923, 504873},
                                           {3.06657, 1.57997}};
static const struct paper_figures girl_head = {{384902, 0.007360, 0.002791, 0.082696, 0.000001},
                                               {3271066, 1972283},
                                               {1995957, 1056117},
                                               {6.70950, 3.47284}};

/* The first eight models approximate the statistics of edges in Table 1. The rough models
 * approximate the number of wedges per edge that the paper prints. */
const struct paper_model paper_models[] = {
    {"non-uniform-eight", "sample:eight,faces=2022,contrast=0.6,passes=0", 100, 30,
     &non_uniform_eight},
    {"uniform-eight", "sample:eight,faces=2022", 100, 30, &uniform_eight},
    {"non-uniform-sphere", "sample:ball,faces=3996,contrast=0.7,passes=0", 100, 30,
     &non_uniform_sphere},
    {"uniform-sphere", "sample:ball,faces=4074", 100, 30, &uniform_sphere},
    {"non-uniform-teapot", "sample:pot,faces=11666,contrast=1,noise=1.1,passes=0", 100, 30,
     &non_uniform_teapot},
    {"uniform-teapot", "sample:pot,faces=11666,contrast=0.4,passes=0", 100, 30, &uniform_teapot},
    {"angel", "sample:scan,faces=181148,noise=0.35,passes=0,roughness=0.1", 10, 3, &angel},
    {"girl-head", "sample:scan,faces=384902,noise=0.35,passes=0,roughness=0.1,seed=2", 6, 3,
     &girl_head},
    {"rough-eight", "sample:eight,faces=2022,roughness=1", 100, 30, &uniform_eight},
    {"rough-teapot", "sample:pot,faces=11666,contrast=0.4,passes=0,roughness=0.5", 100, 30,
     &uniform_teapot},
    {"rough-angel", "sample:scan,faces=181148,noise=0.35,passes=0,roughness=1", 10, 3, &angel},
    {"rough-head", "sample:scan,faces=384902,noise=0.35,passes=0,seed=2,roughness=1", 6, 3,
     &girl_head},
};
const uint32_t paper_model_count = sizeof paper_models / sizeof *paper_models;

const struct paper_model *paper_find(const char *name)
{
    for (uint32_t i = 0; i < paper_model_count; i++)
        if (strcmp(paper_models[i].name, name) == 0) return &paper_models[i];
    return NULL;
}
