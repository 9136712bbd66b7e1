# Builds the engine's libraries: archives for the daemon, and shared objects for other programs.
# Included by the Makefile.

# Rooms (folders of the engine) of each library, in order of rank: see engine/README.md.
# ROOMS="base io" builds only these rooms.
ROOMS_geodesic        := base mesh io plane repair construction window kernel guide wavefront field \
                         line query
ROOMS_geodesic-tools  := transport render edit cut
ROOMS_geodesic-smooth := subdiv loops nurbs
# The first library is the core. The others use only the core, so it comes last for the linker.
LIBRARIES := geodesic geodesic-tools geodesic-smooth
ROOMS     ?= $(foreach name,$(LIBRARIES),$(ROOMS_$(name)))

# $(call sources_of,LIBRARY): the source files of a library
sources_of = $(foreach room,$(filter $(ROOMS),$(ROOMS_$(1))),$(wildcard engine/$(room)/*.c engine/$(room)/*.cc))

LIB_ENGINE  := $(foreach name,geodesic-smooth geodesic-tools geodesic,$(BUILD)/lib$(name).a)
$(foreach name,$(LIBRARIES),$(eval $(call library,$(BUILD)/lib$(name).a,$(call objects,$(call sources_of,$(name))))))

# Expat 2.9 deprecates functions whose replacements Debian 12 (2.5) does not have.
$(foreach folder,obj pic,$(BUILD)/$(folder)/engine/io/3mf_model.c.o): FILE_FLAGS += -Wno-deprecated-declarations

# --- shared objects, on request: sources compiled again as position-independent code --------------

SONAME  := 0
PIC     := -fPIC -fvisibility=default -fno-semantic-interposition
SHARED  := $(foreach name,$(LIBRARIES),$(BUILD)/lib$(name).so.$(SONAME))
PIC_OBJECTS = $(patsubst %,$(BUILD)/pic/%.o,$(call sources_of,$(1)))

$(BUILD)/pic/%.c.o: %.c $(COMPILE)
	@mkdir -p $(@D)
	$(call tell,CC,$<)$(compile_c) $(PIC)
$(BUILD)/pic/%.cc.o: %.cc $(COMPILE)
	@mkdir -p $(@D)
	$(call tell,CXX,$<)$(compile_cxx) $(PIC)

# Names of public functions begin with gd_ and a letter. The other libraries also use functions of
# the core that are not public. These have the symbol version GEODESIC_PRIVATE, and only libraries
# of the same build may use them.
private_users = $(if $(filter geodesic,$(1)),$(foreach user,$(filter-out geodesic,$(LIBRARIES)),$(call PIC_OBJECTS,$(user))))
$(BUILD)/libgeodesic.map: $(call private_users,geodesic)
$(BUILD)/%.map:
	@mkdir -p $(@D)
	@{ echo 'GEODESIC_$(SONAME) { global: gd_[!_]*; local: *; };'; \
	   $(if $(filter %.o,$^),echo 'GEODESIC_PRIVATE { global:'; nm -u $(filter %.o,$^) | sed -n 's/^ *U \(gd__.*\)/    \1;/p' | sort -u; echo '};';) \
	 } >$@

# $(call shared,LIBRARY,COMPILER,LIBRARIES THAT IT NEEDS): the rule of a shared object
define shared
$(BUILD)/lib$(1).so.$(SONAME): $(call PIC_OBJECTS,$(1)) $(BUILD)/lib$(1).map $(LINK)
	$$(call tell,LD)$(2) -shared $$(GD_LDFLAGS) $$(LDFLAGS) -Wl,-soname,$$(@F) -Wl,--version-script,$(BUILD)/lib$(1).map \
	    -Wl,-z,defs -Wl,--as-needed -Wl,-Bsymbolic-functions -o $$@ $$(filter %.o,$$^) $(3)
	@ln -sf $$(@F) $(BUILD)/lib$(1).so
endef
$(eval $(call shared,geodesic,$(CXX),-lm -lz -lminizip -lexpat))
$(eval $(call shared,geodesic-tools,$(CXX),$(BUILD)/libgeodesic.so.$(SONAME) -lm -lz -lOpenMeshTools -lOpenMeshCore))
$(eval $(call shared,geodesic-smooth,$(CC),$(BUILD)/libgeodesic.so.$(SONAME) -lm))
$(filter-out %/libgeodesic.so.$(SONAME),$(SHARED)): | $(BUILD)/libgeodesic.so.$(SONAME)

##@ Libraries for other programs

.PHONY: libraries
libraries: $(SHARED) $(LIB_ENGINE) ## libgeodesic, -tools and -smooth, shared and static
