# For developers. Users need only scripts/demo and scripts/test.
.PHONY: help build demo test bench lint
PRESET ?= release

help:  ## this list
	@sed -n 's/^\([a-z]*\):.*## \(.*\)/  make \1\t\2/p' Makefile

build:  ## build one preset: make build PRESET=release|dev|asan|tsan
	@scripts/build $(PRESET)

demo:  ## the Braitenberg vehicle in closed loop
	@scripts/demo

test:  ## unit and integration tests
	@scripts/test

bench:  ## the benchmarks
	@scripts/bench

lint:  ## rules of the project, formatting, clang-tidy
	@scripts/install-dependencies lint
	@scripts/lint
