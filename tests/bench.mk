# Benchmarks, and comparisons with other programs. Included by the Makefile.

.PHONY: bench bench-paper bench-peers bench-http bench-around bench-plots sweep

BENCH_C   := $(filter-out tests/bench/http_bare.c,$(wildcard tests/bench/*.c))
ABLATION_C := $(patsubst %,tests/bench/%.c,ablation agreement paper reach tables trial)

$(BUILD)/gd_bench: $(call objects,$(filter-out $(ABLATION_C),$(BENCH_C))) $(LIB_SAMPLES) $(LIB_ENGINE) \
                   $(LINK) | $(BUILD)/gd_ablation
	$(call link,$(CXX)) $(ENGINE_LIBS)

# `gd_bench ablation` runs gd_ablation. Only the engine in gd_ablation has the switches of
# GD_ABLATION, so folders that use struct gd__propagation are compiled a second time.
ABLATION_ROOMS := wavefront partition field query
ABLATION_OBJECTS := $(patsubst %,$(BUILD)/ablation/%.o,$(filter-out tests/bench/main.c,$(BENCH_C)) \
                        $(wildcard $(patsubst %,engine/%/*.c,$(ABLATION_ROOMS))))

$(BUILD)/ablation/%_avx2.c.o: FILE_FLAGS += $(AVX2_FLAGS)
$(BUILD)/ablation/%_avx512.c.o: FILE_FLAGS += $(AVX512_FLAGS)
$(BUILD)/ablation/%.c.o: %.c $(COMPILE) | $(BUILD)/generated/sources
	@mkdir -p $(@D)
	$(call tell,CC,$<)$(compile_c) -DGD_ABLATION

$(BUILD)/gd_ablation: $(ABLATION_OBJECTS) $(LIB_SAMPLES) $(LIB_ENGINE) $(LINK)
	$(call link,$(CXX)) $(ENGINE_LIBS)

# The sweep compares distances with CGAL's. Without CGAL, the program reports this and skips
# the comparison.
SWEEP_SHARED := $(or $(GEODESICD_SHARED),../shared)/meshes
SWEEP_SHORT  := icosphere:level=3 terrain:cells=32 torus genus2:cells=4 tangle:faces=400 saddle cylinder:sides=24 obstacles:count=12 \
                $(wildcard $(foreach name,spot suzanne teapot cow beetle homer fandisk,$(SWEEP_SHARED)/$(name).obj))

# The packages of the headers are in $(CGAL) (docker/setup.mk). A system's CGAL has priority.
$(BUILD)/obj/tests/oracle/cgal_distances.cc.o: FILE_FLAGS += -frounding-math -idirafter $@.headers/usr/include
$(BUILD)/obj/tests/oracle/cgal_distances.cc.o: tests/oracle/cgal_distances.cc $(COMPILE)
	@mkdir -p $(@D)
	@for package in $(wildcard $(CGAL)/*.deb); do dpkg-deb -x $$package $@.headers || exit 1; done
	$(call tell,CXX,$<)$(compile_cxx)
	@rm -rf $@.headers
$(BUILD)/gd_sweep: $(call objects,$(wildcard tests/oracle/cgal_*.c tests/oracle/cgal_*.cc)) $(LIB_SUPPORT) $(LIB_SAMPLES) $(LIB_ENGINE) $(LINK)
	$(call link,$(CXX)) $(ENGINE_LIBS) -lcmocka

$(BUILD)/gd_bench_cgal: $(call objects,tests/bench/peer_cgal.cc $(patsubst %,tests/bench/%.c,peer options input alter measure) \
                          tests/oracle/cgal_distances.cc tests/oracle/cgal_polyline.c) $(LIB_SAMPLES) $(LIB_ENGINE) $(LINK)
	$(call link,$(CXX)) $(ENGINE_LIBS)

# GEOMETRY_CENTRAL names a folder with the source of geometry-central. Its folder `build` must have
# the library, built with -O3 for this machine.
$(BUILD)/obj/tests/bench/peer_geometry_central.cc.o: FILE_FLAGS += -march=native -Wno-shadow -isystem $(GEOMETRY_CENTRAL)/include \
    -isystem $(GEOMETRY_CENTRAL)/deps/happly -isystem $(GEOMETRY_CENTRAL)/deps/nanoflann/include -isystem $(or $(EIGEN),/usr/include/eigen3)
$(BUILD)/gd_bench_geometry_central: $(call objects,tests/bench/peer_geometry_central.cc $(patsubst %,tests/bench/%.c,peer options input alter measure)) \
                                    $(LIB_SAMPLES) $(LIB_ENGINE) $(LINK)
	$(call link,$(CXX)) $(GEOMETRY_CENTRAL)/build/src/libgeometry-central.a $(ENGINE_LIBS)

$(BUILD)/gd_http_bare: $(BUILD)/obj/tests/bench/http_bare.c.o $(LINK)
	$(call link,$(CC)) -lmicrohttpd

##@ Measurements

bench: $(BUILD)/gd_bench ## measure the engine: tables, and bench.json (3 minutes)
	tests/bench/table.py --build $(BUILD)

bench-paper: $(BUILD)/gd_bench ## measure the paper's tables again
	$(BUILD)/gd_bench ablation

bench-peers: $(BUILD)/gd_bench $(BUILD)/gd_bench_cgal $(if $(GEOMETRY_CENTRAL),$(BUILD)/gd_bench_geometry_central) ## compare with CGAL, and with VTP=... LIBIGL=... GEOMETRY_CENTRAL=... EXPERIMENT=... (see tests/bench/peers.py)
	tests/bench/peers.py --build $(BUILD)

bench-http: build $(BUILD)/gd_http_bare ## measure requests a second and latency, and compare with bare libmicrohttpd (needs wrk)
	tests/bench/throughput.py --build $(BUILD)

bench-around: build $(BUILD)/gd_bench ## measure requests around a field of 1.1 million faces, uploads and loading (needs the bunny; RANDOM_REQUESTS=1000)
	tests/bench/around.py --build $(BUILD) --random $(or $(RANDOM_REQUESTS),0)

bench-plots: $(BUILD)/gd_bench ## plot the cost of fields against mesh size, as SVG (MAX_FACES=300000)
	tests/bench/plots.py --build $(BUILD) --max-faces $(or $(MAX_FACES),300000)

sweep: $(BUILD)/gd_sweep ## compare the engine with CGAL on every shared mesh (minutes; needs libcgal-dev)
	$(BUILD)/gd_sweep --sources 20 $(wildcard $(SWEEP_SHARED)/*.obj)
