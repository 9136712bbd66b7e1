# Refuses paths that make or a shell would read as something else, and build folders that hold files
# of others. Included first by the Makefile, so nothing has run when it stops.

empty   :=
space   := $(empty) $(empty)
tab     := $(empty)	$(empty)
define newline


endef
ODD_CHARACTERS := : ; | & < > ( ) * ? [ ] { } " ' ` \ ! \# $$ % ~ =
# The characters of a path that are refused; empty: the path is fine.
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
# One spelling for each folder, since the dependencies that compilers write name its files.
override BUILD := $(patsubst $(CURDIR)/%,%,$(abspath $(BUILD)))

# `make clean` removes the build folder, so it is never the checkout, a folder around it, one of its
# source folders, or a folder that holds anything before the first build. CACHEDIR.TAG marks it.
BUILD_PLACE    := $(or $(realpath $(BUILD)),$(abspath $(BUILD)))
BUILD_MARK     := $(BUILD)/CACHEDIR.TAG
BUILD_CONTENTS := $(notdir $(wildcard $(BUILD)/* $(BUILD)/.[!.]*))
SOURCE_FOLDERS := $(addprefix $(realpath .)/,.ci .git clients docker engine proto server tests)
ifneq ($(filter $(patsubst %/,%,$(BUILD_PLACE))/%,$(realpath .)/)$(filter $(SOURCE_FOLDERS) $(addsuffix /%,$(SOURCE_FOLDERS)),$(BUILD_PLACE)),)
$(error BUILD=$(BUILD) is the checkout, a folder around it or one of sources: name another)
endif
# A folder of an earlier version has no mark; the pages in `web` may be there before all else.
ifeq ($(wildcard $(BUILD_MARK))$(and $(filter obj,$(BUILD_CONTENTS)),$(filter generated,$(BUILD_CONTENTS))),)
ifneq ($(filter-out web,$(BUILD_CONTENTS)),)
$(error BUILD=$(BUILD) holds other files ($(firstword $(BUILD_CONTENTS))): name a new or an empty folder)
endif
endif

$(BUILD_MARK):
	@mkdir -p $(@D) && printf '%s\n' 'Signature: 8a477f597d28d172789f06886806bc55' \
	    '# What make has built here can be built again; make clean removes this folder.' >$@
