# Everything a user needs, in front of the CMake presets. `make help` lists the targets.
PRESET ?= release
BUILD  := build/$(PRESET)
JOBS   ?= $(shell nproc)

.PHONY: all build packages demo test bench bench-long bench-methods bench-instructions bench-docs compare compare-docs shear clang debug asan tsan format check-format clean help

all: build            ## build (PRESET=release): build/release/quern

packages:             ## install missing Debian packages (as root or with sudo)
	@sh .ci/packages

build: packages
	@cmake --preset $(PRESET) > build.log 2>&1 || { cat build.log; exit 1; }
	@rm -f build.log
	cmake --build --preset $(PRESET) -j $(JOBS)

demo: build           ## a disk on an inclined plane, 369 grains in shear: runs, pictures, errors against the rigid disk
	$(BUILD)/quern run examples/inclined_plane/disk.yaml -o out/demo
	$(BUILD)/quern render out/demo -o out/demo/disk.png --field von_mises
	$(BUILD)/inclined_plane_report -o out/inclined_plane
	$(BUILD)/quern run examples/granular_shear/short.yaml -o out/shear
	$(BUILD)/quern render out/shear -o out/shear/stress.png --field principal_difference --dark --range 0 4e8
	$(BUILD)/quern plot out/shear
	@echo "Pictures: out/demo/disk.png, out/inclined_plane/*.png, out/shear/stress.png and out/shear/plots/*.png"

shear: build          ## 369 grains in shear at the published resolution, all variants: out/granular_shear
	$(BUILD)/granular_shear_report -o out/granular_shear

test: build           ## build and run all tests
	ctest --test-dir $(BUILD) --output-on-failure -j $(JOBS)

REVISION = $$(git describe --always --dirty)

bench: build          ## kernels, stages, whole problems: table, out/bench/bench.json, bench.png
	$(BUILD)/quern_bench -o out/bench --revision "$(REVISION)"

bench-long: build     ## the same with 10^4 and 10^5 disks, 1000 spheres, one and two threads
	$(BUILD)/quern_bench -o out/bench --long --revision "$(REVISION)"

bench-methods: build   ## contact by all methods against the number of grains, 10^2 to 10^5: out/bench/methods.*
	$(BUILD)/quern_bench -o out/bench --methods --long --revision "$(REVISION)"

bench-instructions: build  ## instructions counted by callgrind: out/bench/instructions.json
	tests/benchmark/instructions.py $(BUILD)/quern_count -o out/bench --revision "$(REVISION)"

bench-docs:           ## out/bench into docs/: tables of performance.md, picture
	tests/benchmark/docs.py out/bench

compare: build        ## ways of contact side by side, all decks, three resolutions: out/comparison
	$(BUILD)/comparison_report -o out/comparison

compare-docs:         ## out/comparison into docs/comparison and README.md: tables, pictures
	examples/comparison/docs.py out/comparison

clang debug asan tsan:  ## build with another preset
	$(MAKE) build PRESET=$@

format:               ## clang-format everything
	clang-format-14 -i $$(git ls-files '*.cpp' '*.hpp')

check-format:         ## fail if clang-format would change a file
	clang-format-14 --dry-run -Werror $$(git ls-files '*.cpp' '*.hpp')

clean:                ## remove what was built
	rm -rf build out

help:
	@sed -n 's/^\([a-z -]*\):.*## /\1\t/p' $(MAKEFILE_LIST)
