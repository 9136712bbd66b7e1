/* Invariants ("promises") that fuzzers check. A violation ends the run, and the fuzzer keeps the
 * input. */
#pragma once

#include "proto/json/problem.h"
#include "proto/json/writer.h"

void promise(int holds);

/* Checks that the writer's text is JSON without duplicate members. Frees the writer. */
void promise_json(struct proto_writer *writer);

/* Checks that the problem has a detail sentence and is encoded as JSON. */
void promise_sentence(const struct proto_problem *problem);
