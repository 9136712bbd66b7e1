# Checks of the source code. Included by the Makefile.

.PHONY: check-layers format lint

##@ Source code

check-layers: ## fail if a file includes what its room may not
	@tests/check_layers.py

format: ## format all C and C++
	clang-format -i $$(git ls-files '*.c' '*.h' '*.cc')

lint: check-layers check-pages ## formatting, layers, the contract, the pages' types, and a build by the other compiler
	python3 proto/generate.py check proto/openapi.yaml proto/json/problem.h
	python3 clients/js/generate.py | diff clients/js/types.d.ts -
	clang-format --dry-run -Werror $$(git ls-files '*.c' '*.h' '*.cc')
	$(MAKE) --no-print-directory -j2 BUILD=$(BUILD)/clang CC=clang CXX=clang++ WARN="$(WARN) -Werror" build test-build
