# Rejects paths that make or a shell would misread, and build folders that hold other files. The
# Makefile includes this file first, so that make stops before it runs anything.

empty   :=
space   := $(empty) $(empty)
tab     := $(empty)	$(empty)
define newline


endef
ODD_CHARACTERS := : ; | & < > ( ) * ? [ ] { } " ' ` \ ! \# $$ % ~ =
# $(call odd,PATH): the characters of a path that are rejected; empty if the path is valid.
odd = $(strip $(foreach character,$(ODD_CHARACTERS),$(findstring $(character),$(1))) \
              $(if $(findstring $(space),$(1))$(findstring $(tab),$(1))$(findstring $(newline),$(1)),space))

ifneq ($(call odd,$(CURDIR)),)
$(error The path of this checkout has a character that make cannot handle ($(call odd,$(CURDIR))): \
        move it to a path of letters, digits and / . _ - + @ ,)
endif
$(foreach name,BUILD PAGES_BUILD DEB_BUILD PREFIX DESTDIR LIBDIR UNITDIR PYTHONDIR,\
    $(if $(call odd,$($(name))),$(error $(name) has a character that make cannot handle ($(call odd,$($(name)))): \
        use letters, digits and / . _ - + @ ,))\
    $(if $(filter -%,$($(name))),$(error $(name)=$($(name)) begins with '-': write ./$($(name)))))
ifeq ($(BUILD),)
$(error BUILD is empty: name a folder, or leave it out for ./build)
endif
# Brings BUILD into one spelling, because the dependency files that compilers write contain paths
# below it.
override BUILD := $(patsubst $(CURDIR)/%,%,$(abspath $(BUILD)))

# `make clean` removes the build folder. So the build folder must not be the checkout, a folder
# around the checkout, or one of its source folders. It must be empty or new before the first build.
# CACHEDIR.TAG marks a build folder.
BUILD_PLACE    := $(or $(realpath $(BUILD)),$(abspath $(BUILD)))
BUILD_MARK     := $(BUILD)/CACHEDIR.TAG
BUILD_CONTENTS := $(notdir $(wildcard $(BUILD)/* $(BUILD)/.[!.]*))
SOURCE_FOLDERS := $(addprefix $(realpath .)/,.ci .git clients docker engine proto server tests)
ifneq ($(filter $(patsubst %/,%,$(BUILD_PLACE))/%,$(realpath .)/)$(filter $(SOURCE_FOLDERS) $(addsuffix /%,$(SOURCE_FOLDERS)),$(BUILD_PLACE)),)
$(error BUILD=$(BUILD) is the checkout, a folder around it or one of sources: name another)
endif
# Build folders of earlier versions have no mark. `make setup-test` and the pages write the folders
# of BEFORE_MARK before the mark.
BEFORE_MARK := web openmesh npm chromium cgal
ifeq ($(wildcard $(BUILD_MARK))$(and $(filter obj,$(BUILD_CONTENTS)),$(filter generated,$(BUILD_CONTENTS))),)
ifneq ($(filter-out $(BEFORE_MARK),$(BUILD_CONTENTS)),)
$(error BUILD=$(BUILD) holds other files ($(firstword $(filter-out $(BEFORE_MARK),$(BUILD_CONTENTS)))): name a new or an empty folder)
endif
endif

$(BUILD_MARK):
	@mkdir -p $(@D) && printf '%s\n' 'Signature: 8a477f597d28d172789f06886806bc55' \
	    '# What make has built here can be built again; make clean removes this folder.' >$@
