# Installs the packages of Debian or Ubuntu that building, running and testing need. Included by the
# Makefile.

.PHONY: setup setup-test

# Packages for the daemon, its pages and the demo.
PACKAGES := g++ make libmicrohttpd-dev libjansson-dev libgnutls28-dev libseccomp-dev libsqlite3-dev \
            libpq-dev zlib1g-dev libminizip-dev libexpat1-dev python3 python3-markdown python3-yaml curl ca-certificates
# Debian's libopenmesh-dev depends on OpenSceneGraph, LLVM and Mesa (more than 500 MB), which the
# engine does not use. So the headers of libopenmesh-dev are unpacked into the checkout, unless the
# package is installed.
UNPACKED := --unpack $(OPENMESH) libopenmesh-dev
# Packages that only the tests need. Tests start HAProxy and PostgreSQL themselves, so the services
# of these packages need not run.
TEST_PACKAGES := clang clang-format codespell libclang-rt-{clang}-dev libcmocka-dev libcurl4-openssl-dev python3-jsonschema \
                 debhelper dh-python lintian pkg-config haproxy postgresql
OPTIONAL_TEST_PACKAGES := libosd-dev wrk $(KUBECTL) python3-numpy python3-tqdm python3-plotly python3-setuptools python3-wheel mypy cmake zsh fish
# CGAL's headers and those of Boost take 180 MB, so their packages are only downloaded. They are
# unpacked while the program that uses them is compiled (tests/bench.mk).
CGAL := $(CURDIR)/build/cgal
# The pages need node and npm, from Debian or elsewhere. If the system has no npm, npm is installed
# into the checkout.
NODE     = $(if $(filter no,$(VIEWER)),,$(shell command -v node >/dev/null || echo nodejs) --npm $(NPM) 10.9.4)
NPM     := $(CURDIR)/build/npm
export PATH := $(PATH):$(NPM)/node_modules/.bin
# The tests of the pages need a browser: Debian's chromium without windows, which needs no GTK. It
# is unpacked into the checkout, because its package depends on Mesa and LLVM (160 MB), which it
# does not use without windows. Ubuntu has only a snap of chromium, which is not installed.
CHROMIUM = $(if $(filter no,$(VIEWER)),,$(shell command -v chromium >/dev/null || grep -qs '^ID=ubuntu' /etc/os-release || \
               echo --unpack $(CURDIR)/build/chromium '"chromium-headless-shell chromium-common"'))
# Other vendors' packages of kubectl conflict with Debian's.
KUBECTL  = $(shell command -v kubectl >/dev/null || echo kubernetes-client)

##@ Preparation

setup: ## install what building and the demo need (Debian, Ubuntu)
	@docker/install_packages.sh $(PACKAGES) $(NODE) $(UNPACKED)

setup-test: ## install what all tests need
	@docker/install_packages.sh $(PACKAGES) $(NODE) $(TEST_PACKAGES) $(UNPACKED) $(CHROMIUM) --download $(CGAL) libcgal-dev --if-available $(OPTIONAL_TEST_PACKAGES)
