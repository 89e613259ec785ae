#!/bin/sh
# install_test.sh BUILD_DIRECTORY CONSUMER_SOURCE COMPILER PYTHON_NODES
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$1" --prefix "$work/prefix" >"$work/install.log" || {
  cat "$work/install.log"
  exit 1
}
for program in spikeloop spikeloop-robot spikeloop-network rate_encoder ros_command_adapter; do
  "$work/prefix/bin/$program" --help >/dev/null || {
    echo "the installed $program does not run"
    exit 1
  }
done
"$work/prefix/bin/spikeloop" export "$(dirname "$0")/../../examples/01_braitenberg/braitenberg.music" |
  grep -q "LD_PRELOAD=$work/prefix/lib/spikeloop/libspikeloop_waiting.so" || {
  echo "jobs do not preload the installed library"
  exit 1
}
grep -q "spikeloop completion" "$work/prefix/share/bash-completion/completions/spikeloop" || {
  echo "bash finds no completion in share/bash-completion/completions"
  exit 1
}
cmake -S "$2" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_CXX_COMPILER="$3" \
  >"$work/configure.log" 2>&1 || {
  cat "$work/configure.log"
  exit 1
}
cmake --build "$work/build" >"$work/build.log" 2>&1 || {
  cat "$work/build.log"
  exit 1
}
"$work/build/use_library"
SPIKELOOP_PLUGIN_PATH="$work/build" "$work/prefix/bin/spikeloop-node" --list | grep -w doubler

# A Python node, with the installed package and nothing in the environment that would lead there.
mkdir "$work/nodes"
cp "$4"/*.py "$work/nodes"
env -u PYTHONPATH -u SPIKELOOP_LIBRARY_PATH SPIKELOOP_PLUGIN_PATH="$work/nodes" \
  "$work/prefix/bin/spikeloop" describe my_rate_encoder | grep "^  rate_max  Hz  100  >= 0 "
printf '%s\n' 'import spikeloop' 'raise ValueError(spikeloop.__file__)' '@spikeloop.node' \
  'def where(step): ...' \
  >"$work/nodes/where.py"
env -u PYTHONPATH -u SPIKELOOP_LIBRARY_PATH SPIKELOOP_PLUGIN_PATH="$work/nodes" \
  "$work/prefix/bin/spikeloop-node" --list 2>&1 |
  grep "$work/nodes/where.py:2: ValueError: $work/prefix/share/spikeloop/python/spikeloop/__init__.py"

# Pictures of a run, drawn by the installed package.
"$work/prefix/bin/spikeloop" new >"$work/explorer.yaml"
"$work/prefix/bin/spikeloop" run -q "$work/explorer.yaml" --sync lockstep --duration 1 --out "$work/run"
env -u PYTHONPATH PYTHONVERBOSE=1 "$work/prefix/bin/spikeloop" plot "$work/run" \
  >"$work/plot.log" 2>"$work/imports.log"
grep "^$work/run/signals.png" "$work/plot.log"
grep -q "$work/prefix/share/spikeloop/python/spikeloop/parts.py" "$work/imports.log"
# The paper's measurements: chain, probe over ROS, and a simulator's script, all of them installed.
(cd "$work" && env -u PYTHONPATH "$work/prefix/bin/spikeloop" bench --part a,c --layouts separate \
  --encoders rate --simulators neuron --duration 1 --trials 1 --most 100 --ticks 10 --steps 1 \
  --out "$work/bench") >"$work/bench.log" 2>&1 || {
  cat "$work/bench.log"
  exit 1
}
grep "rate neurons in real time, NEURON, separate" "$work/bench.log"
grep "^$work/bench/c.png" "$work/bench.log"
# `import spikeloop` by the path file that Debian's Python reads below /usr/local; and by pip.
imports() {
  env -u SPIKELOOP_PROGRAMS PATH="$work/prefix/bin:/usr/bin:/bin" PYTHONPATH="$1" /usr/bin/python3 -c "
import site, sys
site.addsitedir(sys.argv[1])
import spikeloop
experiment = spikeloop.load('$work/explorer.yaml', {'sync': 'lockstep', 'duration': '10 ms'})
with experiment.open() as loop:
    loop.step(10)
print(spikeloop.__file__, experiment.run().summary()['simulated_s'], round(loop.time_s, 9))" "$2"
}
imports "" "$(dirname "$(find "$work/prefix/lib" -name spikeloop.pth)")" |
  grep "^$work/prefix/share/spikeloop/python/spikeloop/__init__.py 0.01 0.01$"
source=$(cd "$(dirname "$0")/../.." && pwd)
cp -r "$source/python" "$source/pyproject.toml" "$source/VERSION" "$work/nodes"
/usr/bin/python3 -m pip install -q --no-deps --no-build-isolation --no-index --target "$work/site" \
  "$work/nodes" >"$work/pip.log" 2>&1 || {
  cat "$work/pip.log"
  exit 1
}
imports "$work/site" "$work/nowhere" | grep "^$work/site/spikeloop/__init__.py 0.01 0.01$"

# The library of scripts, beside the installed package.
env -u SPIKELOOP_LIBRARY_PATH PATH=/usr/bin:/bin PYTHONPATH="$work/prefix/share/spikeloop/python" \
  /usr/bin/python3 -c 'from spikeloop.music_library import library; print(library().__file__)' |
  grep "^$work/prefix/.*/libspikeloop_python_music.so$"
echo "find_package(Spikeloop): a program and a plug-in were built and ran"
