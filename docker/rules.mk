# How objects, archives and programs are made, and when they are made again. Included by the Makefile,
# after the flags.

# Before a command that makes a file: prints its short name and the file (of compilers the source).
# V=1: the command instead.
tell = $(if $(filter-out 0,$(V)),,@printf '  %-3s  %s\n' $(1) $(or $(2),$@);)

# FILE_FLAGS: of single files, set for their objects.
compile_c   = $(CC) $(GD_CPPFLAGS) $(CPPFLAGS) $(GD_CFLAGS) $(FILE_FLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<
compile_cxx = $(CXX) $(GD_CPPFLAGS) $(CPPFLAGS) $(GD_CXXFLAGS) $(FILE_FLAGS) $(CXXFLAGS) -MMD -MP -c -o $@ $<
# $(call link,COMPILER) LIBRARIES: the recipe of a program.
link = $(call tell,LD)$(1) $(GD_LDFLAGS) $(LDFLAGS) -o $@ $(filter %.o %.a,$^)

.PHONY: FORCE
FORCE:

# $(call stamp,NAME,VARIABLE): the file stamps/NAME is written when the variable's value has changed;
# what depends on the value depends on the file. `make install` alone takes what is built as it is.
FLAGS_GIVEN := $(foreach name,CC CXX OPT SAN CPPFLAGS CFLAGS CXXFLAGS LDFLAGS,$(findstring command,$(origin $(name))))
AS_BUILT    := $(if $(filter-out install install-libraries uninstall,$(or $(MAKECMDGOALS),build))$(strip $(FLAGS_GIVEN)),,yes)
define stamp
$(BUILD)/stamps/$(1): export STAMP = $$($(2))
ifneq ($$($(2)),$$(file <$(BUILD)/stamps/$(1)))
$(BUILD)/stamps/$(1): $(if $(AS_BUILT),,FORCE)
endif
endef
$(BUILD)/stamps/%: | $(BUILD_MARK)
	@mkdir -p $(@D) && printf '%s\n' "$$STAMP" >$@

# $(call library,ARCHIVE,OBJECTS): its rule. It is made again when an object leaves the list, too.
define library
$(subst /,_,$(1))_LIST := $(2)
$(call stamp,$(notdir $(1)),$(subst /,_,$(1))_LIST)
$(1): $(2) $(BUILD)/stamps/$(notdir $(1))
endef

%.a:
	@rm -f $@
	$(call tell,AR)$(AR) rcs $@ $(filter %.o,$^)

# One source, compiled for several machines; the daemon chooses when it starts (engine/kernel/cpu.c).
ifneq ($(filter x86_64%,$(shell $(CC) -dumpmachine 2>/dev/null)),)
AVX2_FLAGS        := -mavx2
AVX512_FLAGS      := -mavx512f -mavx512vl -mavx512dq -mprefer-vector-width=512
AVX512_BASE_FLAGS := -mavx512bw
$(foreach folder,obj pic,$(BUILD)/$(folder)/engine/%_avx2.c.o): FILE_FLAGS += $(AVX2_FLAGS)
$(foreach folder,obj pic,$(BUILD)/$(folder)/engine/%_avx512.c.o): FILE_FLAGS += $(AVX512_FLAGS)
$(foreach folder,obj pic,$(BUILD)/$(folder)/engine/base/%_avx512.c.o): FILE_FLAGS += $(AVX512_BASE_FLAGS)
endif

# All objects depend on what compilers are told, all programs on what the linker is told.
COMPILE_VALUE := $(strip $(CC) : $(CXX) : $(GD_CPPFLAGS) $(CPPFLAGS) : $(GD_CFLAGS) $(CFLAGS) : \
                 $(GD_CXXFLAGS) $(CXXFLAGS) : $(AVX2_FLAGS) $(AVX512_FLAGS) $(AVX512_BASE_FLAGS))
LINK_VALUE    := $(strip $(CC) : $(CXX) : $(GD_LDFLAGS) $(LDFLAGS) : $(ENGINE_LIBS) : $(SERVER_LIBS))
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
