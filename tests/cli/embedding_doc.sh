# embedding_doc.sh - docs/embedding.md does what it says: its blocks are compiled against an installed tree, and run.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need cmake
[ "${PARIAN_SANITIZED:-0}" = 0 ] || { echo "skipped: needs a plain build"; exit 77; }
compile=$(command -v cc || command -v gcc || command -v clang) || fail "no C compiler"
"$compile" -E -include GLFW/glfw3.h -x c /dev/null > /dev/null 2>&1 || { echo "skipped: no GLFW"; exit 77; }
page=$PARIAN_SOURCE_DIR/docs/embedding.md

# The blocks of a language, one after the other.
blocks() { awk -v fence="\`\`\`$1" '$0 == "```" { on = 0 } on { print } $0 == fence { on = 1; print "" }' "$page"; }
mkdir "$work/embed"
cd "$work/embed" || exit 1
blocks c > embed.c
blocks cpp > embed_cpp.cpp
blocks cmake > CMakeLists.txt
blocks sh > commands.sh
for file in embed.c embed_cpp.cpp CMakeLists.txt commands.sh; do [ -s "$file" ] || fail "no block for $file in $page"; done

expect 0 cmake --install "$PARIAN_BINARY_DIR" --prefix "$work/prefix"
warnings="-Wall -Wextra -Werror"
expect 0 cmake -S . -B build -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_C_FLAGS="$warnings" -DCMAKE_CXX_FLAGS="$warnings"
expect 0 cmake --build build
if command -v pkg-config > /dev/null; then
    PKG_CONFIG_PATH=$(dirname "$(find "$work/prefix" -name parian-runtime.pc)")
    export PKG_CONFIG_PATH
    expect 0 sh -e commands.sh
fi
if command -v parian-bake > /dev/null && command -v xvfb-run > /dev/null; then
    write_tetrahedron tetra.off
    expect 0 parian-bake -q tetra.off --scale 50mm --quality preview --atlas 64 --transfer-vertices 200 -o tetra.parian
    expect 0 xvfb-run -a -s "-screen 0 1024x768x24" build/embed tetra.parian tetra.parian
    [ "$(grep -c 'mean B [0-9.]*[1-9]' "$out")" = 2 ] || fail "no radiosity: $(cat "$out")"
    grep -q '^\([0-9.]*\) MB of OpenGL foretold, \1 MB in use' "$out" || fail "an estimate that does not hold: $(cat "$out")"
    expect 2 xvfb-run -a -s "-screen 0 1024x768x24" build/embed absent.parian
fi
done_ok
