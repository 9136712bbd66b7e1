# geodesicd: exact geodesics on surfaces, as a network service.
# `make help` lists the targets. All output goes into $(BUILD); V=1 prints the commands.
# Rules, tests, measurements and packages are in the makefiles that this one includes.

BUILD   ?= build
include docker/paths.mk
export GEODESICD ?= $(abspath $(BUILD)/geodesicd)
CC      ?= cc
CXX     ?= c++
OPT     ?= -O3
# Line numbers, for backtraces and profiles. DEBUG=-g adds variables, for a debugger.
DEBUG   ?= -g1
WARN    := -Wall -Wextra -Wshadow -Wpointer-arith -Wvla
CWARN   := $(WARN) -Wstrict-prototypes -Wmissing-prototypes
# SAN: flags of sanitizers or of coverage. With SAN, the test programs share one library
# (tests/tests.mk).
SANITIZING := $(if $(SAN),$(SAN) -fPIC -fvisibility=default)
# The user may set CPPFLAGS, CFLAGS, CXXFLAGS and LDFLAGS. They come after the flags below.
GD_CPPFLAGS := -Iengine/include -Iengine -I. -I$(BUILD) -D_GNU_SOURCE
GD_CFLAGS   := -std=c17 $(OPT) $(DEBUG) -fno-math-errno -ffp-contract=off -fvisibility=hidden -pthread \
               $(CWARN) $(SANITIZING)
GD_CXXFLAGS := -std=c++17 $(OPT) $(DEBUG) -fno-math-errno -ffp-contract=off -pthread $(WARN) $(SANITIZING)
GD_LDFLAGS  := -pthread $(DEBUG) $(SAN)

objects = $(patsubst %,$(BUILD)/obj/%.o,$(1))

PROTO_C   := $(wildcard proto/*/*.c)
SERVER_C  := $(filter-out server/main.c,$(wildcard server/*.c server/*/*.c server/*/*/*.c))
no_main = $(filter-out %/main.c,$(foreach source,$(wildcard $(1)), \
              $(if $(filter test_%,$(notdir $(source))),,$(source))))
SAMPLES_C := $(call no_main,tests/samples/*.c)

LIB_PROTO   := $(BUILD)/libgd_proto.a
LIB_SERVER  := $(BUILD)/libgd_server.a
LIB_SAMPLES := $(BUILD)/libgd_samples.a
ENGINE_LIBS := -lm -lz -lminizip -lexpat -lOpenMeshTools -lOpenMeshCore
SERVER_LIBS := -lmicrohttpd -ljansson -lsqlite3 -lpq -lgnutls -lseccomp -lz

.DEFAULT_GOAL := build
.DELETE_ON_ERROR:
include docker/rules.mk docker/tools.mk engine/libraries.mk

##@ To begin with

.PHONY: help build announce-demo demo demo-stop serve clean
help: ## list the targets
	@awk 'BEGIN { FS = ":.*## " } /^##@ / { printf "\n%s\n", substr($$0, 5) } \
	    /^[a-z][a-z_.-]*:.*## / { printf "  make %-20s %s\n", $$1, $$2 }' $(filter %Makefile %.mk,$(MAKEFILE_LIST))

build: $(BUILD)/geodesicd $(BUILD)/gd_sample ## build the daemon and the sample maker

announce-demo:
	@echo "make demo: installs the packages that are missing, builds the daemon, and starts it for this machine only."
	@echo "On a new system this takes about two minutes and 550 MB of disk; with VIEWER=no, 400 MB."

demo: announce-demo setup ## set up, build, start the daemon, upload a sample, ask, print answers and the URL
	@$(MAKE) --no-print-directory -j2 build
	@clients/curl/demo.sh $(BUILD)

demo-stop: ## stop the demo's daemon
	@clients/curl/demo.sh --stop $(BUILD)

serve: build ## run the daemon in the foreground
	$(BUILD)/geodesicd

clean: ## remove all that was built
	$(if $(wildcard $(BUILD_MARK) $(BUILD)/generated),rm -rf $(BUILD),@echo "nothing was built in $(BUILD)")

# --- libraries -----------------------------------------------------------------------------------

generated = $(patsubst %,$(BUILD)/obj/generated/%.o,$(1))
$(eval $(call library,$(LIB_PROTO),$(call objects,$(PROTO_C)) $(call generated,fields parameters queries values requests answers)))
$(eval $(call library,$(LIB_SERVER),$(call objects,$(SERVER_C)) $(call generated,routes assets)))
$(eval $(call library,$(LIB_SAMPLES),$(call objects,$(SAMPLES_C))))

# --- programs ------------------------------------------------------------------------------------

$(BUILD)/geodesicd: $(BUILD)/obj/server/main.c.o $(LIB_SERVER) $(LIB_PROTO) $(LIB_ENGINE) $(LINK)
	$(call link,$(CXX)) $(ENGINE_LIBS) $(SERVER_LIBS)

$(BUILD)/gd_sample: $(BUILD)/obj/tests/samples/main.c.o $(LIB_SAMPLES) $(LIB_ENGINE) $(LINK)
	$(call link,$(CXX)) $(ENGINE_LIBS)

# --- generated sources: routes, members of requests, fields of answers ----------------------------

CONTRACT := proto/openapi.yaml $(wildcard proto/*.py)

$(BUILD)/generated/sources: $(CONTRACT) | $(BUILD)/stamps/tools
	@mkdir -p $(@D)
	$(call tell,GEN)python3 proto/generate.py sources proto/openapi.yaml $(@D) && touch $@
$(patsubst %,$(BUILD)/generated/%,routes.c handlers.h fields.h fields.c parameters.h parameters.c \
    values.h values.c requests.h requests.c answers.h answers.c queries.h queries.c): $(BUILD)/generated/sources ;

# Skips makefiles whose folder is missing: docker/Dockerfile copies only what the daemon needs.
include $(wildcard docker/setup.mk clients/clients.mk tests/tests.mk tests/fault.mk tests/bench.mk \
                   tests/lint.mk docker/packages.mk)

-include $(shell find $(BUILD)/obj $(BUILD)/pic $(BUILD)/ablation -name '*.d' 2>/dev/null)
