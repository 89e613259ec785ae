#!/bin/sh
# plugin_test.sh BUILD_DIRECTORY SOURCE_DIRECTORY COMPILER
# Plug-ins as their authors build and run them: against an installed Spikeloop, under mpirun.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
source=$2

fail() {
  echo "$1"
  shift
  [ $# -eq 0 ] || cat "$@"
  exit 1
}
build() {
  cmake -S "$1" -B "$1/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_CXX_COMPILER="$compiler" \
    -DEXAMPLE="$work/example" >"$work/log" 2>&1 &&
    cmake --build "$1/build" >>"$work/log" 2>&1 || fail "$1 cannot be built" "$work/log"
}
compiler=$3

cmake --install "$1" --prefix "$work/prefix" >"$work/log" || fail "cannot be installed" "$work/log"
PATH="$work/prefix/bin:$PATH"
unset SPIKELOOP_PLUGIN_PATH SPIKELOOP_STATUS SPIKELOOP_OUT || true

# The example: the same spikes as the built-in encoder's.
mkdir "$work/example"
cp "$source"/examples/04_encoder_cpp/* "$work/example/" 2>/dev/null || true
build "$work/example"
symbols=$(nm -D --defined-only "$work/example/build/my_rate_encoder.so" | awk '{print $3}')
[ "$symbols" = spikeloop_plugin_entry ] || fail "the plug-in exports more than its entry: $symbols"
cd "$work/example"
spikeloop check encoder.music || fail "its file is refused"
spikeloop run encoder.music --record --out run --real-time-factor 100 >"$work/log" 2>&1 ||
  fail "the example does not run" "$work/log"
PYTHONPATH="$work/prefix/share/spikeloop/python" /usr/bin/python3 \
  "$source/examples/05_encoder_python/compare.py" run mine builtin
lines=$(wc -l <encoder.cpp)
for page in "$source/examples/04_encoder_cpp/README.md" "$source/README.md"; do
  grep -q "$lines lines" "$page" || fail "$page does not say that encoder.cpp has $lines lines"
done

# By the directory's name instead of the key.
SPIKELOOP_PLUGIN_PATH="$work/example/build" spikeloop describe my_rate_encoder >"$work/log" ||
  fail "SPIKELOOP_PLUGIN_PATH is not heeded" "$work/log"
grep -q "rate_max" "$work/log" || fail "its parameters are not described" "$work/log"

# A step that throws ends the run, and the last line says whose it was.
cp -r "$source/tests/install/plugins" "$work/plugins"
build "$work/plugins"
cd "$work/plugins"
cp build/thrower.so .
code=0
spikeloop run thrower.music --real-time-factor 10 >"$work/log" 2>&1 || code=$?
[ "$code" = 5 ] || fail "a node that fails ends the run with $code" "$work/log"
tail -n 1 "$work/log" | grep "the battery is empty (plug-in '.*thrower.so')" ||
  fail "the last line does not name the plug-in" "$work/log"

# So does a constructor that throws, with the exit code of a file that cannot be run.
code=0
sed 's/^  node=thrower/&\n  at_once=true/' thrower.music >other.music
spikeloop run other.music >"$work/log" 2>&1 || code=$?
[ "$code" = 2 ] || fail "a node that cannot be made ends the run with $code" "$work/log"
tail -n 1 "$work/log" | grep "there is no battery (plug-in '.*thrower.so')" ||
  fail "the last line does not say why the node was not made" "$work/log"

# A plug-in that is not there: the key's place in the file.
code=0
sed 's/thrower\.so/throwers.so/' thrower.music >other.music
spikeloop check other.music >"$work/log" 2>&1 || code=$?
[ "$code" = 2 ] || fail "a missing plug-in gives $code" "$work/log"
grep -F "other.music:11:" "$work/log" | grep -F "plug-in 'throwers.so': cannot be loaded: " ||
  fail "the missing plug-in's key is not named" "$work/log"

# The sources of both, linked into one program.
build/linked
