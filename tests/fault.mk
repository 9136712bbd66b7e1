# Sanitizers, fuzzing, fault injection, coverage. Included by the Makefile.

.PHONY: wild asan asan-build tsan fuzz fuzz-build torture exactness coverage

ASAN_BUILD   := $(BUILD)/asan
ASAN_PROGRAMS = $(patsubst %.c,$(ASAN_BUILD)/%,$(filter tests/unit/%,$(TEST_ENGINE) $(TEST_SERVER)))

##@ Sanitizers, fuzzing and faults

# The fuzzers and the tests under sanitizers use one build by clang. Without -shared-libasan clang
# adds its runtime to each program. The folder that clang 19 prints as that of its runtime does not
# exist in Debian 13.
SANITIZED    := BUILD=$(ASAN_BUILD) CC=clang CXX=clang++ OPT=-O1 \
                SAN="-fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=all" \
                TEST_LDFLAGS="-shared-libasan -Wl,-rpath,$$(dirname $$(clang -print-file-name=libclang_rt.asan-$$(uname -m).so))"
asan-build:
	@$(MAKE) --no-print-directory $(SANITIZED) test-build build $(ASAN_BUILD)/gd_alloc

asan: asan-build ## run all tests under AddressSanitizer and UndefinedBehaviorSanitizer
	@GEODESICD=$(ASAN_BUILD)/geodesicd tests/run.py $(patsubst $(BUILD)/%,$(ASAN_BUILD)/%,$(TEST_PROGRAMS)) "$(ASAN_BUILD)/gd_alloc --short" tests/api/run.py

tsan: ## run the daemon's tests under ThreadSanitizer
	@$(MAKE) --no-print-directory -j2 BUILD=$(BUILD)/tsan OPT=-O1 SAN="-fsanitize=thread" build test-build
	@GEODESICD=$(BUILD)/tsan/geodesicd tests/run.py $(patsubst $(BUILD)/%,$(BUILD)/tsan/%,$(filter $(BUILD)/tests/unit/server/%,$(TEST_PROGRAMS))) tests/api/run.py

# The engine with memory functions that fail on demand (tests/fault/allocator.h).
WRAPPED := malloc calloc realloc aligned_alloc posix_memalign free mmap munmap mremap
$(BUILD)/gd_alloc: $(call objects,$(patsubst %,tests/fault/%,alloc_engine.c allocator.c operator_new.cc) $(wildcard tests/fault/operations*.c)) \
                   $(LIB_SUPPORT) $(LIB_SAMPLES) $(LIB_PROTO) $(LIB_ENGINE) $(LINK)
	$(call link,$(CXX)) $(foreach name,$(WRAPPED),-Wl,--wrap=$(name)) $(ENGINE_LIBS) -ljansson -lcmocka

# The load generator of overload.py.
$(BUILD)/gd_load: $(BUILD)/obj/tests/fault/load.c.o $(LINK)
	$(call link,$(CC))

# Each fuzz target starts from its corpus.
FUZZERS      := $(wildcard tests/fuzz/fuzz_*.c)
FUZZ_SECONDS ?= 60
# Fault tests in their short form. `make torture` runs the long form.
FAULT_TESTS   = tests/fault/soak.py "tests/fault/answers.py --short" tests/fault/replay.py "tests/fault/tenants.py --short" tests/fault/flip.py \
                tests/fault/kill.py tests/fault/stuck_log.py tests/fault/stuck_worker.py "tests/fault/overload.py --short" tests/fault/disconnect.py "tests/fault/halfopen.py --short" \
                tests/fault/scarcity.py tests/fault/restore.py "tests/fault/deadline.py --short --count 300"

# `make test` fuzzes each parser for 5 seconds, from a fixed seed. fuzz_surface, which checks
# properties of distances, only replays its corpus.
FUZZ_SHORT    = tests/fuzz/run.py --seconds 5 --seed 1 $(filter-out %/fuzz_surface,$(FUZZ_PROGRAMS))
FUZZ_REPLAY   = tests/fuzz/run.py --seconds 0 $(ASAN_BUILD)/fuzz_surface
FUZZ_PROGRAMS = $(patsubst tests/fuzz/%.c,$(ASAN_BUILD)/%,$(FUZZERS))

fuzz-build:
	@$(MAKE) --no-print-directory $(SANITIZED) $(FUZZ_PROGRAMS)

# After each input libFuzzer reads the counters of all linked code. Targets that read files take
# only microseconds for an input, so they link only the code that they use. The other targets share
# the library of the test programs.
FUZZ_READERS  = $(patsubst tests/fuzz/%.c,$(BUILD)/%,$(shell grep -l 'fuzz/reader.h' $(FUZZERS)))
$(BUILD)/fuzz_%: $(BUILD)/obj/tests/fuzz/fuzz_%.c.o $(call objects,tests/fuzz/reader.c tests/fuzz/patched.c tests/fuzz/promise.c tests/fuzz/soup.c) $(LINK)
	$(call link,$(CXX)) -fsanitize=fuzzer -Wl,-rpath,$(abspath $(BUILD)) $(ENGINE_LIBS) $(SERVER_LIBS)
