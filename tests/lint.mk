# Checks and formats the source code. Included by the Makefile.

.PHONY: check check-layers compile-commands format lint

##@ Source code

# One module of tests over HTTP for each family of operations, run by `make check`.
CHECKED_OVER_HTTP := test_service test_meshes test_queries test_fields test_jobs test_nurbs test_subdivisions test_contract
check: build test-build ## run before a commit (two minutes): layers, formatting, all unit tests, one module of HTTP tests for each family
	@tests/check_layers.py
	@! command -v clang-format >/dev/null || clang-format --dry-run -Werror $$(git ls-files '*.c' '*.h' '*.cc')
	@tests/run.py $(TEST_PROGRAMS) "tests/api/run.py $(CHECKED_OVER_HTTP)"

compile-commands: | $(BUILD_MARK) ## write $(BUILD)/compile_commands.json, for clangd and editors
	@$(MAKE) --no-print-directory -nB V=1 build test-build | tests/compile_commands.py >$(BUILD)/compile_commands.json

check-layers: | $(BUILD)/stamps/tools ## fail if a file includes a file that its room may not include
	@tests/check_layers.py

format: | $(BUILD)/stamps/lint-tools ## format all C and C++
	clang-format -i $$(git ls-files '*.c' '*.h' '*.cc')

lint: check-layers check-pages | $(BUILD)/stamps/lint-tools ## check formatting, layers, the contract, prose and the pages' types, and build by clang
	python3 proto/generate.py check proto/openapi.yaml proto/json/problem.h
	python3 clients/js/generate.py | diff clients/js/types.d.ts -
	python3 clients/python/generate.py | diff clients/python/geodesicd/answers.py -
	clang-format --dry-run -Werror $$(git ls-files '*.c' '*.h' '*.cc')
	tests/lint_prose.py
	$(MAKE) --no-print-directory -j2 BUILD=$(BUILD)/clang CC=clang CXX=clang++ WARN="$(WARN) -Werror" build test-build
