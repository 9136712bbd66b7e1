# Installation and packages. Included by the Makefile, whose variables it uses.
#
# Two lists name the installed files and their destinations. The targets install and uninstall and
# the Debian packages (docker/debian) follow them.

.PHONY: install install-libraries uninstall deb image man dist test-package test-container test-cluster

##@ Installation and packages

PREFIX    ?= /usr/local
LIBDIR    ?= $(PREFIX)/lib
UNITDIR   ?= $(PREFIX)/lib/systemd/system
DOCDIR    := $(PREFIX)/share/doc/geodesicd
# The folder of Python packages below PREFIX. Python's default search path may lack it; the command
# geodesic always searches it.
PYTHONDIR ?= $(firstword $(wildcard $(PREFIX)/lib/python3.*/dist-packages) $(PREFIX)/lib/python3/dist-packages)

# The engine's libraries, as mode:file:destination or link:target:destination. Headers have their
# own folder, since libgd (another package) installs /usr/include/gd.h.
INSTALLED_LIBRARIES = \
            $(foreach file,$(notdir $(SHARED)),644:$(BUILD)/$(file):$(LIBDIR)/$(file) link:$(file):$(LIBDIR)/$(basename $(file))) \
            $(foreach name,$(LIBRARIES),644:$(BUILD)/lib$(name).a:$(LIBDIR)/lib$(name).a \
                644:$(BUILD)/$(name).pc:$(LIBDIR)/pkgconfig/$(name).pc) \
            $(foreach header,$(wildcard engine/include/gd/*.h),644:$(header):$(PREFIX)/include/geodesic/gd/$(notdir $(header))) \
            644:engine/examples/geodesic.c:$(PREFIX)/share/doc/libgeodesic-dev/examples/geodesic.c \
            644:engine/geodesic.3:$(PREFIX)/share/man/man3/geodesic.3

# All other files.
INSTALLED = 755:$(BUILD)/geodesicd:$(PREFIX)/bin/geodesicd \
            644:$(BUILD)/geodesicd.8:$(PREFIX)/share/man/man8/geodesicd.8 \
            644:$(BUILD)/geodesicd.service:$(UNITDIR)/geodesicd.service \
            755:$(BUILD)/geodesic:$(PREFIX)/bin/geodesic \
            644:$(BUILD)/geodesic.1:$(PREFIX)/share/man/man1/geodesic.1 \
            644:clients/cli/geodesic.bash:$(PREFIX)/share/bash-completion/completions/geodesic \
            644:clients/cli/geodesic.zsh:$(PREFIX)/share/zsh/vendor-completions/_geodesic \
            644:clients/cli/geodesic.fish:$(PREFIX)/share/fish/vendor_completions.d/geodesic.fish \
            $(foreach file,$(wildcard clients/python/geodesicd/*.py) clients/python/geodesicd/py.typed,644:$(file):$(PYTHONDIR)/geodesicd/$(notdir $(file))) \
            644:$(LIB_CLIENT):$(LIBDIR)/libgeodesicd-client.a \
            644:$(BUILD)/geodesicd-client.pc:$(LIBDIR)/pkgconfig/geodesicd-client.pc \
            $(foreach file,$(notdir $(CMAKE_FILES)),644:$(BUILD)/$(file):$(LIBDIR)/cmake/geodesicd-client/$(file)) \
            $(foreach header,geodesicd.h geodesicd.hpp,644:clients/c/$(header):$(PREFIX)/include/$(header)) \
            $(foreach name,how-to operating explanation comparison tutorial python,644:server/doc/guide/$(name).md:$(DOCDIR)/$(name).md) \
            $(foreach name,alerts.yaml grafana-dashboard.json,644:docker/$(name):$(DOCDIR)/examples/$(name))

# $(call files_of,LIST): the files of a list. $(call put,LIST): the recipe that installs a list.
files_of = $(foreach file,$(filter-out link:%,$(1)),$(word 2,$(subst :, ,$(file))))
define put
@IFS=:; for file in $(1); do set -- $$file; place="$(DESTDIR)$$3"; \
    case $$1 in \
    link) ln -sf "$$2" "$$place" ;; \
    *) install -Dm$$1 "$$2" "$$place" ;; \
    esac || exit 1; done
endef

install: install-libraries $(call files_of,$(INSTALLED)) ## install daemon, clients, libraries, man pages and unit (PREFIX=/usr/local DESTDIR=)
	$(call put,$(INSTALLED))

install-libraries: $(call files_of,$(INSTALLED_LIBRARIES)) ## install the engine's libraries, headers and geodesic(3) only
	$(call put,$(INSTALLED_LIBRARIES))

uninstall: ## remove the installed files
	@for file in $(INSTALLED) $(INSTALLED_LIBRARIES); do rm -f "$(DESTDIR)$${file##*:}"; done
	@rm -rf "$(DESTDIR)$(PYTHONDIR)/geodesicd/__pycache__"
	@find $(foreach folder,$(PYTHONDIR)/geodesicd $(PREFIX)/include/geodesic $(PREFIX)/share/doc/libgeodesic-dev $(DOCDIR),"$(DESTDIR)$(folder)") -depth -type d -empty -delete 2>/dev/null || true

man: $(BUILD)/geodesicd.8 ## make the man page geodesicd(8) from the options of the program
$(BUILD)/geodesicd.8: server/doc/manual.py $(BUILD)/geodesicd
	$(call tell,GEN)server/doc/manual.py $(BUILD)/geodesicd > $@

$(BUILD)/geodesic.1: clients/cli/manual.py clients/cli/geodesic $(wildcard clients/python/geodesicd/*.py)
	@mkdir -p $(@D)
	$(call tell,GEN)clients/cli/manual.py clients/cli/geodesic > $@

# make writes these files each time, because PREFIX may have changed.
VERSION = $$(sed -n 's/^  version: *//p' proto/openapi.yaml | head -n 1)
configure = @mkdir -p $(@D) && sed "s|@PREFIX@|$(PREFIX)|; s|@LIBDIR@|$(LIBDIR)|; s|@VERSION@|$(VERSION)|" \
                $(wildcard engine/$(@F).in clients/c/$(@F).in) > $@
$(BUILD)/%.pc: FORCE
	$(configure)
$(BUILD)/%.cmake: FORCE
	$(configure)
$(BUILD)/geodesicd.service: docker/geodesicd.service FORCE
	@mkdir -p $(@D)
	@sed "s|/usr/bin/|$(PREFIX)/bin/|" $< > $@
$(BUILD)/geodesic: clients/cli/geodesic FORCE
	@mkdir -p $(@D)
	@sed '1s|/usr/bin/env python3|/usr/bin/python3|; s|^sys.path.append(.*$$|sys.path.append("$(PYTHONDIR)")|' $< > $@

# The packages are built in a copy of docker/debian, since dpkg requires a folder `debian`.
# DEB_BUILD=$(BUILD) packages the existing build. The variables of flags are then set, so debhelper
# does not add hardening flags, which would change the build.
DEB_BUILD ?= $(BUILD)/hardened
DEB_FLAGS = $(if $(filter $(abspath $(BUILD)),$(abspath $(DEB_BUILD))), \
                $(foreach name,CPPFLAGS CFLAGS CXXFLAGS LDFLAGS,$(name)="$$$(name)"))
deb: | $(BUILD)/stamps/package-tools ## build the Debian packages of daemon, clients, libraries (needs debhelper)
	@rm -rf $(BUILD)/deb && mkdir -p $(BUILD)/deb/source && cp -r docker/debian $(BUILD)/deb/source/debian
	@cd $(BUILD)/deb/source && $(DEB_FLAGS) SOURCE=$(CURDIR) DEB_BUILD=$(abspath $(DEB_BUILD)) \
	    DEB_BUILD_OPTIONS="$(DEB_BUILD_OPTIONS) noautodbgsym" \
	    dpkg-buildpackage --build=binary --unsigned-changes --no-check-builddeps >../log 2>&1 || { tail -n 30 ../log; exit 1; }
	@rm -rf $(BUILD)/deb/source && ls $(BUILD)/deb/*.deb

image: ## build the container image and its bill of materials (docker, podman or buildah; BASE= SOURCE= VIEWER=no)
	@BASE='$(BASE)' SOURCE='$(SOURCE)' VIEWER='$(VIEWER)' docker/image.sh $(BUILD)

dist: | $(BUILD_MARK) ## make the files of a release: sources, packages of the clients, SPDX list, checksums
	@docker/dist.py $(BUILD)/dist

test-container: ## build, run and test the container image (needs buildah, mmdebstrap, root)
	@tests/container/run.py --place $(BUILD)/container

test-package: build client-c ## install, run and remove the Debian packages in a fresh Debian (needs debhelper, lintian, mmdebstrap, root)
	@tests/package/run.py --build $(BUILD) --chroot

test-cluster: build $(BUILD)/gd_load ## test several nodes with HAProxy and one PostgreSQL database (needs haproxy, wrk, postgresql)
	@tests/run.py --jobs 1 --timeout 1800 tests/cluster/routing.py tests/cluster/shared.py "tests/cluster/run.py --long" tests/cluster/capacity.py tests/cluster/shipped.py
