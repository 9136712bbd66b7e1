# Checks programs and headers before anything is compiled, and reports those that are missing with
# their packages. Included by the Makefile, after the rules.

# $(call need,NAME,TARGET,PROGRAMS,HEADERS): the rule of stamps/NAME, which is written once all
# programs and headers exist. They are given as PROGRAM:PACKAGE and HEADER:PACKAGE. `make TARGET`
# installs the packages.
define need
$(BUILD)/stamps/$(1): | $(BUILD_MARK)
	@mkdir -p $$(@D); missing=; \
	for pair in $(3); do command -v "$$$${pair%%:*}" >/dev/null || missing="$$$$missing $$$$pair"; done; \
	[ -n "$$$$missing" ] || for pair in $(4); do printf '#if !__has_include(<%s>)\n#error\n#endif\n' "$$$${pair%%:*}" | \
	    $(firstword $(CC)) $(wordlist 2,9,$(CC)) $(CPPFLAGS) $(CFLAGS) $(OPENMESH_CPPFLAGS) -E -x c - >/dev/null 2>&1 || missing="$$$$missing $$$$pair"; done; \
	for pair in $$$$missing; do echo "make: $$$${pair%%:*} is missing; Debian's package is $$$${pair#*:}." >&2; done; \
	[ -z "$$$$missing" ] || { echo "make: run 'make $(2)', or install these packages yourself." >&2; exit 1; }; touch $$@
endef

$(eval $(call need,tools,setup,$(firstword $(CC)):gcc $(firstword $(CXX)):g++ ar:binutils find:findutils python3:python3,zlib.h:zlib1g-dev minizip/unzip.h:libminizip-dev expat.h:libexpat1-dev OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh:libopenmesh-dev))
$(eval $(call need,server-headers,setup,,microhttpd.h:libmicrohttpd-dev jansson.h:libjansson-dev \
    gnutls/gnutls.h:libgnutls28-dev seccomp.h:libseccomp-dev sqlite3.h:libsqlite3-dev postgresql/libpq-fe.h:libpq-dev))
$(eval $(call need,test-headers,setup-test,,cmocka.h:libcmocka-dev))
$(eval $(call need,client-headers,setup-test,,curl/curl.h:libcurl4-openssl-dev jansson.h:libjansson-dev))
$(eval $(call need,lint-tools,setup-test,clang:clang clang++:clang clang-format:clang-format,))
$(eval $(call need,package-tools,setup-test,dpkg-buildpackage:dpkg-dev dh:debhelper,))

# All objects depend on $(COMPILE), the stamp of the compiler's flags. So they also depend on the
# tools.
$(COMPILE): | $(BUILD)/stamps/tools
$(call objects,server/main.c $(SERVER_C) $(PROTO_C)): | $(BUILD)/stamps/server-headers
