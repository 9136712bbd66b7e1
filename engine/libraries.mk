# The engine's libraries: which rooms each has, as archives for the daemon and as shared objects for
# other programs. Included by the Makefile.

# Rooms of each library, in order of rank (see README). ROOMS="base io" builds a part of the house.
ROOMS_geodesic        := base mesh io repair construction window kernel guide wavefront partition \
                         field line query
ROOMS_geodesic-tools  := transport render cut
ROOMS_geodesic-smooth := subdiv nurbs
# The first one is the core. The others use it and not each other, so linkers take the core last.
LIBRARIES := geodesic geodesic-tools geodesic-smooth
ROOMS     ?= $(foreach name,$(LIBRARIES),$(ROOMS_$(name)))

# $(call sources_of,LIBRARY)
sources_of = $(foreach room,$(filter $(ROOMS),$(ROOMS_$(1))),$(wildcard engine/$(room)/*.c engine/$(room)/*.cc))

LIB_ENGINE  := $(foreach name,geodesic-smooth geodesic-tools geodesic,$(BUILD)/lib$(name).a)
$(foreach name,$(LIBRARIES),$(eval $(call library,$(BUILD)/lib$(name).a,$(call objects,$(call sources_of,$(name))))))

# --- shared objects: compiled a second time, position-independent, only when asked for --------------

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

# Public functions begin with gd_ and a letter. What the other libraries use of the core besides is
# exported under the version GEODESIC_PRIVATE: it is for libraries of the same build only.
private_users = $(if $(filter geodesic,$(1)),$(foreach user,$(filter-out geodesic,$(LIBRARIES)),$(call PIC_OBJECTS,$(user))))
$(BUILD)/libgeodesic.map: $(call private_users,geodesic)
$(BUILD)/%.map:
	@mkdir -p $(@D)
	@{ echo 'GEODESIC_$(SONAME) { global: gd_[!_]*; local: *; };'; \
	   $(if $(filter %.o,$^),echo 'GEODESIC_PRIVATE { global:'; nm -u $(filter %.o,$^) | sed -n 's/^ *U \(gd__.*\)/    \1;/p' | sort -u; echo '};';) \
	 } >$@

# $(call shared,LIBRARY,COMPILER,LIBRARIES IT NEEDS)
define shared
$(BUILD)/lib$(1).so.$(SONAME): $(call PIC_OBJECTS,$(1)) $(BUILD)/lib$(1).map $(LINK)
	$$(call tell,LD)$(2) -shared $$(GD_LDFLAGS) $$(LDFLAGS) -Wl,-soname,$$(@F) -Wl,--version-script,$(BUILD)/lib$(1).map \
	    -Wl,-z,defs -Wl,--as-needed -Wl,-Bsymbolic-functions -o $$@ $$(filter %.o,$$^) $(3)
	@ln -sf $$(@F) $(BUILD)/lib$(1).so
endef
$(eval $(call shared,geodesic,$(CXX),-lm))
$(eval $(call shared,geodesic-tools,$(CC),$(BUILD)/libgeodesic.so.$(SONAME) -lm -lz))
$(eval $(call shared,geodesic-smooth,$(CC),$(BUILD)/libgeodesic.so.$(SONAME) -lm))
$(filter-out %/libgeodesic.so.$(SONAME),$(SHARED)): | $(BUILD)/libgeodesic.so.$(SONAME)

##@ Libraries for other programs

.PHONY: libraries
libraries: $(SHARED) $(LIB_ENGINE) ## libgeodesic, -tools and -smooth, shared and static
