# The few commands that one needs; everything behind them is CMake (CMakePresets.json) and tools/.
JOBS ?= $(shell nproc)
BENCH ?= raycast --particles 1000000 --size 1024x1024 --json
PROGRAM := build/release/meniscus

.PHONY: all build demo test bench bench-peers fuzz format packages clean
all: build

build: build/release/build.ninja
	cmake --build --preset release --parallel $(JOBS)

# A short film and two stills from data/ and examples/, with the program alone: no test is built.
demo: build/release/build.ninja
	cmake --build --preset release --parallel $(JOBS) --target meniscus_app
	tools/demo.sh $(PROGRAM)

test: build
	ctest --preset release --parallel $(JOBS)

bench: build/release/build.ninja
	cmake --build --preset release --parallel $(JOBS) --target meniscus_app
	$(PROGRAM) bench $(BENCH)

# Another program on the same particles: its packages are installed, and its driver is built in a folder of its own.
bench-peers: build/release/build.ninja
	cmake --build --preset release --parallel $(JOBS) --target meniscus_app
	tools/install_packages.sh bench/peers/packages.txt
	bench/peers/run.sh $(PROGRAM) build/peers

# Random bytes into every reader, FUZZ_SECONDS each.
FUZZ_SECONDS ?= 60
fuzz: | packages
	tools/install_packages.sh tests/fuzz/packages.txt
	tools/fuzz.sh $(FUZZ_SECONDS)

# Once configured, ninja itself sees when a CMake file has changed.
build/release/build.ninja: CMakePresets.json | packages
	cmake --preset release

# What packages.txt lists and this machine lacks; says nothing when all is there.
packages:
	@tools/install_packages.sh

format:
	@tools/format.sh

clean:
	rm -rf build demo
