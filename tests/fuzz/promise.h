/* What fuzzers hold the code to: a violated promise ends the run, and the fuzzer keeps the
 * input. */
#ifndef FUZZ_PROMISE_H
#define FUZZ_PROMISE_H

#include "proto/json/problem.h"
#include "proto/json/writer.h"

void promise(int holds);

/* The text is JSON without a member that stands twice. Frees the writer. */
void promise_json(struct proto_writer *writer);

/* The refusal says something, and is encoded as JSON. */
void promise_sentence(const struct proto_problem *problem);

#endif
