# geodesicd: exact geodesics on surfaces, as a network service.
# `make help` lists the targets. Everything that is built goes into $(BUILD); V=1 shows the commands that do it.

BUILD   ?= build
export GEODESICD ?= $(abspath $(BUILD)/geodesicd)
CC      ?= cc
CXX     ?= c++
OPT     ?= -O3
WARN    := -Wall -Wextra -Wshadow -Wpointer-arith -Wvla
CWARN   := $(WARN) -Wstrict-prototypes -Wmissing-prototypes
CPPFLAGS += -Iengine/include -Iengine -I. -I$(BUILD) -D_GNU_SOURCE
CFLAGS   += -std=c17 $(OPT) -g -fno-math-errno -ffp-contract=off -fvisibility=hidden -pthread $(CWARN) $(SAN)
CXXFLAGS += -std=c++17 $(OPT) -g -fno-math-errno -ffp-contract=off -pthread $(WARN) $(SAN)
LDFLAGS  += -pthread $(SAN)

# Rooms of the engine, in order of rank (see README). ROOMS="base io" builds a part of the house.
ROOMS   ?= base mesh io repair construction window kernel guide wavefront partition field line query transport render cut nurbs subdiv
ENGINE_C  := $(foreach room,$(ROOMS),$(wildcard engine/$(room)/*.c))
ENGINE_CC := $(foreach room,$(ROOMS),$(wildcard engine/$(room)/*.cc))
PROTO_C   := $(wildcard proto/*/*.c)
SERVER_C  := $(filter-out server/main.c,$(wildcard server/*.c server/*/*.c server/*/*/*.c))
no_main = $(filter-out %/main.c,$(foreach source,$(wildcard $(1)),$(if $(filter test_%,$(notdir $(source))),,$(source))))
SAMPLES_C := $(call no_main,tests/samples/*.c)
SUPPORT_C := $(call no_main,tests/support/*.c $(filter-out tests/oracle/cgal_%,$(wildcard tests/oracle/*.c)))
BENCH_C   := $(filter-out tests/bench/http_bare.c,$(wildcard tests/bench/*.c))

objects = $(patsubst %,$(BUILD)/obj/%.o,$(1))

# Before a command that makes a file: tells, in its place, its short name and the file (of compilers the source). V=1: the command.
tell = $(if $(filter-out 0,$(V)),,@printf '  %-3s  %s\n' $(1) $(or $(2),$@);)

LIB_ENGINE  := $(BUILD)/libgd.a
LIB_PROTO   := $(BUILD)/libgd_proto.a
LIB_SERVER  := $(BUILD)/libgd_server.a
LIB_SAMPLES := $(BUILD)/libgd_samples.a
LIB_SUPPORT := $(BUILD)/libgd_support.a
LIB_CLIENT  := $(BUILD)/libgeodesicd-client.a

ENGINE_LIBS := -lm -lz
SERVER_LIBS := -lmicrohttpd -ljansson -lsqlite3 -lpq -lgnutls -lseccomp -lz
CLIENT_LIBS := -lcurl -ljansson -lm
CLIENTS     := $(BUILD)/gd_client_scenario $(BUILD)/gd_client_example

# Tests mirror the sources: tests/unit/<room>/test_<source>.c; each is a program.
TEST_ENGINE := $(wildcard tests/unit/base/test_*.c) $(foreach room,$(filter-out base,$(ROOMS)),$(wildcard tests/unit/$(room)/test_*.c)) \
               $(wildcard tests/property/test_*.c tests/oracle/test_*.c tests/samples/test_*.c)
TEST_SERVER := $(wildcard tests/unit/proto/test_*.c tests/unit/server/test_*.c tests/unit/server/*/test_*.c tests/unit/server/*/*/test_*.c)
FUZZERS     := $(wildcard tests/fuzz/fuzz_*.c)

program = $(patsubst %.c,$(BUILD)/%,$(1))

.DEFAULT_GOAL := build
.DELETE_ON_ERROR:
.PHONY: help setup setup-test build demo demo-stop serve man client-c test test-build test-unit test-api nurbs-peers contract-linter contract-generators web-peers test-web check-pages test-cluster test-container image asan asan-build tsan fuzz fuzz-build sweep bench bench-paper bench-peers bench-http bench-plots torture exactness coverage lint format check-layers clean

help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1	\2/p' Makefile docker/packages.mk | expand -t 22

# --- for people ----------------------------------------------------------------------------------------------------------

# Everything that building, running and testing need, from Debian 12's own packages.
PACKAGES := build-essential clang clang-format libmicrohttpd-dev libjansson-dev libgnutls28-dev libseccomp-dev libsqlite3-dev libpq-dev zlib1g-dev \
            libcmocka-dev libclang-rt-14-dev libcurl4-openssl-dev python3 python3-yaml python3-jsonschema curl ca-certificates
SUDO     := $(if $(filter 0,$(shell id -u)),,sudo)
# The pages are made by node and npm, whoever installed them; the tests of the pages want a browser, too.
NODE      = $(if $(filter no,$(VIEWER)),,$(shell command -v node >/dev/null && command -v npm >/dev/null || echo nodejs npm))
CHROMIUM  = $(if $(filter no,$(VIEWER)),,$(shell command -v chromium >/dev/null || echo chromium))
define install_missing
	@missing=$$(for p in $(1); do dpkg-query -W -f='$${Status}' $$p 2>/dev/null | grep -q 'ok installed' || echo $$p; done); \
	if [ -n "$$missing" ]; then echo "installing:" $$missing; export DEBIAN_FRONTEND=noninteractive; \
	    $(SUDO) apt-get -qq update && $(SUDO) apt-get -qq install -y --no-install-recommends $$missing >/dev/null; fi
endef

setup: ## install what is missing (Debian 12)
	$(call install_missing,$(PACKAGES) $(NODE))

setup-test: setup
	$(call install_missing,$(CHROMIUM))

build: $(BUILD)/geodesicd $(BUILD)/gd_sample ## build the daemon and the sample maker

demo: setup ## set up, build, start the daemon, upload a sample, ask, print answers and the URL
	@$(MAKE) --no-print-directory -j2 build
	@clients/curl/demo.sh $(BUILD)

demo-stop: ## stop the demo's daemon
	@clients/curl/demo.sh --stop $(BUILD)

serve: build ## run the daemon in the foreground
	$(BUILD)/geodesicd

test: PACKAGES += debhelper dh-python lintian pkg-config haproxy postgresql python3-kubernetes # wanted by tests only
test: setup-test nurbs-peers contract-linter contract-generators web-peers ## set up and run all tests
	@$(MAKE) --no-print-directory -j2 build test-build $(BUILD)/gd_sweep $(BUILD)/gd_bench $(BUILD)/gd_bench_cgal $(BUILD)/gd_http_bare $(BUILD)/gd_load $(BUILD)/gd_alloc
	@$(MAKE) --no-print-directory -j2 asan-build
	@$(MAKE) --no-print-directory -j2 fuzz-build
	@$(MAKE) --no-print-directory check-layers
	@tests/run.py $(TEST_PROGRAMS) $(ASAN_PROGRAMS) "$(BUILD)/gd_sweep --sources 2 $(SWEEP_SHORT)" "$(BUILD)/gd_bench ablation --quick" \
	    "tests/bench/table.py --quick --build $(BUILD)" "tests/bench/peers.py --quick --build $(BUILD)" "tests/bench/plots.py --quick --build $(BUILD)" \
	    "tests/bench/throughput.py --quick --build $(BUILD)" \
	    tests/oracle/mirror.py tests/api/run.py "tests/web/run.py --build $(BUILD)" tests/cluster/run.py "tests/package/run.py --build $(BUILD)" "tests/cluster/routing.py --short" "tests/cluster/shared.py --short" "tests/cluster/capacity.py --short" tests/cluster/shipped.py $(FAULT_TESTS) "$(FUZZ_SHORT)" "$(FUZZ_REPLAY)"

# Programs of others, below $(BUILD). Without npm or a network, tests/api/test_nurbs_peers.py, and half of test_files.py, are skipped.
NURBS_PEERS := verb-nurbs@3.0.3 three@0.187.0 rhino3dm@8.35.0 gltf-validator@2.0.0-dev.3.10
nurbs-peers: ## programs that evaluate NURBS, or read glTF, too, for the tests (wants npm)
	@if [ ! -e $(BUILD)/peers/complete ] && command -v npm >/dev/null; then mkdir -p $(BUILD)/peers; \
	    timeout 90 npm install --silent --no-save --no-package-lock --no-audit --no-fund --ignore-scripts --prefix $(BUILD)/peers $(NURBS_PEERS) \
	        >/dev/null 2>&1 && touch $(BUILD)/peers/complete || echo "npm could not install $(NURBS_PEERS): tests against them are skipped"; fi

# Reads the contract only; no network, no telemetry. Without npm or a network, tests/api/test_contract_lint.py is skipped.
CONTRACT_LINTER := @redocly/openapi-core@1.34.5
contract-linter: ## a linter of OpenAPI documents, for the tests (wants npm)
	@if [ ! -e $(BUILD)/linter/complete ] && command -v npm >/dev/null; then mkdir -p $(BUILD)/linter; \
	    timeout 90 npm install --silent --no-save --no-package-lock --no-audit --no-fund --ignore-scripts --prefix $(BUILD)/linter $(CONTRACT_LINTER) \
	        >/dev/null 2>&1 && touch $(BUILD)/linter/complete || echo "npm could not install $(CONTRACT_LINTER): the contract is not linted by it"; fi

# They read the contract only. Without npm or a network, tests/api/test_contract_generators.py is skipped.
CONTRACT_GENERATORS := openapi-typescript@7.13.0 @hey-api/openapi-ts@0.95.0 orval@7.13.2 typescript@5.9.3
contract-generators: ## code generators that read the contract, for the tests (wants npm)
	@if [ ! -e $(BUILD)/generators/complete ] && command -v npm >/dev/null; then mkdir -p $(BUILD)/generators; \
	    timeout 180 npm install --silent --no-save --no-package-lock --no-audit --no-fund --ignore-scripts --prefix $(BUILD)/generators $(CONTRACT_GENERATORS) \
	        >/dev/null 2>&1 && touch $(BUILD)/generators/complete || echo "npm could not install $(CONTRACT_GENERATORS): tests with them are skipped"; fi

# Likewise: playwright-core and axe-core, for tests/web.
web-peers:
	@if ! cmp -s tests/web/package-lock.json $(BUILD)/web-peers/complete && command -v npm >/dev/null; then \
	    mkdir -p $(BUILD)/web-peers && cp tests/web/package.json tests/web/package-lock.json $(BUILD)/web-peers && cd $(BUILD)/web-peers && \
	    timeout 90 npm ci --silent --no-audit --no-fund --ignore-scripts --include=dev >/dev/null 2>&1 && cp package-lock.json complete || \
	    echo "npm could not install playwright-core: the tests of the pages are skipped"; fi

test-unit: test-build ## the C tests only
	@tests/run.py $(TEST_PROGRAMS)

test-web: build web-peers ## the pages in a browser only
	@tests/run.py "tests/web/run.py --build $(BUILD)"

test-container: ## the container's image, really built and run (wants buildah, mmdebstrap, root)
	@tests/container/run.py --place $(BUILD)/container

image: ## the container's image, by docker, podman or buildah, and its parts list (BASE= SOURCE= VIEWER=no)
	@BASE='$(BASE)' SOURCE='$(SOURCE)' VIEWER='$(VIEWER)' docker/image.sh $(BUILD)

test-api: build $(CLIENTS) ## the daemon over HTTP only
	@tests/run.py tests/api/run.py

# --- for developers ------------------------------------------------------------------------------------------------------

TEST_PROGRAMS = $(call program,$(TEST_ENGINE) $(TEST_SERVER))
ASAN_BUILD   := $(BUILD)/asan
ASAN_PROGRAMS = $(patsubst %.c,$(ASAN_BUILD)/%,$(filter tests/unit/%,$(TEST_ENGINE) $(TEST_SERVER)))

test-build: $(call program,$(TEST_ENGINE) $(TEST_SERVER)) $(CLIENTS)

client-c: $(LIB_CLIENT) $(BUILD)/geodesicd-client.pc $(BUILD)/gd_client_example ## the client library for C, and its example

asan-build:
	@$(MAKE) --no-print-directory BUILD=$(ASAN_BUILD) OPT=-O1 SAN="-fsanitize=address,undefined -fno-sanitize-recover=all" \
	    test-build build $(ASAN_BUILD)/gd_alloc

asan: asan-build ## all tests under AddressSanitizer and UndefinedBehaviorSanitizer
	@GEODESICD=$(ASAN_BUILD)/geodesicd tests/run.py $(patsubst $(BUILD)/%,$(ASAN_BUILD)/%,$(TEST_PROGRAMS)) "$(ASAN_BUILD)/gd_alloc --short" tests/api/run.py

tsan: ## the daemon's tests under ThreadSanitizer
	@$(MAKE) --no-print-directory -j2 BUILD=$(BUILD)/tsan OPT=-O1 SAN="-fsanitize=thread" build test-build
	@GEODESICD=$(BUILD)/tsan/geodesicd tests/run.py $(patsubst $(BUILD)/%,$(BUILD)/tsan/%,$(filter $(BUILD)/tests/unit/server/%,$(TEST_PROGRAMS))) tests/api/run.py

check-layers: ## fail if a file includes what its room may not
	@tests/check_layers.py

format: ## format all C and C++
	clang-format -i $$(git ls-files '*.c' '*.h' '*.cc')

lint: check-layers check-pages ## formatting, layers, the contract, the pages' types, and a build by the other compiler
	python3 proto/generate.py check proto/openapi.yaml proto/json/problem.h
	python3 clients/js/generate.py | diff clients/js/types.d.ts -
	clang-format --dry-run -Werror $$(git ls-files '*.c' '*.h' '*.cc')
	$(MAKE) --no-print-directory -j2 BUILD=$(BUILD)/clang CC=clang CXX=clang++ WARN="$(WARN) -Werror" build test-build

clean:
	rm -rf $(BUILD)

# --- libraries ---------------------------------------------------------------------------------------------------------

$(LIB_ENGINE): $(call objects,$(ENGINE_C) $(ENGINE_CC))
$(LIB_PROTO): $(call objects,$(PROTO_C)) $(patsubst %,$(BUILD)/obj/generated/%.o,fields parameters requests)
$(LIB_SERVER): $(call objects,$(SERVER_C)) $(BUILD)/obj/generated/routes.o $(BUILD)/obj/generated/assets.o
$(LIB_SAMPLES): $(call objects,$(SAMPLES_C))
$(LIB_SUPPORT): $(call objects,$(SUPPORT_C))
$(LIB_CLIENT): $(call objects,$(filter-out %/example.c,$(wildcard clients/c/*.c)))

%.a:
	@rm -f $@
	$(call tell,AR)$(AR) rcs $@ $(filter %.o,$^)

# One source, compiled for several machines; the daemon chooses when it starts (engine/kernel/cpu.c).
ifneq ($(filter x86_64%,$(shell $(CC) -dumpmachine 2>/dev/null)),)
$(BUILD)/obj/engine/%_avx2.c.o: CFLAGS += -mavx2
$(BUILD)/obj/engine/%_avx512.c.o: CFLAGS += -mavx512f -mavx512vl -mavx512dq -mprefer-vector-width=512
$(BUILD)/obj/engine/base/%_avx512.c.o: CFLAGS += -mavx512bw
endif

$(BUILD)/obj/%.c.o: %.c | $(BUILD)/generated/sources
	@mkdir -p $(@D)
	$(call tell,CC,$<)$(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<

$(BUILD)/obj/%.cc.o: %.cc
	@mkdir -p $(@D)
	$(call tell,CXX,$<)$(CXX) $(CPPFLAGS) $(CXXFLAGS) -MMD -MP -c -o $@ $<

$(BUILD)/obj/generated/%.o: $(BUILD)/generated/%.c
	@mkdir -p $(@D)
	$(call tell,CC,$<)$(CC) $(CPPFLAGS) -Iserver $(CFLAGS) -MMD -MP -c -o $@ $<

# --- programs ----------------------------------------------------------------------------------------------------------

$(BUILD)/geodesicd: $(BUILD)/obj/server/main.c.o $(LIB_SERVER) $(LIB_PROTO) $(LIB_ENGINE)
	$(call tell,LD)$(CXX) $(LDFLAGS) -o $@ $^ $(ENGINE_LIBS) $(SERVER_LIBS)

$(BUILD)/gd_bench: $(call objects,$(BENCH_C)) $(LIB_SAMPLES) $(LIB_ENGINE)
	$(call tell,LD)$(CXX) $(LDFLAGS) -o $@ $^ $(ENGINE_LIBS)

# The sweep compares with CGAL where libcgal-dev is installed; without it the program says so and skips.
SWEEP_SHARED := $(or $(GEODESICD_SHARED),../shared)/meshes
SWEEP_SHORT  := icosphere:level=3 terrain:cells=32 torus genus2:cells=4 tangle:faces=400 saddle cylinder:sides=24 obstacles:count=12 \
                $(wildcard $(foreach name,spot suzanne teapot cow beetle homer fandisk,$(SWEEP_SHARED)/$(name).obj))

$(BUILD)/obj/tests/oracle/cgal_distances.cc.o: CXXFLAGS += -frounding-math
$(BUILD)/gd_sweep: $(call objects,$(wildcard tests/oracle/cgal_*.c tests/oracle/cgal_*.cc)) $(LIB_SUPPORT) $(LIB_SAMPLES) $(LIB_ENGINE)
	$(call tell,LD)$(CXX) $(LDFLAGS) -o $@ $^ $(ENGINE_LIBS) -lcmocka

$(BUILD)/gd_bench_cgal: $(call objects,tests/bench/peer_cgal.cc $(patsubst %,tests/bench/%.c,peer options input alter measure) \
                          tests/oracle/cgal_distances.cc tests/oracle/cgal_polyline.c) $(LIB_SAMPLES) $(LIB_ENGINE)
	$(call tell,LD)$(CXX) $(LDFLAGS) -o $@ $^ $(ENGINE_LIBS)

# Needs its source and, in its folder `build`, its library, made with -O3 for this machine.
$(BUILD)/obj/tests/bench/peer_geometry_central.cc.o: CXXFLAGS += -march=native -Wno-shadow -isystem $(GEOMETRY_CENTRAL)/include \
    -isystem $(GEOMETRY_CENTRAL)/deps/happly -isystem $(GEOMETRY_CENTRAL)/deps/nanoflann/include -isystem $(or $(EIGEN),/usr/include/eigen3)
$(BUILD)/gd_bench_geometry_central: $(call objects,tests/bench/peer_geometry_central.cc $(patsubst %,tests/bench/%.c,peer options input alter measure)) \
                                    $(LIB_SAMPLES) $(LIB_ENGINE)
	$(call tell,LD)$(CXX) $(LDFLAGS) -o $@ $^ $(GEOMETRY_CENTRAL)/build/src/libgeometry-central.a $(ENGINE_LIBS)

$(BUILD)/gd_http_bare: $(BUILD)/obj/tests/bench/http_bare.c.o
	$(call tell,LD)$(CC) $(LDFLAGS) -o $@ $^ -lmicrohttpd

# The engine whose calls of malloc and its kin fail on order (tests/fault/allocator.h).
WRAPPED := malloc calloc realloc aligned_alloc posix_memalign free mmap munmap mremap
$(BUILD)/gd_alloc: $(call objects,$(patsubst %,tests/fault/%.c,alloc_engine allocator) $(wildcard tests/fault/operations*.c)) \
                   $(LIB_SUPPORT) $(LIB_SAMPLES) $(LIB_PROTO) $(LIB_ENGINE)
	$(call tell,LD)$(CXX) $(LDFLAGS) $(foreach name,$(WRAPPED),-Wl,--wrap=$(name)) -o $@ $^ $(ENGINE_LIBS) -ljansson -lcmocka

# What overload.py asks with.
$(BUILD)/gd_load: $(BUILD)/obj/tests/fault/load.c.o
	$(call tell,LD)$(CC) $(LDFLAGS) -o $@ $^

$(BUILD)/gd_sample: $(BUILD)/obj/tests/samples/main.c.o $(LIB_SAMPLES) $(LIB_ENGINE)
	$(call tell,LD)$(CXX) $(LDFLAGS) -o $@ $^ $(ENGINE_LIBS)

$(call program,$(TEST_ENGINE)): $(BUILD)/%: $(BUILD)/obj/%.c.o $(LIB_SUPPORT) $(LIB_SAMPLES) $(LIB_ENGINE)
	@mkdir -p $(@D)
	$(call tell,LD)$(CXX) $(LDFLAGS) -o $@ $^ $(ENGINE_LIBS) $(TEST_LIBS) -lcmocka

# Limit surfaces are compared with OpenSubdiv's where libosd-dev is installed; without it the tests skip.
$(BUILD)/obj/tests/oracle/opensubdiv.cc.o: CXXFLAGS += -Wno-shadow # C's functions and structs may share a name
$(BUILD)/tests/oracle/test_opensubdiv: $(BUILD)/obj/tests/oracle/opensubdiv.cc.o
$(BUILD)/tests/oracle/test_opensubdiv: TEST_LIBS = $(shell $(CXX) -include opensubdiv/version.h -x c++ -E /dev/null >/dev/null 2>&1 && echo -losdCPU)

$(call program,$(TEST_SERVER)): $(BUILD)/%: $(BUILD)/obj/%.c.o $(LIB_SUPPORT) $(LIB_SAMPLES) $(LIB_SERVER) $(LIB_PROTO) $(LIB_ENGINE)
	@mkdir -p $(@D)
	$(call tell,LD)$(CXX) $(LDFLAGS) -o $@ $^ $(ENGINE_LIBS) $(SERVER_LIBS) -lcmocka

man: $(BUILD)/geodesicd.8 ## the man page geodesicd(8), of the program's own options
$(BUILD)/geodesicd.8: server/doc/manual.py $(BUILD)/geodesicd
	$(call tell,GEN)server/doc/manual.py $(BUILD)/geodesicd > $@

$(BUILD)/gd_client_scenario: $(call objects,tests/api/scenario.c) $(LIB_CLIENT)
	$(call tell,LD)$(CC) $(LDFLAGS) -o $@ $^ $(CLIENT_LIBS)

$(BUILD)/gd_client_example: $(call objects,clients/c/example.c) $(LIB_CLIENT)
	$(call tell,LD)$(CC) $(LDFLAGS) -o $@ $^ $(CLIENT_LIBS)

include docker/packages.mk

# --- generated sources: routes, members of requests, fields of answers, and the embedded pages ------------------------------------------------------------

CONTRACT := proto/openapi.yaml $(wildcard proto/*.py)

$(BUILD)/generated/sources: $(CONTRACT)
	@mkdir -p $(@D)
	$(call tell,GEN)python3 proto/generate.py sources proto/openapi.yaml $(@D) && touch $@
$(patsubst %,$(BUILD)/generated/%,routes.c handlers.h fields.h fields.c parameters.h parameters.c requests.h requests.c): $(BUILD)/generated/sources ;

# The pages are built by npm's packages, once for all builds below $(BUILD) (clients/web/build.sh). VIEWER=no: a page that says that they are missing.
VIEWER ?= yes
export PAGES_BUILD ?= $(abspath $(BUILD)/web)
ifeq ($(VIEWER),no)
PAGES := clients/web/without/index.html
else
PAGES := $(PAGES_BUILD)/pages/licenses.txt
endif

$(PAGES_BUILD)/node_modules/.package-lock.json: clients/web/package.json clients/web/package-lock.json
	@clients/web/build.sh install $(PAGES_BUILD)

$(PAGES_BUILD)/pages/licenses.txt: $(PAGES_BUILD)/node_modules/.package-lock.json $(shell find clients/web clients/js/types.d.ts -name node_modules -prune -o -type f -print)
	@clients/web/build.sh bundle $(PAGES_BUILD)

check-pages: $(PAGES_BUILD)/node_modules/.package-lock.json
	@clients/web/build.sh check $(PAGES_BUILD)

$(BUILD)/generated/pages-$(VIEWER):
	@mkdir -p $(@D)
	@rm -f $(@D)/pages-* && touch $@

$(BUILD)/generated/assets.c: $(CONTRACT) $(PAGES) $(BUILD)/generated/pages-$(VIEWER)
	@mkdir -p $(@D)
	$(call tell,GEN)python3 proto/generate.py assets proto/openapi.yaml $(dir $(PAGES)) > $@

# --- fuzzing: clang's libFuzzer with both sanitizers; each target starts from its corpus -------------------------------------------------------

FUZZ_SECONDS ?= 60
FUZZ_BUILD   := $(BUILD)/fuzz
FUZZ_SAN     := -fsanitize=address,undefined -fno-sanitize-recover=all
# Faults: short forms here, the long ones under `make torture`.
FAULT_TESTS   = "$(BUILD)/gd_alloc --short" "tests/fault/alloc.py --short" tests/fault/scarcity.py tests/fault/kill.py tests/fault/replay.py "tests/fault/disk.py --step 7" \
                tests/fault/flip.py tests/fault/restore.py "tests/fault/halfopen.py --short" "tests/fault/overload.py --short" "tests/fault/answers.py --short" \
                tests/fault/disconnect.py "tests/fault/deadline.py --short --count 300" tests/fault/stuck_log.py "tests/fault/tenants.py --short" tests/fault/soak.py

# In `make test` what reads bytes is fuzzed for 20 seconds each, from a fixed seed; fuzz_surface, which checks laws, replays its corpus.
FUZZ_SHORT    = tests/fuzz/run.py --seconds 20 --seed 1 $(foreach target,$(filter-out surface,$(FUZZ_TARGETS)),$(FUZZ_BUILD)/fuzz_$(target))
FUZZ_REPLAY   = tests/fuzz/run.py --seconds 0 $(FUZZ_BUILD)/fuzz_surface
FUZZ_TARGETS := $(patsubst tests/fuzz/fuzz_%.c,%,$(FUZZERS))

fuzz-build:
	@$(MAKE) --no-print-directory BUILD=$(FUZZ_BUILD) CC=clang CXX=clang++ OPT=-O1 SAN="$(FUZZ_SAN) -fsanitize=fuzzer-no-link" \
	    $(foreach target,$(FUZZ_TARGETS),$(FUZZ_BUILD)/fuzz_$(target))

$(BUILD)/fuzz_%: $(BUILD)/obj/tests/fuzz/fuzz_%.c.o $(call objects,tests/fuzz/reader.c tests/fuzz/patched.c tests/fuzz/promise.c) $(LIB_SERVER) $(LIB_PROTO) $(LIB_ENGINE)
	$(call tell,LD)$(CXX) $(LDFLAGS) -fsanitize=fuzzer -o $@ $^ $(ENGINE_LIBS) $(SERVER_LIBS)

# By another name, so that make -n does not run the line that has it.
SELF := $(MAKE)

# Each promise, with what is measured of it, in one table (tests/fault/table.py). ONLY=WORD: those that have it in their line.
torture: build $(BUILD)/gd_load $(BUILD)/gd_alloc $(BUILD)/tests/unit/server/access/test_sandbox ## each promise tested in its long form, and one table of what was measured (hours; ONLY=word)
	@$(MAKE) --no-print-directory -j2 fuzz-build
	@tests/fault/table.py --only "$(ONLY)" $(BUILD)/gd_alloc tests/fault/alloc.py "tests/fault/scarcity.py --calls 400" \
	    "tests/fault/kill.py --loops 2000" "tests/fault/replay.py --step 1 --mixed 4" tests/fault/disk.py \
	    "tests/fault/flip.py --flips 2000" "tests/fault/restore.py --count 100" tests/fault/halfopen.py tests/fault/slow_reader.py "tests/fault/overload.py --seconds 20" tests/fault/answers.py "tests/fault/disconnect.py --count 80000 --tls-count 20000" \
	    "tests/fault/deadline.py --count 8000" "tests/fault/stuck_log.py --requests 200000" tests/fault/tenants.py "tests/fault/soak.py --seconds 4200 --pause 5 --svg $(BUILD)/soak.svg" \
	    "hostile HTTP, directly and behind HAProxy | 0 accepted | tests/api/run.py test_hostile test_slow_clients test_proxy" \
	    "hostile JSON | 400 or 413, fast | tests/api/run.py test_malformed" \
	    "one tenant does not see another | byte-identical 404s | tests/api/run.py test_tenants test_access" \
	    "a key changes what its role lets it | nothing of others | tests/api/run.py test_roles" \
	    "a web page does not reach a daemon without keys | 403 | tests/api/run.py test_service" \
	    "damage is found by the scrub, never served | 0 served | tests/api/run.py test_scrub" \
	    "the sandbox holds | no rights but those listed | tests/api/run.py test_sandbox" \
	    "some 90 calls that reach beyond the daemon are refused in it | 0 succeed | $(BUILD)/tests/unit/server/access/test_sandbox" \
	    "tests/fuzz/run.py --seconds 1000 $(foreach target,$(FUZZ_TARGETS),$(FUZZ_BUILD)/fuzz_$(target))" \
	    "no data race | 0 reports | $(SELF) --no-print-directory tsan" "$(SELF) --no-print-directory coverage" \
	    tests/cluster/routing.py tests/cluster/shared.py tests/cluster/capacity.py \
	    "the packages in a fresh Debian: installed, run, purged | nothing left | tests/package/run.py --build $(BUILD) --chroot" \
	    "the container, built and run | no failure | tests/container/run.py --place $(BUILD)/container"

# What the engine answers against a solver in quadruple precision (tests/oracle/naive_windows.h), and the other suites on exact distances.
EXACT_TESTS   := $(foreach name,fields paths operations,$(BUILD)/tests/property/test_exact_$(name))
EARLIER_TESTS := $(foreach name,closed_forms oracle laws lipschitz beside zoo segments curve_distance shared_meshes,$(BUILD)/tests/property/test_$(name))
exactness: build $(EXACT_TESTS) $(EARLIER_TESTS) ## distances and paths beside vertices and in the smallest faces, one table (an hour; ONLY=word)
	@tests/fault/table.py --only "$(ONLY)" $(foreach program,$(EXACT_TESTS),"$(program) --long") \
	    "recorded cases, over HTTP | no failure | tests/api/run.py test_exactness" \
	    "the other suites on exact distances | no failure | tests/run.py $(EARLIER_TESTS)"

# The tests in a build that counts what they run through; without the sandbox, since the counts are written when a daemon ends.
COVERAGE_BUILD := $(BUILD)/coverage
coverage: ## line and branch coverage of engine, proto and server from the whole suite (wants gcovr)
	@$(MAKE) --no-print-directory -j2 BUILD=$(COVERAGE_BUILD) OPT=-O1 SAN="--coverage -fprofile-update=atomic" build test-build
	@find $(COVERAGE_BUILD) -name '*.gcda' -delete
	-@GEODESICD=$(abspath $(COVERAGE_BUILD))/geodesicd GEODESICD_SANDBOX=off GCOV_ERROR_FILE=$(abspath $(COVERAGE_BUILD))/errors \
	    tests/run.py --timeout 3000 $(patsubst $(BUILD)/%,$(COVERAGE_BUILD)/%,$(TEST_PROGRAMS)) tests/api/run.py >$(COVERAGE_BUILD)/tests.log
	@tests/fault/coverage.py --build $(COVERAGE_BUILD)

bench: $(BUILD)/gd_bench ## measure the engine: tables, and bench.json (3 minutes)
	tests/bench/table.py --build $(BUILD)

bench-paper: $(BUILD)/gd_bench ## the paper's tables remade
	$(BUILD)/gd_bench ablation

bench-peers: $(BUILD)/gd_bench $(BUILD)/gd_bench_cgal $(if $(GEOMETRY_CENTRAL),$(BUILD)/gd_bench_geometry_central) ## race CGAL, and VTP=... LIBIGL=... GEOMETRY_CENTRAL=... EXPERIMENT=... (see tests/bench/peers.py)
	tests/bench/peers.py --build $(BUILD)

bench-http: build $(BUILD)/gd_http_bare ## requests a second and latency against bare libmicrohttpd (wants wrk)
	tests/bench/throughput.py --build $(BUILD)

bench-plots: $(BUILD)/gd_bench ## cost against mesh size, as SVG (MAX_FACES=300000)
	tests/bench/plots.py --build $(BUILD) --max-faces $(or $(MAX_FACES),300000)

sweep: $(BUILD)/gd_sweep ## the engine against CGAL on every shared mesh (minutes; wants libcgal-dev)
	$(BUILD)/gd_sweep --sources 20 $(wildcard $(SWEEP_SHARED)/*.obj)

fuzz: fuzz-build ## fuzz each target for FUZZ_SECONDS
	@tests/fuzz/run.py --seconds $(FUZZ_SECONDS) $(foreach target,$(FUZZ_TARGETS),$(FUZZ_BUILD)/fuzz_$(target))

-include $(shell find $(BUILD)/obj -name '*.d' 2>/dev/null)
