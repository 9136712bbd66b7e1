# Rules for objects, archives and programs, and the conditions under which they are rebuilt.
# Included by the Makefile, after the flags.

# $(call tell,NAME,FILE): precedes a command in a recipe and prints NAME and FILE (the target by
# default) instead of the command. With V=1 make prints the command.
tell = $(if $(filter-out 0,$(V)),,@printf '  %-3s  %s\n' $(1) $(or $(2),$@);)

# FILE_FLAGS: flags of single files, as target-specific variables of their objects.
compile_c   = $(CC) $(GD_CPPFLAGS) $(CPPFLAGS) $(GD_CFLAGS) $(FILE_FLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<
compile_cxx = $(CXX) $(GD_CPPFLAGS) $(OPENMESH_CPPFLAGS) $(CPPFLAGS) $(GD_CXXFLAGS) $(FILE_FLAGS) $(CXXFLAGS) -MMD -MP -c -o $@ $<
# $(call link,COMPILER) LIBRARIES: the recipe that links a program.
link = $(call tell,LD)$(1) $(GD_LDFLAGS) $(LDFLAGS) -o $@ $(filter %.o %.a %.so,$^)

.PHONY: FORCE
FORCE:

# $(call stamp,NAME,VARIABLE): the rule of the file stamps/NAME. It is rewritten if the variable's
# value has changed. Targets that depend on the value depend on this file. The exception is `make
# install` without flags: it installs the existing build even if the value has changed.
FLAGS_GIVEN := $(foreach name,CC CXX OPT DEBUG SAN CPPFLAGS CFLAGS CXXFLAGS LDFLAGS,$(findstring command,$(origin $(name))))
AS_BUILT    := $(if $(filter-out install install-libraries uninstall,$(or $(MAKECMDGOALS),build))$(strip $(FLAGS_GIVEN)),,yes)
define stamp
$(BUILD)/stamps/$(1): export STAMP = $$($(2))
ifneq ($$($(2)),$$(file <$(BUILD)/stamps/$(1)))
$(BUILD)/stamps/$(1): $(if $(AS_BUILT),,FORCE)
endif
endef
$(BUILD)/stamps/%: | $(BUILD_MARK)
	@mkdir -p $(@D) && printf '%s\n' "$$STAMP" >$@

# $(call library,ARCHIVE,OBJECTS): the rule of an archive. A changed list of objects also rebuilds
# the archive.
define library
$(subst /,_,$(1))_LIST := $(2)
$(call stamp,$(notdir $(1)),$(subst /,_,$(1))_LIST)
$(1): $(2) $(BUILD)/stamps/$(notdir $(1))
endef

# Archives that `make install` does not copy are thin: they contain only the names of the objects.
%.a: THIN = $(if $(SAN),T)
%/libgd_proto.a %/libgd_server.a %/libgd_samples.a %/libgd_support.a: THIN = T
%.a:
	@rm -f $@
	$(call tell,AR)$(AR) rcs$(THIN) $@ $(filter %.o,$^)

# Kernels compiled for AVX2 and AVX-512 from common sources. The daemon chooses one when it starts
# (engine/kernel/cpu.c).
ifneq ($(filter x86_64%,$(shell $(CC) -dumpmachine 2>/dev/null)),)
AVX2_FLAGS        := -mavx2
AVX512_FLAGS      := -mavx512f -mavx512vl -mavx512dq -mprefer-vector-width=512
$(foreach folder,obj pic,$(BUILD)/$(folder)/engine/%_avx2.c.o): FILE_FLAGS += $(AVX2_FLAGS)
$(foreach folder,obj pic,$(BUILD)/$(folder)/engine/%_avx512.c.o): FILE_FLAGS += $(AVX512_FLAGS)
endif

# OpenMesh, where `make setup` has unpacked it (docker/setup.mk); a system's OpenMesh has priority.
# Only files in C++ include it.
OPENMESH          := $(CURDIR)/build/openmesh
OPENMESH_CPPFLAGS := -idirafter $(OPENMESH)/usr/include
ifneq ($(wildcard $(OPENMESH)/usr/lib/*),)
export LIBRARY_PATH := $(wildcard $(OPENMESH)/usr/lib/*)$(if $(LIBRARY_PATH),:$(LIBRARY_PATH))
endif

# All objects depend on the compiler's flags and on this file. All programs depend on the linker's
# flags and on the makefiles that link programs.
COMPILE_VALUE := $(strip $(CC) : $(CXX) : $(GD_CPPFLAGS) $(CPPFLAGS) : $(GD_CFLAGS) $(CFLAGS) : \
                 $(GD_CXXFLAGS) $(CXXFLAGS) : $(AVX2_FLAGS) $(AVX512_FLAGS) $(AVX512_BASE_FLAGS) : \
                 $(shell cksum <docker/rules.mk))
LINK_VALUE    := $(strip $(CC) : $(CXX) : $(GD_LDFLAGS) $(LDFLAGS) : $(ENGINE_LIBS) : $(SERVER_LIBS) : \
                 $(shell cat Makefile docker/rules.mk engine/libraries.mk $(wildcard tests/*.mk) | cksum))
COMPILE := $(BUILD)/stamps/compile
LINK    := $(BUILD)/stamps/link
$(eval $(call stamp,compile,COMPILE_VALUE))
$(eval $(call stamp,link,LINK_VALUE))

$(BUILD)/obj/%.c.o: %.c $(COMPILE) | $(BUILD)/generated/sources
	@mkdir -p $(@D)
	$(call tell,CC,$<)$(compile_c)

$(BUILD)/obj/%.cc.o: %.cc $(COMPILE)
	@mkdir -p $(@D)
	$(call tell,CXX,$<)$(compile_cxx)

$(BUILD)/obj/generated/%.o: FILE_FLAGS += -Iserver
$(BUILD)/obj/generated/%.o: $(BUILD)/generated/%.c $(COMPILE)
	@mkdir -p $(@D)
	$(call tell,CC,$<)$(compile_c)
