# What building, running and testing need of Debian, and its installation. Included by the Makefile.

.PHONY: setup setup-test

# Everything that building, running and testing need, from Debian 12's own packages.
PACKAGES := build-essential clang clang-format libmicrohttpd-dev libjansson-dev libgnutls28-dev \
            libseccomp-dev libsqlite3-dev libpq-dev zlib1g-dev libcmocka-dev libclang-rt-14-dev \
            libcurl4-openssl-dev python3 python3-yaml python3-jsonschema curl ca-certificates
SUDO     := $(if $(filter 0,$(shell id -u)),,sudo)
# The pages are made by node and npm, whoever installed them; the tests of the pages want a browser, too.
NODE      = $(if $(filter no,$(VIEWER)),,$(shell command -v node >/dev/null && command -v npm >/dev/null || echo nodejs npm))
CHROMIUM  = $(if $(filter no,$(VIEWER)),,$(shell command -v chromium >/dev/null || echo chromium))
define install_missing
	@missing=$$(for p in $(1); do dpkg-query -W -f='$${Status}' $$p 2>/dev/null | grep -q 'ok installed' || echo $$p; done); \
	if [ -n "$$missing" ]; then echo "installing:" $$missing; export DEBIAN_FRONTEND=noninteractive; \
	    $(SUDO) apt-get -qq update && $(SUDO) apt-get -qq install -y --no-install-recommends $$missing >/dev/null; fi
endef

##@ Preparation

setup: ## install what is missing (Debian 12)
	$(call install_missing,$(PACKAGES) $(NODE))

setup-test: setup ## install what the tests of the pages want, too
	$(call install_missing,$(CHROMIUM))
