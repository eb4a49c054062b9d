# The front door. Every target installs what it lacks and builds first.
.PHONY: build dependencies test test-sanitized bench format check-format install clean

build: dependencies
	cmake --preset release
	cmake --build --preset release

dependencies:
	./scripts/install-dependencies.sh

# All tests; those that need recordings say SKIPPED where these are missing.
test: build check-format
	ctest --test-dir build/release --output-on-failure -j2

# The fast tests under address and undefined-behaviour sanitizers.
test-sanitized: dependencies
	cmake --preset asan
	cmake --build --preset asan
	ctest --test-dir build/asan --output-on-failure -j2 -L fast

format:
	clang-format -i $$(git ls-files '*.h' '*.cpp')

check-format:
	clang-format --dry-run --Werror $$(git ls-files '*.h' '*.cpp')

install: build
	cmake --install build/release

clean:
	rm -rf build
