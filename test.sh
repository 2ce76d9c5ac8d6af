#!/bin/bash
# test.sh - installs what is missing, builds, and runs the whole test suite.
#
#   ./test.sh              everything: release build (all tests), sanitizer build (unit, robust, gl, cli)
#   ./test.sh release      only the release build
#   ./test.sh sanitize     only the sanitizer build
#   PARIAN_JOBS=N          that many compilers and tests at a time (the number of cores)
#
# Ends with 0 when every test passed or was skipped, because its hardware or data is absent.
set -eu
cd "$(dirname "$0")"
what=${1:-all}
case $what in
all | release | sanitize) ;;
*)
    echo "test.sh: '$what' is neither release nor sanitize" >&2
    exit 1
    ;;
esac
.ci/setup
. .ci/build
started=$SECONDS
failed=

# tests PRESET LABELS: every test of the labels; the log of failing ones is shown.
tests() { ctest --test-dir "build/$1" --output-on-failure --parallel "$jobs" --label-regex "$2" --no-tests=error; }

if [ "$what" != sanitize ]; then
    say "release build"
    configure release
    build release
    say "release tests"
    tests release '.' || failed="$failed release"
fi
if [ "$what" != release ]; then
    say "sanitizer build (AddressSanitizer, UndefinedBehaviorSanitizer)"
    configure sanitize
    build sanitize
    say "sanitizer tests"
    # Drivers and libraries that are not ours keep memory until the end: only leaks of our own count.
    export ASAN_OPTIONS=detect_leaks=1:detect_stack_use_after_return=1 UBSAN_OPTIONS=print_stacktrace=1
    export LSAN_OPTIONS="suppressions=$PWD/.ci/leaks.txt:print_suppressions=0"
    tests sanitize 'unit|robust|gl|cli' || failed="$failed sanitizer"
fi
say "$((SECONDS - started)) s"
if [ -n "$failed" ]; then
    echo "FAILED:$failed"
    exit 1
fi
echo "all tests passed"
