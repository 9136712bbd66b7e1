# The web pages that the daemon serves, and the client library for C. Included by the Makefile.

.PHONY: client-c check-pages

# The pages are built by npm's packages, once for all builds below $(BUILD) (clients/web/build.sh).
# VIEWER=no: a page that says that they are missing.
VIEWER ?= yes
export PAGES_BUILD ?= $(abspath $(BUILD)/web)
ifeq ($(VIEWER),no)
PAGES := clients/web/without/index.html
else
PAGES := $(PAGES_BUILD)/pages/licenses.txt
endif

$(PAGES_BUILD)/node_modules/.package-lock.json: clients/web/package.json clients/web/package-lock.json | $(BUILD_MARK)
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

# --- the client library for C ----------------------------------------------------------------------

LIB_CLIENT  := $(BUILD)/libgeodesicd-client.a
CLIENT_LIBS := -lcurl -ljansson -lm
CLIENTS     := $(BUILD)/gd_client_scenario $(BUILD)/gd_client_example

$(LIB_CLIENT): $(call objects,$(filter-out %/example.c,$(wildcard clients/c/*.c)))

##@ Clients

client-c: $(LIB_CLIENT) $(BUILD)/geodesicd-client.pc $(BUILD)/gd_client_example ## the client library for C, and its example

$(BUILD)/gd_client_scenario: $(call objects,tests/api/scenario.c) $(LIB_CLIENT) $(LINK)
	$(call link,$(CC)) $(CLIENT_LIBS)

$(BUILD)/gd_client_example: $(call objects,clients/c/example.c) $(LIB_CLIENT) $(LINK)
	$(call link,$(CC)) $(CLIENT_LIBS)
