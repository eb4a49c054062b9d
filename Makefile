# The front door. Every target installs what it lacks and builds first.
.PHONY: build everything coverage tidy fuzz faults effects dependencies test-dependencies demo experiments loops fleet-test test test-sanitized test-sanitized-all bench install package format check-format clean
PREFIX ?= /usr/local
CODE = include src apps studies examples ros ros2 python fuzz

# The program and the library. `everything` has the tests, benchmarks and studies as well, in the same folder.
build: dependencies
	cmake --preset product
	cmake --build --preset product

everything: test-dependencies
	cmake --preset release
	cmake --build --preset release

dependencies:
	./scripts/install-dependencies.sh build

test-dependencies:
	./scripts/install-dependencies.sh test

# Runs the program on the sample dive and compares the result with the truth, in pictures. A recording in place of the
# sample: RECORDING=/path/to/folder-with-mav0.
demo: build
	./scripts/demo.sh

# Renders replicas of the paper's dives (many hours; goes on where it was ended), compares the methods on them and
# writes docs/lab-notes/experiments.md. Options are listed in the script.
experiments: build
	./scripts/experiments.sh

# All tests; those that need recordings say SKIPPED where these are missing.
test: everything check-format
	ctest --test-dir build/release --output-on-failure -j2
	@grep -A1 ': Skipped$$' build/release/Testing/Temporary/LastTest.log || true

# Built with Clang under address and undefined-behaviour sanitizers: the fast tests of the layers that read what others
# wrote, and the fuzzers of all readers, each for ten seconds on its corpus. `make test-sanitized-all` adds the layers
# that compute; the estimator's tests alone work through whole simulated scenes.
SANITIZED = util tables streams io rosbag evaluation
test-sanitized: test-dependencies
	cmake --preset sanitized
	cmake --build --preset sanitized --target lodeline_fuzzers $(SANITIZED:%=%_test)
	ctest --test-dir build/sanitized --output-on-failure -j2 -L 'fast|fuzz' \
	  -R "^(fuzz\.|($$(echo $(SANITIZED) | tr ' ' '|'))_test)"

test-sanitized-all:
	$(MAKE) test-sanitized SANITIZED="$(SANITIZED) geometry cameras magnetometer imu ahrs frontend factors problem estimator batch calibration survey store graph cloud recognition control"

# Every kind of fault, three draws, on a real recording and a simulated dive; the table is build/faults/table.md.
faults: build
	./scripts/faults.sh build/faults --seeds 1 2 3 --repeat 2 --allow-told 5 --markdown build/faults/table.md

# What each effect of the simulator costs, with two cameras and one; the table is build/effects/table.md. It takes hours.
effects: build
	./scripts/effects.py build/effects --markdown build/effects/table.md

# What the magnetometer does among magnetic disturbances and near steel, and without; a quarter of an hour.
.PHONY: magnetic-harm
magnetic-harm: everything
	build/release/bin/magnetic_harm_study
	build/release/bin/magnetic_harm_study --undisturbed

# Walls of a simulated dive against the exact surface; some minutes.
.PHONY: walls-figures
walls-figures: everything
	./scripts/walls_figures.sh build/walls_figures

# Walls of an excerpt beside the points of COLMAP, with the poses of the run; needs colmap, some minutes.
.PHONY: walls-colmap
walls-colmap: walls-figures
	./scripts/walls_colmap.sh build/walls_figures

# Fuzzers of all readers, built with Clang; each runs for ten seconds on its corpus.
fuzz: test-dependencies
	cmake --preset sanitized
	cmake --build --preset sanitized --target lodeline_fuzzers
	ctest --test-dir build/sanitized --output-on-failure -j2 -L fuzz

# Line coverage of the library by all tests, layer by layer.
coverage: test-dependencies
	cmake --preset coverage
	cmake --build --preset coverage
	ctest --test-dir build/coverage --output-on-failure -j2
	gcovr -j2 --gcov-ignore-parse-errors --root . --filter src/lodeline --filter include --exclude '.*test.*' --print-summary build/coverage

# The checks of .clang-tidy on the product's sources, many files at a time: the outside headers take most of the time.
# Three files are left out, because they include what only a build makes.
tidy: test-dependencies
	cmake --preset sanitized -B build/tidy -DLODELINE_SANITIZERS= -DLODELINE_BUILD_FUZZERS=OFF \
	  -DLODELINE_PRECOMPILED_HEADERS=OFF -DLODELINE_BUILD_TESTS=OFF
	run-clang-tidy-14 -quiet -j2 -p build/tidy '^$(CURDIR)/(?!.*(page_template|benchmark_set|build_info)).*\.(cpp|cxx)$$'

# Loops and false loops in numbers that are too large for the tests; some minutes.
loops: everything
	build/release/bin/batch_test --gtest_also_run_disabled_tests --gtest_filter='Loops.*'
	build/release/bin/cloud_test --gtest_also_run_disabled_tests --gtest_filter='FalseClouds.*:CloudGain.*'
	build/release/bin/graph_real_test --gtest_also_run_disabled_tests

# Slurm and Snakemake as a user has them: 200 runs each, 20 workers taken away. It takes up to an hour; see the scripts.
fleet-test: build
	./scripts/install-dependencies.sh fleet
	LODELINE=build/release/bin/lodeline examples/fleet/test_slurm.sh
	LODELINE=build/release/bin/lodeline examples/fleet/test_snakemake.sh

bench: everything
	./scripts/benchmark.sh

# Decoding of films and a run of one, 1080p at 30 images a second: FILM=/path/to/film-with-telemetry. Some minutes.
.PHONY: bench-film
bench-film: everything
	./scripts/film_benchmark.sh

# How long after its image a pose comes over DDS, at the pace of a recording: RECORDING=/path/to/folder-with-mav0.
.PHONY: bench-dds
bench-dds: RECORDING ?= ../shared/data/euroc_mh01_stereo_14s
bench-dds: everything
	rm -f build/dds_latency.mcap build/dds_latency.rig.yaml
	build/release/bin/lodeline convert $(RECORDING) build/dds_latency.mcap
	build/release/bin/dds_latency build/dds_latency.mcap build/dds_latency.rig.yaml

# To PREFIX (default /usr/local); DESTDIR is put before it.
install: build
	cmake --install build/release --prefix $(PREFIX)

# Debian packages of the program and of the Python module in build/release, unpacked and used for a check.
package: build
	rm -f build/release/*.deb
	cd build/release && cpack
	./scripts/check_packages.sh build/release

# The documentation as a site in build/docs, with the reference of the library in build/docs/api. Debian's package
# libjs-katex draws its equations.
.PHONY: docs docs-reference
docs:
	./scripts/install-dependencies.sh docs
	./scripts/check_links.py
	./scripts/check_findings.py
	mkdocs build --strict
	mkdir -p build/docs/api
	doxygen docs/Doxyfile

# The pages of docs/reference that the program itself can tell: commands and settings.
docs-reference: build
	./scripts/generate_reference.py

format:
	clang-format-14 -i $$(find $(CODE) -name '*.h' -o -name '*.cpp')

check-format:
	clang-format-14 --dry-run --Werror $$(find $(CODE) -name '*.h' -o -name '*.cpp')

clean:
	rm -rf build demo
