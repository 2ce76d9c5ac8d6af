# install_package.sh - an installed tree is complete and can be moved: tools, libraries, pages, and packages that
# applications build with: CMake, pkg-config, parian_bake(), and the example in docs/examples.
set -u
. "$PARIAN_SOURCE_DIR/tests/support/cli_support.sh"
need cmake
[ "${PARIAN_SANITIZED:-0}" = 0 ] || { echo "skipped: needs a plain build"; exit 77; }

# DESTDIR and a prefix of our own; then the tree is moved, as a package would be.
expect 0 env DESTDIR="$work/stage" cmake --install "$PARIAN_BINARY_DIR" --prefix "/opt/some where"
mv "$work/stage/opt/some where" "$work/moved"
prefix=$work/moved
present() { find "$prefix" -path "$prefix/$1" | grep -q . || fail "$1 is not installed"; }
for tool in parian-info parian-view parian-bake parian-models parian-measure; do
    command -v $tool > /dev/null || continue
    expect 0 "$prefix/bin/$tool" --version
    for file in "share/man/man1/$tool.1" "share/bash-completion/completions/$tool" \
        "share/zsh/site-functions/_$tool" "share/fish/vendor_completions.d/$tool.fish"; do
        present "$file"
    done
done
for file in include/parian/{env,format,light,result,runtime}.h share/doc/*/LICENSE share/doc/*/docs/{format,embedding}.md \
    share/doc/*/docs/examples/relight/relight_window.c share/man/man1/parian-info-validate.1; do
    present "$file"
done
libdir=$(dirname "$(dirname "$(find "$prefix" -name parian-runtime.pc)")")
grep -rlF -e "$PARIAN_SOURCE_DIR" -e "$PARIAN_BINARY_DIR" -e "$work/stage" "$libdir/cmake" "$libdir/pkgconfig" > "$out" &&
    fail "paths of the build are installed: $(cat "$out")"

# ---- an application: find_package, and pkg-config -------------------------------------------------
mkdir "$work/app"
cat > "$work/app/CMakeLists.txt" <<'CMAKE'
cmake_minimum_required(VERSION 3.20)
project(App C)
find_package(Parian 0.1 REQUIRED COMPONENTS format runtime)
add_executable(app app.c)
target_link_libraries(app PRIVATE Parian::runtime)
CMAKE
cat > "$work/app/app.c" <<'C'
#include <parian/format.h>
#include <parian/runtime.h>
#include <stdio.h>

int main(int argc, char **argv)
{
    parian_scene *scene = NULL;
    parian_result result = parian_scene_open(NULL, argc > 1 ? argv[1] : "absent.parian", &scene);
    puts(parian_result_text(result));
    parian_scene_close(scene);
    return parian_result_exit_status(result);
}
C
expect 0 cmake -S "$work/app" -B "$work/app/build" -DCMAKE_PREFIX_PATH="$prefix"
expect 0 cmake --build "$work/app/build"
expect 2 "$work/app/build/app"
contains "$out" "input or output failed"
for wrong in 's/0\.1 REQ/0.2 REQ/' 's/format runtime/format teapot/'; do
    mkdir -p "$work/wrong"
    sed "$wrong" "$work/app/CMakeLists.txt" > "$work/wrong/CMakeLists.txt"
    cp "$work/app/app.c" "$work/wrong"
    expect 1 cmake -S "$work/wrong" -B "$work/wrong/build" -DCMAKE_PREFIX_PATH="$prefix"
    rm -rf "$work/wrong"
done

compile=$(command -v cc || command -v gcc || command -v clang) || fail "no C compiler"
if command -v pkg-config > /dev/null; then
    export PKG_CONFIG_PATH="$libdir/pkgconfig"
    flags=$(pkg-config --cflags --libs --static parian-runtime) || fail "pkg-config does not know parian-runtime"
    echo "$flags" > "$out"
    for flag in -I /include -lparian_runtime -lparian_format -lzstd -lxxhash -lm; do contains "$out" "$flag"; done
    expect 0 "$compile" -Wall -Werror "$work/app/app.c" $flags -o "$work/app/by_pkg_config"
    expect 2 "$work/app/by_pkg_config"
    pkg-config --libs parian-runtime > "$out"
    lacks "$out" -lzstd
    [ "$(pkg-config --modversion parian-format)" = "$(pkg-config --modversion parian-runtime)" ] || fail "versions"
fi
command -v parian-bake > /dev/null || done_ok

# ---- parian_bake(): bakes again when an input changes, and only then ------------------------------
# A tetrahedron of 50 mm whose buffer is a file of its own.
mkdir -p "$work/bake/part one"
cd "$work/bake" || exit 1
o='\0\0\0\0' l='\315\314\114\075'
printf "$o$o$o$l$o$o$o$l$o$o$o$l"'\0\0\2\0\1\0\0\0\1\0\3\0\1\0\2\0\3\0\0\0\3\0\2\0' > "part one/tetra.bin"
cat > "part one/tetra.gltf" <<'JSON'
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "tetra"}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
 "buffers": [{"uri": "tetra.bin", "byteLength": 72}],
 "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0],
                "max": [0.05, 0.05, 0.05]}, {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}]}
JSON
echo '{"name": "m", "sigma_s_prime": [2, 2, 2], "sigma_a": [0.01, 0.02, 0.03], "eta": 1.3, "unit": "1/mm"}' > medium.json
cat > CMakeLists.txt <<'CMAKE'
cmake_minimum_required(VERSION 3.20)
project(Bake NONE)
find_package(Parian REQUIRED COMPONENTS bake)
parian_bake(TARGET assets INPUT "part one/tetra.gltf" MATERIAL medium.json QUALITY preview
  OPTIONS --transfer-vertices 200 --atlas 64)
parian_bake(TARGET assets OUTPUT scaled/half.parian INPUT "part one/tetra.gltf" MATERIAL marble SCALE 25mm
  OPTIONS --transfer-vertices 200 --atlas 64)
get_target_property(made assets PARIAN_ASSETS)
file(WRITE "${CMAKE_BINARY_DIR}/made.txt" "${made}")
CMAKE
# The asset is newer than the mark that was set before the last build.
rebuild() {
    touch "$work/mark"
    sleep 0.02
    expect 0 cmake --build "$1"
}
baked() { [ -n "$(find "$2" -newer "$work/mark")" ] || fail "$1: not baked again"; }
untouched() { [ -z "$(find "$2" -newer "$work/mark")" ] || fail "$1: baked again"; }
try_generator() {
    local folder=$work/bake/$2 asset=$work/bake/$2/tetra.parian half=$work/bake/$2/scaled/half.parian input
    expect 0 cmake -S . -B "$folder" -G "$1" -DCMAKE_PREFIX_PATH="$prefix"
    expect 0 cmake --build "$folder"
    expect 0 parian-info validate "$asset" "$half"
    contains "$folder/made.txt" "$asset;$half"
    rebuild "$folder"
    untouched "$1, nothing changed" "$asset"
    for input in "part one/tetra.gltf" "part one/tetra.bin" medium.json "$prefix/bin/parian-bake"; do
        sleep 0.05
        touch "$input"
        rebuild "$folder"
        baked "$1, $input changed" "$asset"
        [ "$input" != medium.json ] || untouched "$1, $input changed" "$half"
        [ "$input" = medium.json ] || baked "$1, $input changed" "$half"
        rebuild "$folder"
        untouched "$1, nothing changed after $input" "$asset"
    done
}
mkdir -p by_ninja/scaled by_make/scaled
! command -v ninja > /dev/null || try_generator Ninja by_ninja
! command -v make > /dev/null || try_generator "Unix Makefiles" by_make
echo '{"name": ' > medium.json
cmake --build "$(find "$work/bake" -maxdepth 1 -name 'by_*' | head -1)" > "$out" 2>&1 && fail "a broken material is baked"
contains "$out" medium.json

# ---- the example ----------------------------------------------------------------------------------
"$compile" -E -include GLFW/glfw3.h -x c /dev/null > /dev/null 2>&1 || { echo "no GLFW: the example is not built"; done_ok; }
asset=$(find "$work/bake" -name tetra.parian | head -1)
example=$(dirname "$(find "$prefix" -name relight_window.c)")
[ "$(wc -l < "$example/relight_window.c")" -le 200 ] || fail "the example has over 200 lines"
expect 0 cmake -S "$example" -B "$work/relight" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_FLAGS="-Wall -Wextra -Werror"
expect 0 cmake --build "$work/relight"
expect 1 "$work/relight/relight"
expect 2 "$work/relight/relight" absent.parian
if command -v pkg-config > /dev/null; then
    expect 0 "$compile" -std=gnu11 "$example/relight_window.c" $flags $(pkg-config --cflags --libs glfw3) -o "$work/by_pkg_config"
fi
if command -v xvfb-run > /dev/null; then
    for program in "$work/relight/relight" "$work/by_pkg_config"; do
        [ ! -x "$program" ] || expect 0 xvfb-run -a -s "-screen 0 1024x768x24" "$program" "$asset" --frames 3
        [ ! -s "$out" ] || fail "the example prints: $(head -3 "$out")"
    done
fi
done_ok
