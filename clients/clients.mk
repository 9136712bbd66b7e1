# The daemon's web pages, and the client library for C. Included by the Makefile.

.PHONY: client-c pages check-pages

# clients/web/build.sh builds the pages with packages of npm, once for all builds below $(BUILD).
# With VIEWER=no, one page replaces them; it says that the viewer is missing.
VIEWER ?= yes
export PAGES_BUILD ?= $(abspath $(BUILD)/web)
ifeq ($(VIEWER),no)
PAGES := clients/web/without/index.html
else
PAGES := $(PAGES_BUILD)/pages/licenses.txt
endif

$(PAGES_BUILD)/installed: clients/web/package.json clients/web/package-lock.json | $(BUILD_MARK)
	@clients/web/build.sh install $(PAGES_BUILD)

$(PAGES_BUILD)/pages/licenses.txt: $(PAGES_BUILD)/installed $(shell find clients/web clients/js/types.d.ts -name node_modules -prune -o -type f -print)
	@clients/web/build.sh bundle $(PAGES_BUILD)

pages: $(PAGES)

check-pages: $(PAGES_BUILD)/installed
	@clients/web/build.sh check $(PAGES_BUILD)

$(BUILD)/generated/pages-$(VIEWER):
	@mkdir -p $(@D)
	@rm -f $(@D)/pages-* && touch $@

# The documents below /docs, and the client library for JavaScript as /client.js. The prerequisites
# include the sources from which render.py makes the tables of reference.md.
DOCUMENTS := $(BUILD)/generated/documents
$(DOCUMENTS)/docs/page.css: clients/js/index.js $(wildcard server/doc/guide/* server/doc/guide/drawings/*) $(BUILD)/generated/pages-$(VIEWER) proto/openapi.yaml proto/json/problem.h \
    server/config/config.c server/exchange/metrics.c server/gauges.c server/access/access.c
	$(call tell,GEN)server/doc/guide/render.py $(if $(filter no,$(VIEWER)),,--contract) $(DOCUMENTS) && cp $< $(DOCUMENTS)/client.js

$(BUILD)/generated/assets.c: $(CONTRACT) $(PAGES) $(DOCUMENTS)/docs/page.css $(BUILD)/generated/pages-$(VIEWER)
	@mkdir -p $(@D)
	$(call tell,GEN)python3 proto/generate.py assets proto/openapi.yaml $(dir $(PAGES)) $(DOCUMENTS) > $@

# --- the client library for C --------------------------------------------------------------------

LIB_CLIENT  := $(BUILD)/libgeodesicd-client.a
CLIENT_LIBS := -lcurl -ljansson -lm
CLIENTS     := $(BUILD)/gd_client_scenario $(BUILD)/gd_client_example $(BUILD)/gd_client_example_cc
CMAKE_FILES := $(addprefix $(BUILD)/geodesicd-client-,config.cmake config-version.cmake)

$(call objects,tests/api/scenario.c $(wildcard clients/c/*.c)): | $(BUILD)/stamps/client-headers
$(LIB_CLIENT): $(call objects,$(filter-out %/example.c,$(wildcard clients/c/*.c)))

##@ Clients

client-c: $(LIB_CLIENT) $(BUILD)/geodesicd-client.pc $(CMAKE_FILES) $(filter-out %_scenario,$(CLIENTS)) ## the client library for C and C++, and its examples

$(BUILD)/gd_client_scenario: $(call objects,tests/api/scenario.c) $(LIB_CLIENT) $(LINK)
	$(call link,$(CC)) $(CLIENT_LIBS)

$(BUILD)/gd_client_example: $(call objects,clients/c/example.c) $(LIB_CLIENT) $(LINK)
	$(call link,$(CC)) $(CLIENT_LIBS)

$(BUILD)/gd_client_example_cc: $(call objects,clients/c/example.cc) $(LIB_CLIENT) $(LINK)
	$(call link,$(CXX)) $(CLIENT_LIBS)