$(FUZZ_READERS): $(LIB_SERVER) $(LIB_PROTO) $(LIB_ENGINE)
$(filter-out $(FUZZ_READERS),$(patsubst tests/fuzz/%.c,$(BUILD)/%,$(FUZZERS))): $(TESTED)

# A copy of $(MAKE) for recipes, because `make -n` runs the recipe lines that contain $(MAKE)
# itself.
SELF := $(MAKE)

# Prints a table of promises and their measurements (tests/fault/table.py). ONLY=WORD: only rows
# with this word.
torture: build $(BUILD)/gd_load $(BUILD)/gd_alloc $(BUILD)/tests/unit/server/access/test_sandbox ## test each promise in its long form, and print a table of measurements (hours; ONLY=word)
	@$(MAKE) --no-print-directory -j2 fuzz-build
	@tests/fault/table.py --only "$(ONLY)" $(BUILD)/gd_alloc tests/fault/alloc.py "tests/fault/scarcity.py --calls 400" \
	    "tests/fault/kill.py --loops 2000" "tests/fault/replay.py --step 1 --mixed 4" tests/fault/disk.py \
	    "tests/fault/flip.py --flips 2000" "tests/fault/restore.py --count 100" tests/fault/halfopen.py tests/fault/slow_reader.py "tests/fault/overload.py --seconds 20" tests/fault/answers.py "tests/fault/disconnect.py --count 80000 --tls-count 20000" \
	    "tests/fault/deadline.py --count 8000" "tests/fault/stuck_log.py --requests 200000" tests/fault/stuck_worker.py tests/fault/tenants.py "tests/fault/soak.py --seconds 4200 --pause 5 --svg $(BUILD)/soak.svg" \
	    "hostile HTTP, directly and behind HAProxy | 0 accepted | tests/api/run.py test_hostile test_slow_clients test_proxy" \
	    "hostile JSON | 400 or 413, fast | tests/api/run.py test_malformed" \
	    "one tenant does not see another | byte-identical 404s | tests/api/run.py test_tenants test_access" \
	    "a key changes what its role lets it | nothing of others | tests/api/run.py test_roles" \
	    "a web page does not reach a daemon without keys | 403 | tests/api/run.py test_service" \
	    "damage is found by the scrub, never served | 0 served | tests/api/run.py test_scrub" \
	    "the sandbox holds | no rights but those listed | tests/api/run.py test_sandbox" \
	    "some 90 calls that reach beyond the daemon are refused in it | 0 succeed | $(BUILD)/tests/unit/server/access/test_sandbox" \
	    "tests/fuzz/run.py --seconds 1000 $(FUZZ_PROGRAMS)" \
	    "no data race | 0 reports | $(SELF) --no-print-directory tsan" "$(SELF) --no-print-directory coverage" \
	    tests/cluster/routing.py tests/cluster/shared.py tests/cluster/capacity.py \
	    "the packages in a fresh Debian: installed, run, purged | nothing left | tests/package/run.py --build $(BUILD) --chroot" \
	    "the container, built and run | no failure | tests/container/run.py --place $(BUILD)/container"

wild: build ## upload every mesh file under DIR, check the laws of its distances, and print a table
	@tests/fault/wild.py $(DIR)

# Compares the engine with a solver in quadruple precision (tests/oracle/naive_windows.h), and runs
# the other suites on exact distances.
EXACT_TESTS   := $(foreach name,fields paths operations,$(BUILD)/tests/property/test_exact_$(name))
EARLIER_TESTS := $(foreach name,closed_forms oracle laws lipschitz beside zoo segments curve_distance shared_meshes,$(BUILD)/tests/property/test_$(name))
exactness: build $(EXACT_TESTS) $(EARLIER_TESTS) ## test distances and paths beside vertices and in the smallest faces, and print a table (an hour; ONLY=word)
	@tests/fault/table.py --only "$(ONLY)" $(foreach program,$(EXACT_TESTS),"$(program) --long") \
	    "recorded cases, over HTTP | no failure | tests/api/run.py test_exactness" \
	    "the other suites on exact distances | no failure | tests/run.py $(EARLIER_TESTS)"

# Runs the tests in a build that counts executed lines. Switches the sandbox off, since the daemon
# writes the counts when it ends.
COVERAGE_BUILD := $(BUILD)/coverage
coverage: ## measure line and branch coverage of engine, proto and server by all tests (needs gcovr)
	@$(MAKE) --no-print-directory -j2 BUILD=$(COVERAGE_BUILD) OPT=-O1 SAN="--coverage -fprofile-update=atomic" build test-build
	@find $(COVERAGE_BUILD) -name '*.gcda' -delete
	-@GEODESICD=$(abspath $(COVERAGE_BUILD))/geodesicd GEODESICD_SANDBOX=off GCOV_ERROR_FILE=$(abspath $(COVERAGE_BUILD))/errors \
	    tests/run.py --timeout 3000 $(patsubst $(BUILD)/%,$(COVERAGE_BUILD)/%,$(TEST_PROGRAMS)) tests/api/run.py >$(COVERAGE_BUILD)/tests.log
	@tests/fault/coverage.py --build $(COVERAGE_BUILD)

fuzz: fuzz-build ## fuzz each target for FUZZ_SECONDS
	@tests/fuzz/run.py --seconds $(FUZZ_SECONDS) $(FUZZ_PROGRAMS)
